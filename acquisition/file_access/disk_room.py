# SPDX-License-Identifier: MIT
"""Room on the disk for a file that HDF5 writes to directly."""

import os
from typing import IO

import h5py

_RESERVE = 2**20  # bytes, more than HDF5's own and the close of the file take
_STEP = 2**23  # bytes taken at once


class DiskRoom:
    """Disk that is taken before HDF5 writes to it.

    HDF5 that meets a full disk cannot close its file any more, and crashes the process
    when it ends. So the disk is asked beforehand, beyond what HDF5 has used: it says
    no to us, and HDF5 still has the room to close.
    """

    def __init__(self, handle: IO[bytes], file: h5py.File) -> None:
        """Look after a file.

        Args:
            handle: of the same file, open for reading and writing.
            file: open in HDF5; it is flushed after every item.
        """
        self._handle, self._file = handle, file
        self._size = int(file.id.get_filesize())

    def make(self, count: int) -> None:
        """See to it that there is room for an item of so many bytes.

        Raises:
            OSError: there is none.
        """
        needed = int(self._file.id.get_filesize()) + count + _RESERVE
        if needed <= self._size:
            return
        try:
            self._take(needed + _STEP)
        except OSError:
            self._take(needed)

    def _take(self, size: int) -> None:
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(self._handle.fileno(), self._size, size - self._size)
        else:
            self._handle.seek(self._size)
            self._handle.write(bytes(size - self._size))
            self._handle.flush()
        self._size = size
