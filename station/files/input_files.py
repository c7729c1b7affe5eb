# SPDX-License-Identifier: MIT
"""Input files of a command: sessions, hit tables and surfaces, by content."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UnitError, UsageError
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.column_roles import (
    QUANTITY_NAMES,
    roles_named,
)
from jointbench.acquisition.formats.columns import (
    SURFACE_EXAMPLES,
)
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.formats.samples.read_samples import read_samples
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.acquisition.session_file.store import read_session

SESSION_SUFFIXES = (".h5", ".hdf5")


def is_session_name(path: Path) -> bool:
    """Return whether a path is named like an HDF5 file."""
    return path.suffix.lower() in SESSION_SUFFIXES


def read_foreign(path: Path, options: SampleOptions) -> tuple[Recording | Surface, ...]:
    """Read one foreign file as hits or as a surface.

    Args:
        path: of the file.
        options: what the user says about it; a measured column makes a plain table
            hits. Formats that state their units do without columns.

    Returns:
        A recording or a surface, named after the file; one for each stream where it
        holds several.

    Raises:
        BadData: the file is neither, or its units are missing; the message names what
            to type.
    """
    samples = read_samples(path, options)
    if samples:
        return samples
    columns, point, rate = options.columns, options.point, options.rate
    if rate is not None or roles_named(columns) & {"time", *QUANTITY_NAMES}:
        return (read_recording(path, columns=columns, point=point, rate=rate),)
    try:
        return (read_surface(path, columns=columns),)
    except UnitError as surface_error:
        if columns is not None:
            raise
        try:
            return (read_recording(path, columns=None, point=point),)
        except UnitError as error:
            heights = " or ".join(f"'{example}'" for example in SURFACE_EXAMPLES)
            raise UnitError(
                f"{error}; for heights --columns {heights}"
            ) from surface_error


def read_recordings(
    files: Sequence[Path],
    *,
    columns: str | None,
    point: str,
    rate: float | None = None,
) -> tuple[Recording, ...]:
    """Read the recordings of sessions and hit files.

    Args:
        files: any.
        columns: of files that are no sessions.
        point: where the hammer struck, for these.
        rate: of those without times [Hz], or None.

    Raises:
        BadData: a file cannot be read, or none holds a recording.
    """
    refuse_twice(files)
    found: list[Recording] = []
    for path in files:
        if is_session_name(path):
            found += open_session(path).recordings
        else:
            options = SampleOptions(columns, point, rate=rate)
            found += read_samples(path, options) or (
                read_recording(path, columns=columns, point=point, rate=rate),
            )
    if not found:
        names = ", ".join(path.name for path in files)
        raise BadData(f"no recording in {names}; 'jointbench inspect' shows what is")
    return tuple(found)


def refuse_twice(files: Sequence[Path]) -> None:
    """Raise `UsageError` where the same content is given twice: it is no repeat."""
    digests: dict[str, Path] = {}
    for path in files:
        digest = file_digest(path)
        if digest in digests:
            raise UsageError(
                f"'{path}' and '{digests[digest]}' hold the same data; a copy is no "
                "second measurement, give each once"
            )
        digests[digest] = path


def read_surfaces(
    files: Sequence[Path], *, columns: str | None
) -> tuple[tuple[Path, Surface], ...]:
    """Read the surfaces of sessions and surface files, each with its file.

    Raises:
        BadData: a file cannot be read, or none holds a surface.
    """
    found: list[tuple[Path, Surface]] = []
    for path in files:
        if is_session_name(path):
            found += [(path, surface) for surface in read_session(path).surfaces]
        else:
            found.append((path, read_surface(path, columns=columns)))
    if not found:
        names = ", ".join(path.name for path in files)
        raise BadData(f"no surface in {names}; 'jointbench inspect' shows what is")
    return tuple(found)
