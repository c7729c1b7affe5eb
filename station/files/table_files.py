# SPDX-License-Identifier: MIT
"""Tables with units, written for other programs as CSV or MAT.

An array of several dimensions becomes several columns in CSV, with the labels of the
others in their heads; in MAT it stays an array.
"""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import isnan, prod
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.files.long_values import LongValues, pieces
from jointbench.station.files.output_paths import require_mark, whole_file
from jointbench.station.files.spreadsheet_text import escaped

_LONGEST_NAME = 63  # of a variable in MATLAB
_MAT_WORDS = b"MATLAB 5.0 MAT-file, written by jointbench"
_MAT_BYTES = 2**31  # that such a file can hold
_MAT_TEXT = 116  # bytes of words in front of a MAT file
_ALONG = ("frequency", "mode")
Array = np.ndarray[Any, Any]


@dataclass(frozen=True, slots=True, eq=False)
class ExportColumn:
    """Numbers or texts of a table.

    Attributes:
        unit: of the numbers; empty for texts.
        values: of any shape; those of a recording are read as they are written.
        dims: name of each axis.
        words: what it is; empty where its name is enough.
    """

    unit: str
    values: Array | LongValues
    dims: tuple[str, ...]
    words: str = ""

    @property
    def along(self) -> str:
        """Dimension that goes down the rows of a CSV file."""
        return next((dim for dim in _ALONG if dim in self.dims), self.dims[-1])


@dataclass(frozen=True, slots=True, eq=False)
class ExportTable:
    """Columns that belong together.

    Attributes:
        name: of the table.
        columns: by their names.
        labels: texts that name the places along a dimension, by the dimension.
    """

    name: str
    columns: Mapping[str, ExportColumn]
    labels: Mapping[str, Sequence[str]] = field(default_factory=dict)


def write_csv(target: Path, tables: Iterable[ExportTable]) -> Iterator[Path]:
    """Write one file for each dimension of each table; numbers with all their digits.

    Args:
        target: path without an ending; names of tables are added.
        tables: to write.

    Yields:
        The files, as they are written.
    """
    for table in tables:
        heads: dict[str, dict[str, Array | LongValues]] = {}
        in_heads = {d for c in table.columns.values() for d in c.dims if d != c.along}
        for name, column in table.columns.items():
            if name.removesuffix("_label") not in in_heads:
                own = heads.setdefault(column.along, {})
                own |= dict(_flat(name, column, table.labels))
        for along, columns in heads.items():
            axis = [head for head in columns if head.split(" [")[0] == along]
            suffix = f".{plain_name(along)}" if len(heads) > 1 else ""
            path = target.with_name(
                f"{target.name}.{plain_name(table.name)}{suffix}.csv"
            )
            _write_rows(path, {head: columns[head] for head in [*axis, *columns]})
            yield path


def _flat(
    name: str, column: ExportColumn, labels: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, Array | LongValues]]:
    """Yield a column of one dimension for each place along the others."""
    unit = f" [{column.unit}]" if column.unit else ""
    if isinstance(column.values, LongValues):
        yield f"{name}{unit}", column.values
        return
    along = column.dims.index(column.along)
    others = [dim for dim in column.dims if dim != column.along]
    values = np.moveaxis(column.values, along, -1)
    parts = [("", values)]
    if np.iscomplexobj(values):
        parts = [(" re", values.real), (" im", values.imag)]
    for place in np.ndindex(values.shape[:-1]):
        words = [
            labels[dim][index] if dim in labels else str(index + 1)
            for dim, index in zip(others, place, strict=True)
        ]
        where = f" {'/'.join(words)}" if words else ""
        for part, numbers in parts:
            yield f"{name}{where}{part}{unit}", numbers[place]


def _write_rows(path: Path, columns: Mapping[str, Array | LongValues]) -> None:
    """Write columns of equal length side by side, a piece at a time."""
    (count,) = {values.shape[0] for values in columns.values()}
    heads = io.StringIO()
    csv.writer(heads).writerow([escaped(head) for head in columns])
    require_mark(path, heads.getvalue().encode(), "export of the same columns")
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        file.write(heads.getvalue())
        writer = csv.writer(file)
        for span in pieces(count):
            rows = zip(*(v[span].tolist() for v in columns.values()), strict=True)
            writer.writerows([_cell(value) for value in row] for row in rows)


def _cell(value: object) -> str:
    """Return a cell; a number that is none is an empty one."""
    if isinstance(value, str):
        return escaped(value)
    return "" if isinstance(value, float) and isnan(value) else repr(value)


def write_mat(path: Path, tables: Sequence[ExportTable]) -> None:
    """Write one MAT file with plain variables: numbers and rows of text, no objects.

    Args:
        path: to write.
        tables: their columns become variables, units others called ``*_unit``.

    Raises:
        UsageError: there is a file that this function did not write, or the values
            exceed what such a file holds.
    """
    import scipy.io

    require_mark(path, _MAT_WORDS, "export")
    _require_mat_size(tables)

    content: dict[str, Array] = {}
    for table in tables:
        for name, column in table.columns.items():
            whole = f"{table.name}_{name}" if len(tables) > 1 else name
            variable = _variable(whole, content)
            content[variable] = _rows_of_text(np.asarray(column.values))
            if column.unit:
                own = _variable(f"{variable[: _LONGEST_NAME - 5]}_unit", content)
                content[own] = np.array([column.unit])
    with whole_file(path) as part:
        scipy.io.savemat(
            str(part), content, appendmat=False, do_compression=True, oned_as="row"
        )
        with part.open("r+b") as file:  # by this one is known from a file of others
            file.write(_MAT_WORDS.ljust(_MAT_TEXT))


def _require_mat_size(tables: Sequence[ExportTable]) -> None:
    """Raise `UsageError` where values exceed a MAT file, which is made in memory."""
    columns = [column for table in tables for column in table.columns.values()]
    needed = sum(c.values.dtype.itemsize * prod(c.values.shape) for c in columns)
    if needed > _MAT_BYTES:
        raise UsageError(
            f"{needed / 1e9:.1f} GB of values exceed a MAT file of version 5 (2 GB); "
            "use --to netcdf, which MATLAB reads with ncread"
        )


def _rows_of_text(values: Array) -> Array:
    """Give texts that are all empty a blank: no rows would be left of them."""
    if values.dtype.kind == "U" and not any(values.ravel().tolist()):
        return np.full(values.shape, " ")
    return values


def _variable(name: str, taken: Mapping[str, object]) -> str:
    """Return a name that MATLAB accepts and that is free."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    if not plain[:1].isalpha():
        plain = f"v_{plain}"
    plain = plain[:_LONGEST_NAME]
    candidate, count = plain, 1
    while candidate in taken:
        count += 1
        ending = f"_{count}"
        candidate = plain[: _LONGEST_NAME - len(ending)] + ending
    return candidate


def plain_name(name: str) -> str:
    """Return a name without what a path must not hold."""
    return re.sub(r"[^\w.-]", "_", name)[:80]
