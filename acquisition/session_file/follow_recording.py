# SPDX-License-Identifier: MIT
"""The file of a recording while another process writes it: samples and log."""

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.session_file.follow_log import LOG, LogTail
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA


class RecordingTail:
    """An open recording; close it before its finished file takes its place.

    No one else may have the file open in this process (see `StoredBlocks`).

    Attributes:
        meta: as known before the first sample.
    """

    def __init__(self, path: Path) -> None:
        """Open the file of a recording.

        Raises:
            OSError: it is not there, or no recording.
            KeyError: it is not whole yet.
        """
        self._file = h5py.File(path, "r", libver="latest", swmr=True)
        try:
            self.meta = _head(self._file)
            self._samples = self._file["samples"]
            self._log = LogTail(self._file[LOG])
        except BaseException:
            self._file.close()
            raise

    def entries(self) -> tuple[dict[str, Any], ...]:
        """Return the entries of the log that were written since the last call.

        Raises:
            OSError: the file cannot be read.
        """
        return self._log.entries()

    def stored(self) -> int:
        """Return how many samples per channel are stored by now.

        Raises:
            OSError: the file cannot be read.
        """
        self._samples.refresh()
        return int(self._samples.shape[1])

    def read(self, start: int, stop: int) -> FloatArray:
        """Return stored samples, shape (n_channels, stop - start).

        Args:
            start: index of the first of them among those stored.
            stop: index one past the last one.

        Raises:
            OSError: the file cannot be read.
        """
        return np.asarray(self._samples[:, start:stop], dtype=np.float64)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def recording_tail(path: Path) -> RecordingTail | None:
    """Return an open recording; None where there is none (yet, or any more).

    Args:
        path: of the session.
    """
    with suppress(OSError, KeyError, RuntimeError, ValueError):
        return RecordingTail(path)
    return None


def _head(file: h5py.File) -> dict[str, Any]:
    if read_attribute(file, "schema") != LIVE_SCHEMA:
        raise OSError("the file is no recording")
    head: dict[str, Any] = json.loads(str(read_attribute(file, "meta")))
    return head
