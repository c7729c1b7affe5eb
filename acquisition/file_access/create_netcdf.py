# SPDX-License-Identifier: MIT
"""A netCDF-4 file that appears under its name only when complete."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.netcdf_write import write_attributes
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.replace_file import replace_file

_CONVENTIONS = "CF-1.11"
_GROWTH = 2**22  # bytes by which a file in memory grows
_IN_MEMORY: dict[str, Any] = {
    "driver": "core",
    "backing_store": False,
    "block_size": _GROWTH,
}


@contextmanager
def new_file(
    path: Path | str,
    *,
    schema: str,
    title: str,
    overwrite: bool = False,
    memory: bool = True,
) -> Iterator[h5py.File]:
    """Write a file that appears under its name only when complete.

    It is written to ``<name>.part`` next to it, flushed to the disk and renamed.

    Args:
        path: of the new file.
        schema: name and version of the layout, for example ``"jointbench-session/1"``.
        title: one line for readers in other programs.
        overwrite: replace an existing file.
        memory: build the whole file in memory first; a caller with more data writes to
            the disk, and reserves room (`DiskRoom`).

    Yields:
        The open file, with its root attributes set.

    Raises:
        UsageError: there is such a file and `overwrite` is off, or it cannot be
            written there.
    """
    path = Path(path)
    _require_free(path, overwrite)
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(b"")  # an unwritable folder is reported before the work
        # On a full disk HDF5 crashes the process at its end: it writes to memory, and
        # the result is written to the disk in one piece.
        with h5py.File(part, "w", **(_IN_MEMORY if memory else {})) as file:
            attributes = {"Conventions": _CONVENTIONS, "title": title, "schema": schema}
            write_attributes(file, attributes)
            yield file
            file.flush()
            image = file.id.get_file_image() if memory else None
            size = int(file.id.get_filesize())
        if image is not None:
            part.write_bytes(image)
        else:
            os.truncate(part, size)  # HDF5 keeps the reserve of `DiskRoom`
        _sync(part)
        _require_free(path, overwrite)
        replace_file(part, path)
        _sync(path.parent)
    except OSError as error:
        raise UsageError(
            f"{named(path)} cannot be written: {_reason(error)}; choose another place"
        ) from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _require_free(path: Path, overwrite: bool) -> None:
    if path.is_dir():
        raise UsageError(f"{named(path)} is a folder; name a file in it")
    if path.exists() and not path.is_file():
        raise UsageError(f"{named(path)} is no file; name one that may be written")
    if not overwrite and path.exists():
        raise UsageError(
            f"{named(path)} exists already; choose another name, or allow overwriting"
        )


def _reason(error: OSError) -> str:
    """Return the system's text for an error, without HDF5's own message."""
    found = re.search(r"errno = (\d+)", str(error))
    code = error.errno or (int(found[1]) if found else 0)
    return os.strerror(code) if code else "the system refused"


def _sync(path: Path) -> None:
    """Flush a file, or the entries of a folder where possible, to the disk."""
    # Windows flushes only what is open for writing.
    flags = os.O_RDONLY if path.is_dir() else os.O_RDWR
    try:
        handle = os.open(path, flags)
    except OSError:
        if path.is_dir():  # not on Windows
            return
        raise
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
