# SPDX-License-Identifier: MIT
"""``jointbench export``: sessions and results as CSV, MAT or universal files.

Universal files of others go out as tables, too: FRFs and shapes have no place in a
session.

Sessions give their samples and surfaces, results their FRFs, modes, shapes, structure
functions and quantities, and the pages of contact, joint and gap as JSON. Units are in
the heads of the columns, in variables called ``*_unit``, or in fields of the format.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.formats.samples.universal import SUFFIXES
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.files.output_paths import (
    check_outputs,
    make_folder,
    require_mark,
    write_text,
)
from jointbench.station.files.table_files import (
    ExportColumn,
    ExportTable,
    plain_name,
    write_csv,
    write_mat,
)
from jointbench.station.files.universal_frf import write_universal
from jointbench.station.files.universal_samples import write_universal_samples
from jointbench.station.files.universal_tables import universal_tables
from jointbench.station.results.result_tables import (
    result_modes,
    result_tables,
    result_texts,
)
from jointbench.station.results.results_read import is_results
from jointbench.station.screen.terminal import console, write_json

KINDS = ("csv", "mat", "uff")
UNIVERSAL_MARK = b"jointbench"
"""What the first lines of a universal file of ours hold."""


def run_export(
    file: Path, *, kind: str, folder: Path | None, json_target: str | None
) -> tuple[Path, ...]:
    """Write what is in a session or results file in another format.

    Args:
        file: session or results, or a universal file of others.
        kind: ``csv``, ``mat`` or ``uff``.
        folder: where to; beside the file by default.
        json_target: where the JSON goes.

    Returns:
        The files written.

    Raises:
        UsageError: another kind, nothing in the file that the format takes, or a file
            in the way that no export made.
        BadData: the file cannot be read.
    """
    if kind not in KINDS:
        raise UsageError(f"--to is {kind!r}; write {', '.join(KINDS)}")
    check_outputs([file], [json_target])
    target = (folder or file.parent) / file.name.removesuffix(file.suffix)
    write = _way_out(file, kind)
    make_folder(target.parent)
    written = tuple(write(file, target))
    for path in written:
        console(json_target).print(visible(str(path)), soft_wrap=True)
    write_json(json_target, {"files": [str(path) for path in written]})
    return written


def _way_out(file: Path, kind: str) -> Callable[[Path, Path], Iterator[Path]]:
    """Return what writes a file of its sort in the format."""
    if file.suffix.lower() in SUFFIXES:
        if kind == "uff":
            raise UsageError(f"'{file}' is a universal file; write --to csv or mat")
        return lambda path, target: _write_tables(universal_tables(path), target, kind)
    if is_results(file):
        return _universal_results if kind == "uff" else partial(_write_results, kind)
    if kind == "uff":
        return _universal_session
    return lambda path, target: _write_tables(
        list(_tables(read_session(path))), target, kind
    )


def _write_tables(
    tables: Sequence[ExportTable], target: Path, kind: str
) -> Iterator[Path]:
    if kind == "csv":
        yield from write_csv(target, tables)
    else:
        path = target.with_name(f"{target.name}.mat")
        write_mat(path, tables)
        yield path


def _write_results(kind: str, file: Path, target: Path) -> Iterator[Path]:
    yield from _write_tables(result_tables(file), target, kind)
    for name, text in result_texts(file).items():
        path = target.with_name(f"{target.name}.{plain_name(name)}.json")
        write_text(path, f"{text}\n")
        yield path


def _universal_session(file: Path, target: Path) -> Iterator[Path]:
    session = read_session(file)
    if not session.recordings:
        raise UsageError(f"'{file}' holds no samples for a universal file; use csv")
    path = target.with_name(f"{target.name}.uff")
    require_mark(path, UNIVERSAL_MARK, "export")
    write_universal_samples(path, session)
    yield path


def _universal_results(file: Path, target: Path) -> Iterator[Path]:
    """Write FRFs and shapes, a file for each preload."""
    found = result_modes(file)
    if not found:
        raise UsageError(f"'{file}' holds no modes for a universal file; use csv")
    for name, frf, modes in found:
        own = f".{plain_name(name)}" if len(found) > 1 else ""
        path = target.with_name(f"{target.name}{own}.uff")
        require_mark(path, UNIVERSAL_MARK, "export")
        write_universal(path, frf, modes)
        yield path


def _tables(session: Session) -> Iterator[ExportTable]:
    for recording in session.recordings:
        yield ExportTable(recording.name, _samples(recording))
    for surface in session.surfaces:
        yield ExportTable(surface.name, _heights(surface))


def _samples(recording: Recording) -> dict[str, ExportColumn]:
    count, along = recording.samples.shape[1], ("time",)
    time = recording.start_time + np.arange(count) / recording.sample_rate
    rows = {
        channel.name: ExportColumn(example_unit(channel.quantity.value), row, along)
        for channel, row in zip(recording.channels, recording.samples, strict=True)
    }
    return {"time": ExportColumn("s", time, along)} | rows


def _heights(surface: Surface) -> dict[str, ExportColumn]:
    heights = np.where(surface.valid, surface.heights, np.nan)
    steps = np.atleast_1d(surface.spacing)
    axes = np.meshgrid(
        *(np.arange(n) * d for n, d in zip(heights.shape, steps, strict=True)),
        indexing="ij",
    )
    names = ("y", "x")[-heights.ndim :]
    columns = dict(zip(names, axes, strict=True)) | {"z": heights}
    return {
        n: ExportColumn("m", values.ravel(), ("point",))
        for n, values in columns.items()
    }
