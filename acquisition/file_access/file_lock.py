# SPDX-License-Identifier: MIT
"""One writer per file: a lock that the system releases when its holder ends."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named

if sys.platform == "win32":
    import msvcrt

    def _grab(file: IO[bytes]) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _grab(file: IO[bytes]) -> None:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


def lock_path(path: Path) -> Path:
    """Return the path of the lock of a session file."""
    return path.with_name(path.name + ".lock")


def hold_lock(path: Path) -> IO[bytes]:
    """Hold the lock of a session file until the returned file is closed.

    Raises:
        UsageError: another process holds it, or the folder cannot be written.
    """
    while True:
        file = _grabbed(path)
        if _is_there(file, path):
            return file
        file.close()


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file within the context.

    Raises:
        UsageError: another process holds it, or the folder cannot be written.
    """
    file = hold_lock(path)
    try:
        yield
    finally:
        drop_lock(path, file)


def _grabbed(path: Path) -> IO[bytes]:
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


def _is_there(file: IO[bytes], path: Path) -> bool:
    """Return whether an acquired lock is still the file under its name.

    Its last holder may have removed it between opening and locking.
    """
    try:
        return os.path.samestat(os.fstat(file.fileno()), lock_path(path).stat())
    except FileNotFoundError:
        return False


def is_held(path: Path) -> bool:
    """Return whether a process is recording into a session file."""
    if not lock_path(path).exists():
        return False
    try:
        hold_lock(path).close()
    except UsageError:
        return True
    return False


def drop_lock(path: Path, file: IO[bytes]) -> None:
    """Release the lock of a session file, and remove it."""
    if sys.platform != "win32":
        # Removed while held, so that no other process's lock is removed.
        with suppress(OSError):
            lock_path(path).unlink(missing_ok=True)
    file.close()
    if sys.platform == "win32":  # an open file cannot be removed there
        with suppress(OSError):
            lock_path(path).unlink(missing_ok=True)
