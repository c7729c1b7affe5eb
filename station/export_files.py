# SPDX-License-Identifier: MIT
"""``jointbench export``: sessions and results as CSV, MAT or universal files.

Sessions give their samples, results their FRFs, modes and quantities. Units are in the
heads of the columns, in variables called ``*_unit``, or in the fields of the format.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.guards import open_guarded
from jointbench.acquisition.netcdf_read import (
    is_dimension_only,
    read_array,
    read_attribute,
    read_complex,
    read_texts,
)
from jointbench.acquisition.records import Recording
from jointbench.acquisition.session import Session
from jointbench.acquisition.session_file import damage_named, read_session
from jointbench.acquisition.units import example_unit
from jointbench.station.archive_files import is_results_name
from jointbench.station.ledger import escaped
from jointbench.station.output import console, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.universal_samples import write_universal_samples

KINDS = ("csv", "mat", "uff")
_LONGEST_NAME = 31  # of a variable in MATLAB, as SciPy writes it
_MATRIX = 2


def run_export(
    file: Path, *, kind: str, folder: Path | None, json_target: str | None
) -> tuple[Path, ...]:
    """Write what is in a session or results file in another format.

    Args:
        file: session or results.
        kind: ``csv``, ``mat`` or ``uff`` (samples of a session only).
        folder: where to; beside the file by default.
        json_target: where the JSON goes.

    Returns:
        The files written.

    Raises:
        UsageError: another kind, or UFF of results, which `modal --uff` writes.
        BadData: the file cannot be read.
    """
    if kind not in KINDS:
        raise UsageError(f"--to is {kind!r}; write {', '.join(KINDS)}")
    check_outputs([file], [json_target])
    target = (folder or file.parent) / file.name.removesuffix(file.suffix)
    target.parent.mkdir(parents=True, exist_ok=True)
    results = is_results_name(file)
    if kind == "uff":
        if results:
            raise UsageError(
                "FRFs and shapes go into a universal file by `jointbench modal "
                "SESSION --uff PATH`; export writes samples, give the session"
            )
        path = target.with_name(f"{target.name}.uff")
        write_universal_samples(path, read_session(file))
        written: tuple[Path, ...] = (path,)
    else:
        tables = list(_result_tables(file) if results else _tables(read_session(file)))
        write = _write_csv if kind == "csv" else _write_mat
        written = tuple(write(target, tables))
    for path in written:
        console(json_target).print(f"{path}", soft_wrap=True)
    write_json(json_target, {"files": [str(path) for path in written]})
    return written


Table = tuple[str, Mapping[str, tuple[str, np.ndarray[Any, Any]]]]
"""A name, and its columns: unit and values by their names."""


def _tables(session: Session) -> Iterator[Table]:
    for recording in session.recordings:
        yield recording.name, _samples(recording)
    for surface in session.surfaces:
        heights = np.where(surface.valid, surface.heights, np.nan)
        steps = np.atleast_1d(surface.spacing)
        axes = np.meshgrid(
            *(np.arange(n) * d for n, d in zip(heights.shape, steps, strict=True)),
            indexing="ij",
        )
        names = ("y", "x")[-heights.ndim :]
        columns = {n: ("m", a.ravel()) for n, a in zip(names, axes, strict=True)}
        yield surface.name, columns | {"z": ("m", heights.ravel())}


def _samples(recording: Recording) -> dict[str, tuple[str, np.ndarray[Any, Any]]]:
    count = recording.samples.shape[1]
    time = recording.start_time + np.arange(count) / recording.sample_rate
    rows = {
        channel.name: (example_unit(channel.quantity.value), row)
        for channel, row in zip(recording.channels, recording.samples, strict=True)
    }
    return {"time": ("s", time)} | rows


def _result_tables(path: Path) -> Iterator[Table]:
    """Yield every group of a results file as a table of its own."""
    groups: list[str] = ["/"]
    with open_guarded(path) as file, damage_named(path):
        file.visititems(
            lambda name, item: (
                groups.append(name) if isinstance(item, h5py.Group) else None
            )
        )
        for name in groups:
            columns = dict(_columns(file[name]))
            if columns:
                yield name.strip("/").replace("/", "-") or "root", columns


def _columns(
    group: h5py.Group,
) -> Iterator[tuple[str, tuple[str, np.ndarray[Any, Any]]]]:
    for name, item in group.items():
        if not isinstance(item, h5py.Dataset) or is_dimension_only(item):
            continue
        unit = str(read_attribute(item, "units") or "")
        if item.dtype == np.dtype("S1"):
            yield name, ("", np.array(read_texts(item), dtype=np.str_))
        elif name.endswith("_re") and f"{name[:-3]}_im" in group:
            yield name[:-3], (unit, read_complex(group, name[:-3]))
        elif not name.endswith("_im"):
            yield name, (unit, read_array(item))


def _write_csv(target: Path, tables: Sequence[Table]) -> Iterator[Path]:
    """Write one file a table and length; numbers with all their digits."""
    for name, columns in tables:
        flat = dict(_flat(columns))
        for length in sorted({values.size for values in flat.values()}):
            own = {h: v for h, v in flat.items() if v.size == length}
            if not own or all(v.dtype.kind == "U" and v.size < 2 for v in own.values()):
                continue
            many = len({v.size for v in flat.values()}) > 1
            suffix = f".{length}" if many else ""
            path = target.with_name(f"{target.name}.{_plain(name)}{suffix}.csv")
            part = path.with_name(f"{path.name}.part")
            with part.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow([escaped(head) for head in own])
                for row in zip(*(v.tolist() for v in own.values()), strict=True):
                    writer.writerow([_cell(value) for value in row])
            part.replace(path)
            yield path


def _cell(value: object) -> str:
    """Return a cell; a number that is none is an empty one."""
    if isinstance(value, str):
        return escaped(value)
    return "" if isinstance(value, float) and isnan(value) else repr(value)


def _flat(
    columns: Mapping[str, tuple[str, np.ndarray[Any, Any]]],
) -> Iterator[tuple[str, np.ndarray[Any, Any]]]:
    """Yield columns of one dimension; the rows of a table become columns."""
    for name, (unit, values) in columns.items():
        parts = {"": values}
        if np.iscomplexobj(values):
            parts = {" re": values.real, " im": values.imag}
        for part, numbers in parts.items():
            rows = numbers.reshape(-1, numbers.shape[-1]) if numbers.ndim else numbers
            rows = np.atleast_2d(rows)
            for index, row in enumerate(rows):
                which = f" {index + 1}" if len(rows) > 1 else ""
                yield f"{name}{which}{part} [{unit}]" if unit else f"{name}{which}", row


def _write_mat(target: Path, tables: Sequence[Table]) -> Iterator[Path]:
    """Write one file with plain variables: numbers and rows of text, no objects."""
    import scipy.io

    content: dict[str, np.ndarray[Any, Any]] = {}
    for name, columns in tables:
        for column, (unit, values) in columns.items():
            whole = f"{name}_{column}" if len(tables) > 1 else column
            variable = _variable(whole, content)
            content[variable] = values
            if unit:
                own = _variable(f"{variable[: _LONGEST_NAME - 5]}_unit", content)
                content[own] = np.array([unit])
    path = target.with_name(f"{target.name}.mat")
    part = path.with_name(f"{path.name}.part")
    scipy.io.savemat(
        str(part), content, appendmat=False, do_compression=True, oned_as="row"
    )
    part.replace(path)
    yield path


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


def _plain(name: str) -> str:
    """Return a name without what a path must not hold."""
    return re.sub(r"[^\w.-]", "_", name)[:80]
