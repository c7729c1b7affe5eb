# SPDX-License-Identifier: MIT
"""One writer for one file: a lock that the system lets go of when its holder dies."""

import sys
from pathlib import Path
from typing import IO

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.text_files import named

if sys.platform == "win32":
    import msvcrt

    def _grab(file: IO[bytes]) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _grab(file: IO[bytes]) -> None:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def lock_path(path: Path) -> Path:
    """Return the lock that belongs to a session file."""
    return path.with_name(path.name + ".lock")


def hold_lock(path: Path) -> IO[bytes]:
    """Hold the lock of a session file until the returned file is closed.

    Raises:
        UsageError: another process holds it, or the folder cannot be written.
    """
    try:
        file = lock_path(path).open("ab")
    except OSError as error:
        raise UsageError(
            f"{named(path)} cannot be written: {error.strerror}; choose another place"
        ) from error
    try:
        _grab(file)
    except OSError as error:
        file.close()
        raise UsageError(
            f"{named(path)} is being recorded by another process; wait until it has "
            "finished, or choose another name"
        ) from error
    return file


def is_held(path: Path) -> bool:
    """Tell whether a process is recording into a session file right now."""
    if not lock_path(path).exists():
        return False
    try:
        hold_lock(path).close()
    except UsageError:
        return True
    return False


def drop_lock(path: Path, file: IO[bytes]) -> None:
    """Let go of the lock of a session file, and take it away."""
    file.close()
    try:
        lock_path(path).unlink(missing_ok=True)
    except OSError:  # on Windows another process may just be looking at it
        return
