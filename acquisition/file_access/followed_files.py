# SPDX-License-Identifier: MIT
"""Files that this process follows while another one writes them.

HDF5 shares what it knows of a file between all its handles in a process. After one of
them has refreshed a dataset, a second one finds wrong chunks in it, or none at all
(h5py issue 2803): samples that are in the file read as damaged.
"""

from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named

_followed: set[tuple[int, int]] = set()


def follow_file(path: Path) -> tuple[int, int]:
    """Note that a file is followed here; return the key for `leave_file`.

    Raises:
        OSError: it is not there.
    """
    status = path.stat()
    key = status.st_dev, status.st_ino
    _followed.add(key)
    return key


def leave_file(key: tuple[int, int]) -> None:
    """Note that a file is not followed any more."""
    _followed.discard(key)


def require_not_followed(path: Path) -> None:
    """Refuse a file that this process follows.

    Raises:
        UsageError: it would be read wrongly.
    """
    try:
        status = path.stat()
    except OSError:
        return
    if (status.st_dev, status.st_ino) in _followed:
        raise UsageError(
            f"{named(path)} is being recorded and followed by this program; read it "
            "from another process, or after the recording"
        )
