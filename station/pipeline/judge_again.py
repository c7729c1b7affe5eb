# SPDX-License-Identifier: MIT
"""Hits of recordings found and judged, or kept as stored, and changed verdicts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import Hit, Recording, Verdict
from jointbench.signal.hits.campaign_level import compare_levels
from jointbench.signal.hits.find_hits import HitCriteria, find_hits
from jointbench.station.files.run_purposes import purpose_of
from jointbench.station.session_events.operator_events import PAUSE

NOT_THERE = "-"
"""In place of a verdict where there was no such hit."""
Hits = tuple[Hit, ...]


@dataclass(frozen=True, slots=True)
class StoredHits:
    """What becomes of the hits that recordings carry already.

    Attributes:
        again: they are found and judged again; False keeps them as they are.
        keep_operator: what the operator refused stays refused.
        all_struck: where no recording carries hits, every one must hold a hit.
    """

    again: bool = False
    keep_operator: bool = True
    all_struck: bool = True


@dataclass(frozen=True, slots=True)
class FoundHits:
    """The hits of a recording as judged now.

    Attributes:
        hits: none for a quiet stretch.
        steps: that found them; none where they were kept as stored.
        quiet: why there is none; empty where there are some.
        lowered: hits whose verdict changed when their level was compared with the
            campaign's, or the plan's.
    """

    hits: Hits
    steps: Provenance = ()
    quiet: str = ""
    lowered: Hits = ()


@dataclass(frozen=True, slots=True)
class VerdictChange:
    """A hit whose verdict is another than when it was recorded.

    Attributes:
        recording: its name.
        time: of the trigger since the session began [s].
        before: verdict as stored, ``-`` where this hit was not found then.
        after: verdict now, ``-`` where it is not found now.
        reason: of the verdict that counts now; as stored, where it is gone.
    """

    recording: str
    time: float
    before: str
    after: str
    reason: str


def judge_again(
    recordings: Sequence[Recording],
    criteria: HitCriteria,
    stored: StoredHits,
    each: Callable[[Recording], None] | None = None,
) -> tuple[FoundHits, ...]:
    """Find and judge the hits of recordings, or keep those that were found before.

    Where the hammer struck, and what the operator refused, is not in the samples: it
    is taken from the stored hit at the same place. A file of one hit has nothing to
    compare its level with: that is judged over all recordings, or by the plan.

    Args:
        recordings: as stored.
        criteria: of fresh hits.
        stored: what becomes of the hits that are there.
        each: is called with each recording as soon as its hits are found.

    Returns:
        The hits of each recording; none for a quiet stretch between others.

    Raises:
        NoHitFound: there is no hit in any recording, or in one that must hold some.
    """
    some = any(recording.hits for recording in recordings)
    found: list[FoundHits] = []
    first: NoHitFound | None = None
    for recording in recordings:
        try:
            found.append(_found(recording, criteria, stored))
            if each is not None:
                each(replace(recording, hits=found[-1].hits))
        except NoHitFound as error:
            if stored.all_struck and not some:
                raise
            first = first or error
            found.append(FoundHits((), quiet=str(error)))
    if first is not None and not any(one.hits for one in found):
        raise first
    return _level_compared(recordings, found, criteria, stored)


def with_hits(recording: Recording, found: FoundHits) -> Recording:
    """Return a recording with its hits as judged now, and how they were found."""
    steps = (*recording.provenance, *found.steps)
    return replace(recording, hits=found.hits, provenance=steps)


def _found(
    recording: Recording, criteria: HitCriteria, stored: StoredHits
) -> FoundHits:
    """Return the hits of one recording, their level not yet compared with others'."""
    if recording.hits and not stored.again:
        return FoundHits(recording.hits)
    if purpose_of(recording) == PAUSE:
        raise NoHitFound(f"recording {recording.name!r} is of a pause")
    fresh = find_hits(replace(recording, hits=()), criteria)
    hits = _with_memory(recording, fresh.hits, criteria, stored)
    return FoundHits(hits, fresh.provenance[len(recording.provenance) :])


def _level_compared(
    recordings: Sequence[Recording],
    found: Sequence[FoundHits],
    criteria: HitCriteria,
    stored: StoredHits,
) -> tuple[FoundHits, ...]:
    """Compare the level of fresh hits with the plan's, or that of all recordings."""
    judged = [replace(r, hits=f.hits) for r, f in zip(recordings, found, strict=True)]
    fresh = [stored.again or not recording.hits for recording in recordings]
    compared = compare_levels(judged, criteria.limits, fresh)
    return tuple(
        replace(one, hits=recording.hits, lowered=_lowered(one.hits, recording.hits))
        for one, recording in zip(found, compared, strict=True)
    )


def _lowered(before: Hits, after: Hits) -> Hits:
    pairs = zip(before, after, strict=True)
    return tuple(new for old, new in pairs if new.verdict is not old.verdict)


def _with_memory(
    recording: Recording, fresh: Hits, criteria: HitCriteria, stored: StoredHits
) -> Hits:
    """Give fresh hits the point, and the operator's veto, of the stored ones."""
    pairs = _match_hits(recording, fresh, criteria)
    return tuple(
        new if old is None else _remembering(new, old, keep=stored.keep_operator)
        for old, new in pairs
        if new is not None
    )


def _remembering(new: Hit, old: Hit, *, keep: bool) -> Hit:
    vetoed = keep and old.verdict is Verdict.OPERATOR
    if not vetoed:
        return replace(new, point=old.point)
    return replace(
        new,
        point=old.point,
        verdict=old.verdict,
        measure=old.measure,
        reason=old.reason,
    )


def _match_hits(
    recording: Recording, fresh: Hits, criteria: HitCriteria
) -> list[tuple[Hit | None, Hit | None]]:
    """Pair stored and fresh hits whose triggers lie within half the dead time.

    Args:
        recording: with the stored hits.
        fresh: found now.
        criteria: of the fresh ones.

    Returns:
        (stored, fresh) in order of time; None where one has no partner.
    """
    reach = 0.5 * criteria.dead_time * recording.sample_rate
    left = list(recording.hits)
    pairs: list[tuple[Hit | None, Hit | None]] = []
    for new in fresh:
        near = [old for old in left if abs(old.trigger - new.trigger) <= reach]
        old = min(near, key=lambda o: abs(o.trigger - new.trigger), default=None)
        if old is not None:
            left.remove(old)
        pairs.append((old, new))
    pairs += [(old, None) for old in left]
    return sorted(pairs, key=lambda pair: next(h.trigger for h in pair if h))


def verdict_changes(
    recordings: Sequence[Recording], judged: Sequence[Hits], criteria: HitCriteria
) -> tuple[VerdictChange, ...]:
    """List the hits whose verdict changed; none for recordings without stored hits."""
    return tuple(
        _change(recording, old, new)
        for recording, hits in zip(recordings, judged, strict=True)
        if recording.hits
        for old, new in _match_hits(recording, hits, criteria)
        if old is None or new is None or old.verdict is not new.verdict
    )


def _change(recording: Recording, old: Hit | None, new: Hit | None) -> VerdictChange:
    there = new or old
    assert there is not None
    return VerdictChange(
        recording=recording.name,
        time=recording.start_time + there.trigger / recording.sample_rate,
        before=NOT_THERE if old is None else old.verdict.value,
        after=NOT_THERE if new is None else new.verdict.value,
        reason=there.reason,
    )
