# SPDX-License-Identifier: MIT
"""Samples of a session file while another process writes it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.file_access.followed_files import follow_file, leave_file
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.ni.stream_records import Block
from jointbench.acquisition.session_file.follow_log import LOG, LogTail
from jointbench.acquisition.session_file.live_read import LiveSpan


class StoredBlocks:
    """Read stored samples block by block; close it after use.

    Meanwhile the file cannot be opened for anything else in this process; see
    `followed_files`.
    """

    def __init__(self, path: Path, block: int) -> None:
        """Open the file of a recording.

        Args:
            path: of the file.
            block: most samples of a block.

        Raises:
            InstrumentError: it cannot be opened.
        """
        self._path, self._block = path, block
        try:
            self._key = follow_file(path)
            self._file = h5py.File(path, "r", libver="latest", swmr=True)
        except OSError as error:
            raise InstrumentError(
                f"{named(path)} cannot be read while it is written ({error}); use a "
                "folder on a disk of this computer"
            ) from error
        self._samples = self._file["samples"]
        self._log = LogTail(self._file[LOG])

    def read(self, span: LiveSpan) -> Iterator[Block]:
        """Yield the samples of a span in blocks, in double precision.

        Raises:
            InstrumentError: the disk refuses.
        """
        for stored in range(span.stored, span.past, self._block):
            part = span.cut(stored, min(stored + self._block, span.past))
            yield Block(self._values(part), part.segment, part.first)

    def entries(self) -> tuple[dict[str, Any], ...]:
        """Return the entries of the log that were written since the last call.

        Raises:
            InstrumentError: the disk refuses.
        """
        try:
            return self._log.entries()
        except (OSError, RuntimeError) as error:
            raise self._unreadable(error) from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        leave_file(self._key)

    def _values(self, part: LiveSpan) -> np.ndarray:
        try:
            if self._samples.shape[1] < part.past:
                self._samples.refresh()
            return np.asarray(
                self._samples[:, part.stored : part.past], dtype=np.float64
            )
        except (OSError, RuntimeError) as error:
            raise self._unreadable(error) from error

    def _unreadable(self, error: Exception) -> InstrumentError:
        return InstrumentError(
            f"{named(self._path)} cannot be read back ({error}); what was recorded is "
            "safe"
        )
