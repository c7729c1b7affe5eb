# SPDX-License-Identifier: MIT
"""Recording of runs as `measure` records: each block is on disk before the next.

A chassis is read by a recording process, an own source of a program where it is.

Hits are judged when the file is finished or recovered; its header records this.
"""

import uuid
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from jointbench.acquisition.basics.errors import (
    InstrumentError,
    JointbenchError,
    NoHitFound,
)
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session, software_version
from jointbench.acquisition.records.source import Run
from jointbench.acquisition.session_file.live_write import LiveSession, channel_rows
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.signal.hits.campaign_level import compare_levels
from jointbench.signal.hits.find_hits import HitCriteria, find_hits
from jointbench.station.screen.interrupt import patient_interrupt
from jointbench.station.sources.open_source import RunSequence
from jointbench.station.sources.record_served import (
    Progress,
    ServedRun,
    record_served,
    require_same,
    run_entry,
)

BLOCK = 0.1
"""Usual length of a block [s]."""
HITS_LATER = {"hits": "later"}
"""What the head of a recording says whose hits are judged at its end."""


def record_live(sequence: RunSequence, path: Path) -> bool:
    """Record all runs into a file, and finish it in any case.

    Args:
        sequence: an opened source.
        path: of a file that is not there yet.

    Returns:
        Whether it came to its end; the file is finished in either case.

    Raises:
        InstrumentError: a run delivered nothing, or has other channels than the first;
            the file holds what was recorded until then.
        UsageError: the file cannot be written.
    """
    progress = Progress()
    with patient_interrupt(progress):
        try:
            _record_runs(sequence, path, progress)
        except BaseException:
            # What went wrong first is what the operator has to know.
            with suppress(JointbenchError):
                if path.exists() and not is_held(path):
                    finish_recording(path)
            raise
        finish_recording(path)
    return not progress.interrupted


def finish_recording(path: Path) -> None:
    """Judge the hits of a recording and turn its file into a finished session.

    Raises:
        UsageError: there is no room for it; the recording is safe as it is.
    """
    write_session(with_hits(read_session(path)), path, overwrite=True)


def with_hits(session: Session, criteria: HitCriteria | None = None) -> Session:
    """Return a session with the hits of its recordings found and judged.

    Args:
        session: as recorded.
        criteria: how hits are found and judged; None for the defaults.

    Returns:
        The session; a recording without hits is left out.
    """
    judged = [_judged(recording, criteria) for recording in session.recordings]
    limits = (criteria or HitCriteria()).limits
    return replace(session, recordings=compare_levels(judged, limits))


def _judged(recording: Recording, criteria: HitCriteria | None) -> Recording:
    try:
        return find_hits(recording, criteria)
    except NoHitFound:
        return recording


def _record_runs(sequence: RunSequence, path: Path, progress: Progress) -> None:
    if all(isinstance(run, ServedRun) for run in sequence.runs):
        record_served(sequence, path, _meta(sequence), progress)
        return
    first = sequence.runs[0]
    block = max(1, round(BLOCK * first.sample_rate))
    channels = len(first.channels)
    with LiveSession(path, _meta(sequence), channels=channels, block=block) as live:
        try:
            for segment, run in enumerate(sequence.runs):
                require_same(first, run)
                _record_run(run, segment, live, progress)
                if progress.interrupted:
                    break
        except KeyboardInterrupt:
            progress.interrupted = True
        finally:
            live.log({"kind": "end", "interrupted": progress.interrupted})


def _record_run(run: Run, segment: int, live: LiveSession, progress: Progress) -> None:
    live.log(run_entry(run))
    count = 0
    for samples in run.blocks():
        live.append(samples, segment=segment, first=count)
        count += samples.shape[1]
        if progress.interrupted:
            return
    if not count:
        raise InstrumentError(f"source {run.name!r} delivered no sample; check it")


def _meta(sequence: RunSequence) -> dict[str, object]:
    first = sequence.runs[0]
    return {
        "uuid": str(uuid.uuid4()),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "software": software_version(),
        "source": sequence.source,
        "simulated": sequence.simulated,
        "sample_rate": first.sample_rate,
        "channels": channel_rows(first.channels),
        **HITS_LATER,
    }
