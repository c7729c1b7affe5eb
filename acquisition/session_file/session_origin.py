# SPDX-License-Identifier: MIT
"""Whether a session comes from simulated instruments; no sample is read."""

import json
from collections.abc import Iterable
from pathlib import Path

from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import damage_named


def any_simulated(sessions: Iterable[Path]) -> bool:
    """Return whether one of the sessions, finished or not, was simulated.

    Raises:
        BadData: a file cannot be opened or is damaged.
    """
    return any(map(_simulated, sessions))


def _simulated(path: Path) -> bool:
    with open_guarded(path, limits=SESSION_LIMITS) as file, damage_named(path):
        if read_attribute(file, "schema") != LIVE_SCHEMA:
            return bool(read_attribute(file, "simulated"))
        return bool(json.loads(str(read_attribute(file, "meta")))["simulated"])
