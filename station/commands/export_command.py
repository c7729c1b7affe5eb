# SPDX-License-Identifier: MIT
"""``jointbench export``: sessions and results as CSV, MAT, netCDF or universal files.

Universal files of other programs are exported as tables as well, since a session
cannot hold FRFs and mode shapes.

A session gives samples and surfaces. Results give FRFs, modes, mode shapes, structure
functions and quantities, and the results of contact, joint and gap as JSON. Units are
in the column heads, in variables called ``*_unit``, in attributes, or in fields of the
format.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.formats.samples.universal import SUFFIXES
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.station.files.netcdf_tables import one_unit_each, write_netcdf
from jointbench.station.files.output_paths import (
    check_outputs,
    make_folder,
    require_mark,
    write_text,
)
from jointbench.station.files.session_tables import (
    labelled_tables,
    session_attributes,
    session_tables,
)
from jointbench.station.files.table_files import (
    ExportTable,
    plain_name,
    write_csv,
    write_mat,
)
from jointbench.station.files.universal_frf import write_universal
from jointbench.station.files.universal_samples import write_universal_samples
from jointbench.station.files.universal_tables import universal_tables
from jointbench.station.results.result_tables import (
    FACTS,
    result_modes,
    result_tables,
    result_texts,
)
from jointbench.station.results.results_read import is_results
from jointbench.station.screen.terminal import console, write_json

KINDS = ("csv", "mat", "netcdf", "uff")
UNIVERSAL_MARK = b"jointbench"
"""Text in the first lines of a universal file that jointbench wrote."""


def run_export(
    file: Path, *, kind: str, folder: Path | None, json_target: str | None
) -> tuple[Path, ...]:
    """Write the content of a session or results file in another format.

    Args:
        file: session or results, or a universal file of another program.
        kind: ``csv``, ``mat``, ``netcdf`` or ``uff``.
        folder: to write to; next to the file by default.
        json_target: where the JSON goes.

    Returns:
        The files written.

    Raises:
        UsageError: an unknown format, a file without content for the format, or an
            existing file that is not an export.
        BadData: the file cannot be read.
    """
    if kind not in KINDS:
        raise UsageError(f"--to is {kind!r}; write one of {', '.join(KINDS)}")
    check_outputs([file], [json_target])
    target = (folder or file.parent) / file.name.removesuffix(file.suffix)
    write = _writer(file, kind)
    make_folder(target.parent)
    written = tuple(write(file, target))
    for path in written:
        console(json_target).print(visible(str(path)), soft_wrap=True)
    write_json(json_target, {"files": [str(path) for path in written]})
    return written


def _writer(file: Path, kind: str) -> Callable[[Path, Path], Iterator[Path]]:
    """Return the function that writes this sort of file in the format."""
    if file.suffix.lower() in SUFFIXES:
        if kind in {"uff", "netcdf"}:
            raise UsageError(f"'{file}' is a universal file; use --to csv or --to mat")
        return lambda path, target: _write_tables(universal_tables(path), target, kind)
    if kind == "netcdf":
        return _netcdf_results if is_results(file) else _netcdf_session
    if is_results(file):
        return _universal_results if kind == "uff" else partial(_write_results, kind)
    if kind == "uff":
        return _universal_session
    return lambda path, target: _write_tables(
        session_tables(open_session(path)), target, kind
    )


def _write_tables(
    tables: Iterable[ExportTable], target: Path, kind: str
) -> Iterator[Path]:
    if kind == "csv":
        yield from write_csv(target, tables)
    else:
        path = target.with_name(f"{target.name}.mat")
        write_mat(path, list(tables))
        yield path


def _write_results(kind: str, file: Path, target: Path) -> Iterator[Path]:
    yield from _write_tables(result_tables(file), target, kind)
    for name, text in result_texts(file).items():
        path = target.with_name(f"{target.name}.{plain_name(name)}.json")
        write_text(path, f"{text}\n")
        yield path


def _netcdf_session(file: Path, target: Path) -> Iterator[Path]:
    """Write one flat file for each recording and surface."""
    session = open_session(file)
    facts = session_attributes(session)
    begun = f"{session.created} session {file.name} by {session.software}"
    for table, steps in labelled_tables(session):
        yield write_netcdf(target, table, facts, [begun, *map(_history_line, steps)])


def _history_line(step: Step) -> str:
    """Return a step as a line of the history."""
    detail = ", ".join(f"{name}={value}" for name, value in step.detail)
    return f"{step.name} {detail}".rstrip()


def _netcdf_results(file: Path, target: Path) -> Iterator[Path]:
    """Write one flat file for each group, a variable for each quantity."""
    facts, *tables = result_tables(file)
    stated = list(zip(*(facts.columns[n].values for n in FACTS), strict=True))
    whole = {str(name): str(value) for of, name, value in stated if not of}
    begun = f"{whole.pop('created', '')} {file.name} by {whole.pop('software', '')}"
    for name in ("Conventions", "title", "schema"):
        whole.pop(name, None)
    for table in tables:
        own = {str(n): str(value) for of, n, value in stated if of == table.name}
        flat = one_unit_each(table) if table.name == "quantities" else table
        yield write_netcdf(target, flat, whole | own, [begun.strip()])


def _universal_session(file: Path, target: Path) -> Iterator[Path]:
    session = open_session(file)
    if not session.recordings:
        raise UsageError(
            f"'{file}' contains no samples for a universal file; use --to csv"
        )
    path = target.with_name(f"{target.name}.uff")
    require_mark(path, UNIVERSAL_MARK, "export")
    write_universal_samples(path, session)
    yield path


def _universal_results(file: Path, target: Path) -> Iterator[Path]:
    """Write FRFs and mode shapes, one file for each preload."""
    found = result_modes(file)
    if not found:
        raise UsageError(
            f"'{file}' contains no modes for a universal file; use --to csv"
        )
    for name, frf, modes in found:
        own = f".{plain_name(name)}" if len(found) > 1 else ""
        path = target.with_name(f"{target.name}{own}.uff")
        require_mark(path, UNIVERSAL_MARK, "export")
        write_universal(path, frf, modes)
        yield path
