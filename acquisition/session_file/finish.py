# SPDX-License-Identifier: MIT
"""Convert the file of a recording to a finished session, piece by piece.

Samples are copied some columns at a time, so that a session of any length is finished,
or recovered, in constant memory.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import h5py

from jointbench.acquisition.basics.array_checks import require_finite
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.disk_room import DiskRoom
from jointbench.acquisition.file_access.file_lock import locked
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_write import write_variable
from jointbench.acquisition.session_file.follow_log import EVENTS, LOG
from jointbench.acquisition.session_file.live_read import (
    LiveContent,
    LiveSpan,
    Samples,
    read_live,
    read_pieces,
)
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.overwrite_guard import require_session
from jointbench.acquisition.session_file.recovery import is_finished, outline_live
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import (
    SESSION_SCHEMA,
    SESSION_TITLE,
    damage_named,
    require_schema,
    write_head,
)
from jointbench.acquisition.session_file.streams import write_recording_in_pieces
from jointbench.acquisition.session_file.surfaces_and_setup import write_provenance

# Packed size of the time axis, at most [bytes per sample].
_AXIS_SHARE = 0.125
_ENTRY_TWICE = 2  # a log entry is in the session both as text and as table


@dataclass(frozen=True, slots=True)
class Finished:
    """Summary of a finished recording.

    Attributes:
        samples: valid samples per channel.
        hits: number in the recordings.
        damaged: number of blocks left out.
        ended: whether it was ended regularly.
    """

    samples: int
    hits: int
    damaged: int
    ended: bool


def finish_live(
    source: Path,
    target: Path,
    *,
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Finished:
    """Write the session of a recording.

    Args:
        source: file of the recording, which must have ended.
        target: of the session; the source itself is replaced once the session is
            complete on the disk.
        overwrite: replace an existing file.
        progress: called with the share of the samples that is written [-].

    Raises:
        UsageError: there is such a file and `overwrite` is off, or it cannot be
            written there; the source is not changed.
        FormatError: the source is no recording, or damaged at its head.
    """
    new = new_file(
        target,
        schema=SESSION_SCHEMA,
        title=SESSION_TITLE,
        overwrite=overwrite,
        memory=False,
    )
    if overwrite:
        require_session(target)
    # The source is closed before the target takes its name.
    opened = open_guarded(source, limits=SESSION_LIMITS)
    with locked(target), new as file, opened as live:
        with damage_named(source):
            require_schema(live, LIVE_SCHEMA, source)
        return _copy(source, live, file, progress or (lambda share: None))


def _copy(
    source: Path, live: h5py.File, file: h5py.File, progress: Callable[[float], None]
) -> Finished:
    with damage_named(source):
        content = read_live(live)
        session, spans = outline_live(content)
    written, whole = 0, sum(span.count for span in spans)
    with Path(file.filename).open("rb+") as handle:
        room = DiskRoom(handle, file)
        room.make(_ENTRY_TWICE * int(live["log"].shape[0]))
        write_head(file, session)
        for position, (recording, span) in enumerate(
            zip(session.recordings, spans, strict=True)
        ):
            room.make(round(_AXIS_SHARE * span.count))
            write_recording_in_pieces(
                file,
                recording,
                position,
                count=span.count,
                pieces=_pieces(
                    source,
                    live,
                    span,
                    room,
                    partial(_report, progress, written, whole),
                ),
            )
            written += span.count
        write_provenance(file, session)
        _write_log(live, file)
        file.flush()
    return _account(content, sum(len(r.hits) for r in session.recordings))


def _report(
    progress: Callable[[float], None], before: int, whole: int, done: int
) -> None:
    """Report the share of all samples that is written, those before a span included."""
    progress((before + done) / whole)


def _write_log(live: h5py.File, file: h5py.File) -> None:
    """Keep the log as it was written, for a replay."""
    values = live[LOG][...]
    if values.size:
        write_variable(
            file.create_group(EVENTS),
            LOG,
            values,
            ("byte",),
            long_name="events, a line each: CRC-32 and JSON",
        )


def _pieces(
    source: Path,
    live: h5py.File,
    span: LiveSpan,
    room: DiskRoom,
    progress: Callable[[int], None],
) -> Iterator[Samples]:
    """Yield the samples of a span after reserving room for them.

    Progress receives how many samples of the span were taken.
    """
    pieces = read_pieces(live, span.stored, span.count)
    done = 0
    while True:
        with damage_named(source):
            piece = next(pieces, None)
            if piece is not None:
                require_finite("samples", piece)
        if piece is None:
            return
        room.make(piece.nbytes)
        yield piece
        done += piece.shape[1]
        progress(done)


def _account(content: LiveContent, hits: int) -> Finished:
    return Finished(content.samples, hits, content.damaged, is_finished(content))
