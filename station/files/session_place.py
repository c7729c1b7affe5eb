# SPDX-License-Identifier: MIT
"""Where a session is recorded, and when it takes the name that was asked for.

An earlier session of that name is safe until the new one has come to its end: the new
one is recorded beside it, and takes its place only then.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.file_lock import locked
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.replace_file import replace_file
from jointbench.acquisition.session_file.overwrite_guard import (
    fresh_path,
    require_replaceable,
)
from jointbench.station.files.output_paths import check_outputs

SUFFIXES = frozenset({".h5", ".hdf5"})


@dataclass(frozen=True, slots=True)
class Place:
    """Two names of a session.

    Attributes:
        asked: the name it is to have.
        own: the name it is recorded under; the same unless there is an earlier session.
    """

    asked: Path
    own: Path

    @property
    def stays(self) -> str:
        """Which file is which while both are there, in words; empty for one file."""
        if self.own == self.asked:
            return ""
        return (
            f"{named(self.asked)} stays as it was, what was recorded is in "
            f"{named(self.own)}"
        )

    def settle(self, *, whole: bool) -> Path:
        """Let the session take its name, if it came to its end.

        Args:
            whole: whether all was recorded as it should be.

        Returns:
            Where the session is now.

        Raises:
            UsageError: the system refuses; both files are there.
        """
        if self.own == self.asked or not whole:
            return self.own
        try:
            replace_file(self.own, self.asked)
        except OSError as error:
            raise UsageError(
                f"{named(self.asked)} cannot be replaced: {error.strerror}; the new "
                f"session is in {named(self.own)}"
            ) from error
        return self.asked


def check_session_name(out: Path) -> None:
    """Raise `UsageError` unless a path is named as a session file."""
    if out.suffix.lower() not in SUFFIXES:
        raise UsageError(f"'{out}' is no session file; name it *.h5")


@contextmanager
def session_place(out: Path, *, overwrite: bool) -> Iterator[Place]:
    """Find the place of a session that will be recorded; nothing is removed here.

    Args:
        out: the name it is to have.
        overwrite: whether an earlier session of that name may be replaced.

    Yields:
        The place. An earlier session's lock is held meanwhile, so it stays.

    Raises:
        UsageError: there can be no such file, it is there and `overwrite` is off, it
            is being recorded, or it is no session of the station.
    """
    if not (out.exists() or out.is_symlink()):
        check_outputs([], [out])
        yield Place(out, out)
        return
    if not overwrite:
        raise UsageError(f"'{out}' is there already; add --force to overwrite it")
    require_replaceable(out)
    with locked(out):
        yield Place(out, fresh_path(out))
