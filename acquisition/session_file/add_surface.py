# SPDX-License-Identifier: MIT
"""Add a surface to a finished session; its other content is unchanged."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import read_session, write_session


def require_addable(path: Path, name: str) -> Session:
    """Return a session to which a surface of a name can be added.

    Args:
        path: of the session file.
        name: of the new surface.

    Raises:
        UsageError: the session is being recorded, was cut off, or has such a surface.
        BadData: it cannot be read.
    """
    if is_held(path):
        raise UsageError(f"'{path}' is being recorded; wait until it is done")
    with open_guarded(path, limits=SESSION_LIMITS) as file:
        live = read_attribute(file, "schema") == LIVE_SCHEMA
    if live:
        raise UsageError(
            f"'{path}' was cut off while it was recorded; `jointbench recover` it, and "
            "name the recovered session"
        )
    session = read_session(path)
    if any(surface.name == name for surface in session.surfaces):
        raise UsageError(
            f"'{path}' has a surface {name!r} already; choose another --name"
        )
    return session


def add_surface(path: Path, surface: Surface) -> None:
    """Rewrite a session with one more surface; replace the file when complete.

    Args:
        path: of the session file.
        surface: to add; its name is new to the session.

    Raises:
        UsageError: as for `require_addable`, or the file cannot be written.
        BadData: the session cannot be read.
    """
    session = require_addable(path, surface.name)
    more = replace(session, surfaces=(*session.surfaces, surface))
    write_session(more, path, overwrite=True)
