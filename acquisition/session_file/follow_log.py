# SPDX-License-Identifier: MIT
"""The log of a session: of a recording while it is written, and of a finished file."""

from pathlib import Path
from typing import Any

import h5py

from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.session_file.live_read import log_entries
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.store import damage_named

EVENTS, LOG = "events", "log"
"""Group and variable of a finished session that hold the log as it was written."""


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
    with open_guarded(path) as file, damage_named(path):
        live = read_attribute(file, "schema") == LIVE_SCHEMA
        dataset = file.get(LOG if live else f"{EVENTS}/{LOG}")
        if not isinstance(dataset, h5py.Dataset):
            return (), live
        return tuple(log_entries(dataset[...].tobytes())), live
