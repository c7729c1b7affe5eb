# SPDX-License-Identifier: MIT
"""Tables with units, written as flat netCDF files by the CF conventions.

A file holds one table and no groups: every column is a variable with one unit, so that
programs that know nothing of sessions plot it with its axes and units.

Source:
    CF conventions 1.11, sections 2.2 (text), 2.3 (names), 2.5.1 (missing data), 2.6
    (title, history), 3.1 (units), 3.4 (ancillary data), 6.1 (labels).
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.disk_room import DiskRoom
from jointbench.acquisition.file_access.netcdf_encodings import write_texts
from jointbench.acquisition.file_access.netcdf_write import (
    CHUNK_VALUES,
    Attribute,
    encode_text,
    make_variable,
    write_attributes,
    write_variable,
)
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.records.session import software_version
from jointbench.station.files.long_values import LongValues, pieces
from jointbench.station.files.table_files import ExportColumn, ExportTable, plain_name

SCHEMA = "jointbench-export/1"
_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
_LABEL = "_label"
Attributes = Mapping[str, Attribute]


def write_netcdf(
    target: Path, table: ExportTable, facts: Attributes, history: Sequence[str] = ()
) -> Path:
    """Write one table as a netCDF file; numbers with all their digits.

    Args:
        target: path without an ending; the name of the table is added.
        table: to write; complex numbers become two variables, ``*_re`` and ``*_im``.
        facts: attributes of the file.
        history: lines on what was done before the export, oldest first.

    Returns:
        The file.

    Raises:
        UsageError: there is a file that no export made.
        BadData: a text cannot be stored without loss.
    """
    path = target.with_name(f"{target.name}.{plain_name(table.name)}.nc")
    _require_own(path)
    with new_file(
        path,
        schema=SCHEMA,
        title=f"{table.name} of {target.name}",
        overwrite=True,
        memory=not _is_long(table),
    ) as file:
        now = datetime.now(UTC).isoformat(timespec="seconds")
        lines = [*history, f"{now} jointbench export --to netcdf"]
        made = {"source": "jointbench", "software": software_version()}
        write_attributes(
            file, made | {_plain(k): v for k, v in facts.items() if v != ""}
        )
        write_attributes(file, {"history": "\n".join(lines)})
        columns = {_plain(name): (name, column) for name, column in _real(table)}
        for name in sorted(columns, key=lambda name: not _is_axis(name, columns)):
            _write_column(file, name, columns)
    return path


def one_unit_each(table: ExportTable) -> ExportTable:
    """Return a table of quantities with one variable a quantity, each with its unit.

    Its rows have different units, which no attribute of one variable can state.

    Args:
        table: columns part, item, name, unit, word, value, sd, preload.
    """
    cells = {
        name: np.asarray(column.values).tolist()
        for name, column in table.columns.items()
    }
    columns: dict[str, ExportColumn] = {}
    for number, what in enumerate(cells["name"]):
        of = " ".join(filter(None, (cells["part"][number], cells["item"][number])))
        words = f"{of}: {what}" if of else str(what)
        name = _free(_plain(words), columns)
        word, unit = cells["word"][number], cells["unit"][number]
        value = word or cells["value"][number]
        columns[name] = ExportColumn("" if word else unit, np.array(value), (), words)
        if np.isfinite(sd := cells["sd"][number]):
            own = f"{words}, standard deviation"
            columns[f"{name}_sd"] = ExportColumn(unit, np.array(sd), (), own)
    return ExportTable(table.name, columns)


def _write_column(
    file: h5py.File, name: str, columns: Mapping[str, tuple[str, ExportColumn]]
) -> None:
    own, column = columns[name]
    words = column.words or own
    if isinstance(column.values, LongValues):
        _write_long(file, name, column, column.values, words)
        return
    if column.values.dtype.kind == "U":
        if not column.dims:
            write_attributes(file, {name: str(column.values)})
            return
        write_texts(file, name, column.values.tolist(), column.dims[0], long_name=words)
        return
    labels = [
        label
        for label, (_, other) in columns.items()
        if label.endswith(_LABEL) and other.dims[0] in column.dims
    ]
    sd = f"{name}_sd" in columns
    values = _narrow(column.values)
    dataset = write_variable(
        file,
        name,
        values,
        column.dims,
        units=column.unit or "1",
        long_name=words,
        attributes={
            "coordinates": " ".join(labels) or None,
            "ancillary_variables": f"{name}_sd" if sd else None,
        },
    )
    if values.dtype.kind == "f" and np.isnan(values).any():
        dataset.attrs.create("_FillValue", np.array([np.nan], dtype=values.dtype))


def _is_long(table: ExportTable) -> bool:
    """Return whether a table is written to the disk rather than made in memory."""
    columns = (column.values for column in table.columns.values())
    return any(isinstance(v, LongValues) and v.size > CHUNK_VALUES for v in columns)


def _write_long(
    file: h5py.File, name: str, column: ExportColumn, values: LongValues, words: str
) -> None:
    """Write the samples of a channel, or their times, a piece at a time.

    Room on the disk is reserved for each, as far as the file is there.
    """
    kind = values.shape, values.dtype
    unit = column.unit or "1"
    dataset = make_variable(file, name, kind, column.dims, units=unit, long_name=words)
    if values.size <= CHUNK_VALUES:
        dataset[:] = np.asarray(values)
        return
    with Path(file.filename).open("rb+") as handle:
        room = DiskRoom(handle, file)
        for part in pieces(values.size):
            piece = values[part]
            room.make(piece.nbytes)
            dataset[part] = piece
            file.flush()


def _real(table: ExportTable) -> Iterator[tuple[str, ExportColumn]]:
    """Yield the columns, complex ones as real and imaginary parts."""
    for name, column in table.columns.items():
        if isinstance(column.values, LongValues) or not np.iscomplexobj(column.values):
            yield name, column
            continue
        for ending, part, values in (
            ("_re", "real", column.values.real),
            ("_im", "imaginary", column.values.imag),
        ):
            words = f"{part} part of {column.words or name}"
            yield (
                f"{name}{ending}",
                ExportColumn(column.unit, values, column.dims, words),
            )


def _is_axis(name: str, columns: Mapping[str, tuple[str, ExportColumn]]) -> bool:
    return columns[name][1].dims == (name,)


def _narrow(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return booleans and whole numbers as 32 bits, which every reader knows."""
    if values.dtype.kind not in "biu":
        return values
    return values.astype(np.int32 if np.abs(values).max() < 2**31 else np.float64)


def _plain(name: str) -> str:
    """Return a name by CF 2.3: a letter, then letters, digits and underscores."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
    return plain if plain[:1].isalpha() else f"v_{plain}"


def _free(name: str, taken: Mapping[str, object]) -> str:
    free, count = name, 1
    while free in taken:
        count += 1
        free = f"{name}_{count}"
    return free


def _require_own(path: Path) -> None:
    """Refuse to replace a file unless an export made it."""
    if not path.is_file():
        return
    try:
        with h5py.File(path, "r") as file:
            own = file.attrs.get("schema") == encode_text(SCHEMA, "schema")
    except OSError:
        own = False
    if not own:
        raise UsageError(
            f"{named(path)} is there already and was made by no export; choose "
            "another name, or move it away"
        )
