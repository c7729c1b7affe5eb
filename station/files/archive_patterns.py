# SPDX-License-Identifier: MIT
"""Which files of an archive are meant: patterns, folders, names; results apart."""

import glob
import logging
import os
from collections.abc import Iterator, Sequence
from itertools import takewhile
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.station.files.input_files import SESSION_SUFFIXES

RESULTS_SUFFIX = ".results.h5"
logger = logging.getLogger(__name__)


def session_files(patterns: Sequence[str]) -> tuple[Path, ...]:
    """Return the session files that patterns name, each once, in order of name.

    Args:
        patterns: names, folders (all below is meant) or patterns such as
            ``archive/**/*.h5``; quoted, so that the shell leaves them alone.

    Raises:
        UsageError: a pattern names nothing.
    """
    return _files(patterns, results=False)


def result_files(patterns: Sequence[str]) -> tuple[Path, ...]:
    """Return the results files that patterns name, likewise."""
    return _files(patterns, results=True)


def archive_files(patterns: Sequence[str], endings: Sequence[str]) -> tuple[Path, ...]:
    """Return sessions, results and files of other endings that patterns name.

    Args:
        patterns: as for `session_files`.
        endings: of further names, for example ``(".ledger.jsonl",)``.

    Raises:
        UsageError: a pattern names nothing.
    """
    found: dict[Path, Path] = {}
    for pattern in patterns:
        here = sorted(_named(pattern, endings), key=lambda one: (one.is_symlink(), one))
        if not here:
            _require_place(pattern)
            raise UsageError(
                f"{shown(pattern)} names no session or results; quote the pattern, for "
                "example 'archive/**/*.h5'"
            )
        for path in here:
            found.setdefault(path.resolve(), path)
    return tuple(sorted(found.values()))


def _files(patterns: Sequence[str], *, results: bool) -> tuple[Path, ...]:
    found: dict[Path, Path] = {}
    for pattern in patterns:
        here = [path for path in _named(pattern) if _is_meant(path, pattern, results)]
        if not here:
            _require_place(pattern)
            what = "results (*.results.h5)" if results else "session (*.h5)"
            remedy = "; 'jointbench reprocess' writes results" if results else ""
            raise UsageError(
                f"{shown(pattern)} names no {what}; quote the pattern, "
                f"for example 'archive/**/*.h5'{remedy}"
            )
        for path in sorted(here, key=lambda one: (one.is_symlink(), one)):
            found.setdefault(path.resolve(), path)
    return tuple(sorted(found.values()))


def _require_place(pattern: str) -> None:
    """Raise `UsageError` where a name, or the folder of a pattern, is not there."""
    if not glob.has_magic(pattern) and not Path(pattern).exists():
        raise UsageError(f"there is no file or folder {shown(pattern)}; check the path")
    folder = _beginning(pattern)
    if not folder.exists():
        raise UsageError(
            f"{shown(pattern)}: there is no folder {shown(str(folder))}; check the path"
        )


def _is_meant(path: Path, pattern: str, results: bool) -> bool:
    """Return whether a file is of the kind; results given by name may have any name."""
    given = results and path == Path(pattern)
    return given or is_results_name(path) is results


def is_results_name(path: Path) -> bool:
    """Return whether a name is that of a results file."""
    return path.name.endswith(RESULTS_SUFFIX)


def _named(pattern: str, endings: Sequence[str] = ()) -> Iterator[Path]:
    """Yield the files of a pattern; hidden folders, where stages are, stay out."""
    place = Path(pattern)
    if place.is_dir():
        pattern = str(Path(glob.escape(pattern)) / "**" / "*")
    elif place.exists():
        yield place
        return
    for path in _matching(pattern):
        meant = path.suffix.lower() in SESSION_SUFFIXES
        if (meant or path.name.endswith(tuple(endings))) and not path.is_dir():
            yield path


def _matching(pattern: str) -> Iterator[Path]:
    """Yield what a pattern matches; ``**`` meets each folder once, loop or not.

    `glob` follows links in circles: two loops in an archive never end.
    """
    parts = Path(pattern).parts
    if "**" not in parts:
        yield from map(Path, glob.iglob(pattern))  # noqa: PTH207
        return
    at = parts.index("**")
    rest = Path(*parts[at + 1 :] or ["*"])
    for base in glob.iglob(str(Path(*parts[:at]))):  # noqa: PTH207
        for folder in _folders(base):
            yield from _matching(str(Path(glob.escape(folder)) / rest))


def _folders(base: str) -> Iterator[str]:
    """Yield a folder and all below it that are not hidden, each once."""
    met: set[Path] = set()
    for folder, below, _ in os.walk(base, onerror=_tell, followlinks=True):
        place = Path(folder).resolve()
        if place in met:
            below.clear()
            continue
        met.add(place)
        below[:] = sorted(name for name in below if not name.startswith("."))
        yield folder


def _tell(error: OSError) -> None:
    """Warn of a skipped folder, unless it is hidden by convention."""
    name, reason = named(str(error.filename)), error.strerror
    logger.warning("jointbench: folder %s is passed over: %s", name, reason)


def archive_folder(patterns: Sequence[str]) -> Path:
    """Return the folder that patterns begin in, whatever they match today.

    An archive grows: what its files have in common may be another folder tomorrow.
    """
    return _common([_beginning(pattern) for pattern in patterns])


def _beginning(pattern: str) -> Path:
    """Return a folder, the folder of a file, or a pattern up to its first wildcard."""
    path = Path(pattern)
    if path.is_dir():
        return path
    if path.exists():
        return path.parent
    fixed = takewhile(lambda part: not glob.has_magic(part), path.parent.parts)
    return Path(*fixed)


def common_folder(files: Sequence[Path]) -> Path:
    """Return the deepest folder that holds all files."""
    return _common([path.parent for path in files])


def _common(folders: Sequence[Path]) -> Path:
    return Path(os.path.commonpath([os.path.abspath(one) for one in folders]))  # noqa: PTH100
