# SPDX-License-Identifier: MIT
"""Check which file a new session may replace: an earlier one that is not recording."""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS

FAMILIES = ("jointbench-session/", "jointbench-live/")
"""Prefixes of the layouts of finished sessions and of recordings."""


def require_session(path: Path) -> None:
    """Refuse an existing file that is no session of the station.

    Raises:
        UsageError: it is a folder, a device, a file of another kind, or damaged.
    """
    if not path.exists() and not path.is_symlink():
        return
    try:
        file_size(path)
        with open_guarded(path, limits=SESSION_LIMITS) as file:
            schema = read_attribute(file, "schema")
    except BadData:
        schema = None
    if not str(schema).startswith(FAMILIES):
        raise UsageError(
            f"{named(path)} is there already and no session that can be read; choose "
            "another name, or move it away"
        )


def require_replaceable(path: Path) -> None:
    """Refuse a file that a new session must not replace.

    Raises:
        UsageError: it is being recorded right now, or is no session of the station.
    """
    if is_held(path):
        raise UsageError(
            f"{named(path)} is being recorded right now; wait until it is done, or "
            "choose another name"
        )
    require_session(path)


def fresh_path(path: Path, word: str = "new") -> Path:
    """Return an unused name next to `path`: ``s.new.h5``, ``s.new-2.h5``, ..."""
    number = 1
    while True:
        ending = word if number == 1 else f"{word}-{number}"
        candidate = path.with_name(f"{path.stem}.{ending}{path.suffix}")
        if not candidate.exists() and not candidate.is_symlink():
            return candidate
        number += 1
