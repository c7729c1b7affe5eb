# SPDX-License-Identifier: MIT
"""The session file: raw data with provenance, in netCDF-compatible HDF5.

Layout, version 1::

    /                    schema, uuid, created, software, simulated, operator, ...
    /setup               how the joint was set up
    /stream/<recording>  samples, time axis, channels
    /hits/<recording>    judged hits, by sample index
    /surfaces/<surface>  heights and the mask of the points that are there
    /provenance          what was done, step by step

Results are written to a separate file, so that raw data can be made read-only. See
`streams` and `extras` for the groups.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.file_lock import locked
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
)
from jointbench.acquisition.file_access.netcdf_write import write_attributes
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.records.recordings import Samples
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.live_read import read_live
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.overwrite_guard import require_session
from jointbench.acquisition.session_file.record_groups import in_order
from jointbench.acquisition.session_file.recovery import session_from_live
from jointbench.acquisition.session_file.streams import (
    recording_from_group,
    write_recording,
)
from jointbench.acquisition.session_file.surfaces_and_setup import (
    read_provenance,
    read_setup,
    surface_from_group,
    write_provenance,
    write_setup,
    write_surface,
)

SESSION_SCHEMA = "jointbench-session/1"
SESSION_TITLE = "jointbench session: raw recordings and surfaces"
# Exceptions of h5py, NumPy, JSON and the records for damaged content.
_DAMAGE = (KeyError, ValueError, TypeError, OSError, RuntimeError, OverflowError)
_TEXTS = ("uuid", "created", "software", "operator", "notes", "source")


def write_session(
    session: Session, path: Path | str, *, overwrite: bool = False
) -> None:
    """Write a session completely or not at all.

    Args:
        session: what to write.
        path: of the file, usually ``*.h5``.
        overwrite: replace an existing file.

    Raises:
        UsageError: there is such a file and `overwrite` is off, it is being recorded,
            it is no session, or it cannot be written there.
        BadData: a record is empty, or holds a text that cannot be stored.
    """
    with locked(Path(path)), _own_file(Path(path), overwrite=overwrite) as file:
        write_head(file, session)
        for position, recording in enumerate(session.recordings):
            write_recording(file, recording, position)
        for position, surface in enumerate(session.surfaces):
            write_surface(file, surface, position)
        write_provenance(file, session)


def write_head(file: h5py.File, session: Session) -> None:
    """Write the attributes of a session, without recordings and surfaces."""
    write_attributes(file, {name: getattr(session, name) for name in _TEXTS})
    write_attributes(file, {"simulated": bool(session.simulated)})
    write_setup(file, session.joint)


@contextmanager
def _own_file(path: Path, *, overwrite: bool) -> Iterator[h5py.File]:
    if overwrite:
        require_session(path)
    with new_file(
        path, schema=SESSION_SCHEMA, title=SESSION_TITLE, overwrite=overwrite
    ) as file:
        yield file


def read_session(path: Path | str) -> Session:
    """Read a session, bit for bit as written.

    A recording that was killed, or is still running, opens as the session recorded so
    far; its file is not changed.

    Args:
        path: of a file that `write_session` or `LiveSession` made.

    Raises:
        BadData: it cannot be opened.
        FormatError: it is no session file, of a later layout, or damaged.
        HostileFile: it exceeds the limits of a measurement.
    """
    with open_guarded(path) as file, damage_named(path):
        if read_attribute(file, "schema") == LIVE_SCHEMA:
            return session_from_live(file, read_live(file))
        require_schema(file, SESSION_SCHEMA, path)
        return read_content(file)


@contextmanager
def damage_named(path: Path | str) -> Iterator[None]:
    """Convert exceptions for damaged content to one line with the file name.

    Raises:
        FormatError: instead of the original error.
    """
    try:
        yield
    except BadData as error:
        if named(path) in str(error):
            raise
        raise FormatError(f"{named(path)}: {error}; use another copy") from error
    except _DAMAGE as error:
        raise FormatError(
            f"{named(path)} is damaged ({shown(error)}); use another copy"
        ) from error


def require_schema(file: h5py.File, schema: str, path: Path | str) -> None:
    """Raise `FormatError` unless a file has the layout `schema`."""
    found = read_attribute(file, "schema")
    if found == schema:
        return
    family = schema.partition("/")[0]
    if isinstance(found, str) and found.startswith(f"{family}/"):
        way = "read it with the version of jointbench that wrote it, or a later one"
    else:
        way = "`jointbench inspect` lists its content"
    raise FormatError(
        f"{named(path)} has the layout {shown(found)}, {schema!r} is needed; {way}"
    )


def read_content(
    file: h5py.File, samples: Callable[[h5py.Dataset], Samples] = read_array
) -> Session:
    """Read an open session.

    Args:
        file: of the layout `SESSION_SCHEMA`.
        samples: reads the samples of a recording, or stands for them.
    """
    steps = read_provenance(file)
    texts = {name: str(read_attribute(file, name) or "") for name in _TEXTS}
    return Session(
        **texts,
        simulated=bool(read_attribute(file, "simulated")),
        joint=read_setup(file),
        recordings=tuple(
            recording_from_group(
                file,
                group,
                steps.get(("recording", str(read_attribute(group, "name"))), ()),
                samples,
            )
            for group in in_order(file, "stream")
        ),
        surfaces=tuple(
            surface_from_group(
                group, steps.get(("surface", str(read_attribute(group, "name"))), ())
            )
            for group in in_order(file, "surfaces")
        ),
        provenance=steps.get(("session", ""), ()),
    )
