# SPDX-License-Identifier: MIT
"""The log of a session: of a recording while it is written, and of a finished file."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.session_file.live_read import log_entries
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import damage_named

EVENTS, LOG = "events", "log"
"""Group and variable of a finished session that hold the log as it was written."""


class LogTail:
    """The log of a recording from where it was read last."""

    def __init__(self, dataset: h5py.Dataset) -> None:
        """Begin before the first entry.

        Args:
            dataset: of the log; its file may be written by another process.
        """
        self._dataset, self._read = dataset, 0

    def entries(self) -> tuple[dict[str, Any], ...]:
        """Return the entries that were written since the last call.

        Bytes that were announced and not yet written are read at the next call.

        Raises:
            OSError: the file cannot be read.
        """
        self._dataset.refresh()
        if self._dataset.shape[0] <= self._read:
            return ()
        text = self._dataset[self._read :].tobytes()
        while text:
            whole, end, _ = text.rpartition(b"\n")
            found = tuple(log_entries(whole))
            if len(found) == whole.count(b"\n") + bool(end):
                self._read += len(whole) + len(end)
                return found
            text = whole.rpartition(b"\n")[0] + b"\n" if b"\n" in whole else b""
        return ()


def read_log(path: Path) -> tuple[tuple[dict[str, Any], ...], bool]:
    """Return the entries of the log so far, and whether it is that of a recording.

    The file is opened each time, so that the finished session in its place is seen.

    Args:
        path: of a recording, or of a session that was recorded.

    Returns:
        The entries; of a session that was not recorded by this program, none.

    Raises:
        BadData: it cannot be opened, or is damaged.
    """
    with open_guarded(path, limits=SESSION_LIMITS) as file, damage_named(path):
        live = read_attribute(file, "schema") == LIVE_SCHEMA
        dataset = file.get(LOG if live else f"{EVENTS}/{LOG}")
        if not isinstance(dataset, h5py.Dataset):
            return (), live
        return tuple(log_entries(dataset[...].tobytes())), live


def read_last(path: Path, count: int) -> FloatArray | None:
    """Return the last samples of a recording, shape (n_channels, n).

    Args:
        path: of a recording that is being written.
        count: at most, per channel.

    Returns:
        The samples; None where the file is no recording (any more).
    """
    try:
        with open_guarded(path, limits=SESSION_LIMITS) as file:
            samples = file.get("samples")
            if not isinstance(samples, h5py.Dataset):
                return None
            found: FloatArray = samples[:, max(0, samples.shape[1] - count) :]
            return found.astype(np.float64)
    except (BadData, OSError, RuntimeError):
        return None
