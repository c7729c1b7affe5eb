# SPDX-License-Identifier: MIT
"""Recordings of sessions with their preloads and judged hits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, NoHitFound, UsageError
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.hits.find_hits import HitCriteria
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.station.pipeline.chain import hits_stage
from jointbench.station.pipeline.judge_again import StoredHits, with_hits
from jointbench.station.pipeline.stage_store import StageRun

ANY_LEVEL = HitCriteria(peak_fraction=0.01, limits=HitLimits(weak_ratio=0.0))
"""Levels span 30x on purpose: none is weak but what lies far below the softest of them,
and the trigger must reach that one."""


@dataclass(frozen=True, slots=True, eq=False)
class SessionHits:
    """What sessions of one bench hold for `gap`.

    Attributes:
        title: of the sessions, for the report.
        recordings: with judged hits, in order of time.
        remarks: what was left out, and why, a line each.
        simulated: whether a session was.
    """

    title: str
    recordings: list[Recording]
    remarks: tuple[str, ...]
    simulated: bool


def hits_of_sessions(paths: Sequence[Path], preload: float | None) -> SessionHits:
    """Read sessions, and judge their hits.

    Args:
        paths: of the sessions.
        preload: on the joint where they state none [N], or None.

    Raises:
        UsageError: a recording states another preload.
        BadData: a file cannot be used, or no recording holds a hit.
    """
    sessions = sorted(map(read_session, paths), key=lambda session: session.created)
    remarks: list[str] = []
    stored = [pair for session in sessions for pair in with_preloads(session, preload)]
    recordings = judged_recordings(stored, remarks)
    if not recordings:
        names = ", ".join(path.name for path in paths)
        raise BadData(f"no recording with a hit in {names}; see `jointbench inspect`")
    return SessionHits(
        ", ".join(path.stem for path in paths),
        recordings,
        tuple(remarks),
        any(session.simulated for session in sessions),
    )


def with_preloads(
    session: Session, preload: float | None
) -> list[tuple[Recording, float | None]]:
    """Return recordings in order of time, each with the preload it was made at [N].

    Args:
        session: as recorded.
        preload: of recordings and sessions that state none [N], or None.

    Raises:
        UsageError: a recording states another one.
    """
    of_session = session.joint.preload if session.joint is not None else None
    found = []
    for recording in sorted(session.recordings, key=lambda r: r.start_time):
        own = recording.preload if recording.preload is not None else of_session
        if own is not None and preload is not None and own != preload:
            raise UsageError(
                f"--preload is {preload:g} N, but recording {recording.name!r} was "
                f"made at {own:g} N; leave --preload out"
            )
        found.append((recording, own if own is not None else preload))
    return found


def judged_recordings(
    stored: Sequence[tuple[Recording, float | None]], remarks: list[str]
) -> list[Recording]:
    """Return the recordings that hold hits; their level is that of all sessions.

    Args:
        stored: recordings with their preloads.
        remarks: receives a line for each hit that was left out.

    Raises:
        BadData: a preload is not above zero.
    """
    recordings = [recording for recording, _ in stored]
    try:
        found = hits_stage(
            recordings, ANY_LEVEL, StoredHits(all_struck=False), StageRun()
        )
    except NoHitFound:
        return []
    remarks += [one.quiet for one in found if one.quiet]
    remarks += [
        f"recording {recording.name!r}: {hit.reason}"
        for recording, one in zip(recordings, found, strict=True)
        for hit in one.lowered
    ]
    # What was written of the session is not checked there: an impossible preload
    # must reach the one check that names it, not the record's own.
    return [
        _at_preload(with_hits(recording, one), preload)
        for (recording, preload), one in zip(stored, found, strict=True)
        if one.hits
    ]


def _at_preload(recording: Recording, preload: float | None) -> Recording:
    if preload is not None and not preload > 0:
        raise BadData(
            f"recording {recording.name!r} was made at a preload of {preload:g} N; it "
            "must be above zero: correct it where the session was made"
        )
    return replace(recording, preload=preload)
