# SPDX-License-Identifier: MIT
"""A netCDF-4 file that appears under its name only once it is whole."""

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
    """Write a file that appears under its name only once it is whole.

    It is written to ``<name>.part`` beside it, forced to the disk and renamed.

    Args:
        path: of the file to be.
        schema: name and version of the layout, for example ``"jointbench-session/1"``.
        title: one line for people who open it elsewhere.
        overwrite: replace a file that is there.
        memory: make the whole file in memory first; whoever writes more than that
            holds writes to the disk, and sees to it that there is room (`DiskRoom`).

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
        part.write_bytes(b"")  # a folder that takes no file says so before the work
        # HDF5 that meets a full disk crashes the process when it ends: it writes to
        # memory, and what it made goes to the disk in one piece.
        with h5py.File(part, "w", **(_IN_MEMORY if memory else {})) as file:
            attributes = {"Conventions": _CONVENTIONS, "title": title, "schema": schema}
            write_attributes(file, attributes)
            yield file
            file.flush()
            image = file.id.get_file_image() if memory else None
        if image is not None:
            part.write_bytes(image)
        _sync(part)
        _require_free(path, overwrite)
        part.replace(path)
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
            f"{named(path)} is there already; choose another name, or say that it may "
            "be overwritten"
        )


def _reason(error: OSError) -> str:
    """Return the system's word for an error, without HDF5's account of itself."""
    told = re.search(r"errno = (\d+)", str(error))
    code = error.errno or (int(told[1]) if told else 0)
    return os.strerror(code) if code else "the system refused"


def _sync(path: Path) -> None:
    """Force a file, or the entries of a folder where the system can, to the disk."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        if path.is_dir():  # not on Windows
            return
        raise
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
