# SPDX-License-Identifier: MIT
"""Which files of an archive are meant: patterns, folders, names; results apart."""

import glob
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from jointbench.acquisition.errors import UsageError
from jointbench.station.inputs import SESSION_SUFFIXES

RESULTS_SUFFIX = ".results.h5"


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


def _files(patterns: Sequence[str], *, results: bool) -> tuple[Path, ...]:
    found: dict[Path, None] = {}
    for pattern in patterns:
        here = [path for path in _named(pattern) if is_results_name(path) is results]
        if not here:
            what = "results (*.results.h5)" if results else "session (*.h5)"
            raise UsageError(
                f"{pattern!r} names no {what}; quote the pattern, "
                "for example 'archive/**/*.h5'"
            )
        found |= dict.fromkeys(here)
    return tuple(sorted(found))


def is_results_name(path: Path) -> bool:
    """Tell a results file by its name."""
    return path.name.endswith(RESULTS_SUFFIX)


def _named(pattern: str) -> Iterator[Path]:
    """Yield the files of a pattern; hidden folders, where stages are, stay out."""
    place = Path(pattern)
    if place.is_dir():
        pattern = os.path.join(glob.escape(pattern), "**", "*")  # noqa: PTH118
    elif place.exists():
        yield place
        return
    for name in glob.iglob(pattern, recursive=True):  # noqa: PTH207
        path = Path(name)
        if path.suffix.lower() in SESSION_SUFFIXES and not path.is_dir():
            yield path


def common_folder(files: Sequence[Path]) -> Path:
    """Return the deepest folder that holds all files."""
    return Path(os.path.commonpath([path.absolute().parent for path in files]))
