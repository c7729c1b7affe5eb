# SPDX-License-Identifier: MIT
"""Reserved disk space for a file that HDF5 writes directly."""

import os
from typing import IO

import h5py

_RESERVE = 2**20  # bytes, more than HDF5 needs for itself and for closing
_STEP = 2**23  # bytes reserved at once


class DiskRoom:
    """Disk space that is reserved before HDF5 writes.

    On a full disk HDF5 cannot close its file, and crashes the process at its end. So
    space is reserved beforehand, beyond that used by HDF5: the error occurs here, and
    HDF5 still has room to close.
    """

    def __init__(self, handle: IO[bytes], file: h5py.File) -> None:
        """Reserve space for a file.

        Args:
            handle: of the same file, open for reading and writing.
            file: open in HDF5; it is flushed after every item.
        """
        self._handle, self._file = handle, file
        self._size = int(file.id.get_filesize())

    def make(self, count: int) -> None:
        """Reserve room for an item of `count` bytes.

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
