# SPDX-License-Identifier: MIT
"""Hits of a recorded session judged again, and which verdicts changed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jointbench.acquisition.errors import NoHitFound
from jointbench.acquisition.records import Hit, Recording, Verdict
from jointbench.signal.campaign_level import compare_levels
from jointbench.signal.hits import HitCriteria, find_hits
from jointbench.station.recipe import HitsPart
from jointbench.station.recipe_settings import hit_criteria

NOT_THERE = "-"
"""In place of a verdict where there was no such hit."""
Hits = tuple[Hit, ...]


@dataclass(frozen=True, slots=True)
class VerdictChange:
    """A hit whose verdict is another than when it was recorded.

    Attributes:
        recording: its name.
        time: of the trigger since the session began [s].
        before: verdict as stored, ``-`` where this hit was not found then.
        after: verdict now, ``-`` where it is not found now.
        reason: behind the verdict that counts now; as stored, where it is gone.
    """

    recording: str
    time: float
    before: str
    after: str
    reason: str


def judge_again(recordings: Sequence[Recording], part: HitsPart) -> tuple[Hits, ...]:
    """Find and judge the hits of recordings, whatever was found before.

    Where the hammer struck, and what the operator refused, is not in the samples: it
    is taken from the stored hit at the same place.

    Args:
        recordings: as stored.
        part: of the recipe.

    Returns:
        The hits of each recording; none for a quiet stretch between others.

    Raises:
        NoHitFound: there is no hit in any recording.
    """
    criteria = hit_criteria(part)
    found: list[Hits] = []
    first: NoHitFound | None = None
    for recording in recordings:
        if recording.hits and not part.again:
            found.append(recording.hits)
            continue
        try:
            fresh = find_hits(replace(recording, hits=()), criteria).hits
        except NoHitFound as error:
            first = first or error
            fresh = ()
        found.append(_with_memory(recording, fresh, part, criteria))
    if first is not None and not any(found):
        raise first
    return _level_compared(recordings, found, part, criteria)


def _level_compared(
    recordings: Sequence[Recording],
    found: Sequence[Hits],
    part: HitsPart,
    criteria: HitCriteria,
) -> tuple[Hits, ...]:
    """Compare the level of fresh hits with the plan's, or that of all recordings."""
    judged = [replace(r, hits=h) for r, h in zip(recordings, found, strict=True)]
    fresh = [part.again or not recording.hits for recording in recordings]
    compared = compare_levels(judged, criteria.limits, fresh)
    return tuple(recording.hits for recording in compared)


def _with_memory(
    recording: Recording, fresh: Hits, part: HitsPart, criteria: HitCriteria
) -> Hits:
    """Give fresh hits the point, and the operator's veto, of the stored ones."""
    pairs = match_hits(recording, fresh, criteria)
    return tuple(
        new if old is None else _remembering(new, old, keep=part.keep_operator)
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


def match_hits(
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
    recordings: Sequence[Recording], judged: Sequence[Hits], part: HitsPart
) -> tuple[VerdictChange, ...]:
    """List the hits whose verdict changed; none for recordings without stored hits."""
    criteria = hit_criteria(part)
    return tuple(
        _change(recording, old, new)
        for recording, hits in zip(recordings, judged, strict=True)
        if recording.hits
        for old, new in match_hits(recording, hits, criteria)
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
