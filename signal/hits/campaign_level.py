# SPDX-License-Identifier: MIT
"""Detect glancing hits by the level of the whole campaign or of its plan.

`hit_verdicts` compares a hit with the others of its own recording. A file of one hit
has no others, so here the hits of all recordings are compared. A campaign may use
several levels on purpose: a hit is compared with the lowest level that was struck
repeatedly, not with the median of all hits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Hit, Recording, Verdict
from jointbench.signal.hits.hit_verdicts import HitLimits

_SAME_LEVEL = 2.0
"""Largest ratio between two peaks of one level [-]; an operator scatters by 10 to 30 %.
"""
_LEAST_REPEATS = 2
_LEAST_SHARE = 0.1
"""Least share of the hits for a level [-]; glancing hits are rarer."""
_MANY_REPEATS, _MANY_SHARE = 3, 0.2
"""The same for a level more than one ladder step below the next one."""
_OWN_HITS = 3
"""Hits at one level from which a recording is its own reference."""
_COMPARED = (Verdict.OK, Verdict.WEAK)


@dataclass(frozen=True, slots=True)
class Softest:
    """The lowest level of a campaign.

    Attributes:
        level: median peak of its hits [N].
        several: whether the campaign has higher levels too, so that a lower peak may be
            intended.
    """

    level: float
    several: bool


def compare_levels(
    recordings: Sequence[Recording],
    limits: HitLimits,
    fresh: Sequence[bool] | None = None,
) -> tuple[Recording, ...]:
    """Mark hits as weak that are far below the campaign's level or the plan's.

    Args:
        recordings: all of the campaign, with judged hits.
        limits: `weak_ratio` applies to a campaign of one level and to the level of a
            plan, `ladder_ratio` to a campaign of several.
        fresh: True for recordings whose verdicts may change; None for all.

    Returns:
        The recordings, with the verdict of accepted hits changed to `Verdict.WEAK`
        where their peak force is too low. Hits that form a level within their own
        recording have been compared there.
    """
    may = [True] * len(recordings) if fresh is None else list(fresh)
    peaks = np.array(
        [h.peak_force for r in recordings for h in r.hits if h.verdict in _COMPARED]
    )
    return tuple(
        _compared(recording, peaks, limits) if own else recording
        for recording, own in zip(recordings, may, strict=True)
    )


def softest_level(peaks: FloatArray, ladder_ratio: float) -> Softest | None:
    """Return the lowest level that was struck repeatedly.

    Args:
        peaks: of all hits of a campaign [N], shape (n,).
        ladder_ratio: hits further below the next level than this count as a level only
            if they are many [-].

    Returns:
        None where no two hits share a level.
    """
    ordered = np.sort(peaks)
    total, first = ordered.size, 0
    found = _first_level(ordered, first, total)
    while found is not None:
        first, past = found
        level = float(np.median(ordered[first:past]))
        following = _first_level(ordered, past, total)
        many = past - first >= max(_MANY_REPEATS, ceil(_MANY_SHARE * total))
        near = following is None or level >= ladder_ratio * ordered[following[0]]
        if many or near:
            above = np.count_nonzero(ordered > _SAME_LEVEL * level)
            return Softest(level, bool(above >= max(1, ceil(_LEAST_SHARE * total))))
        found = following
    return None


def _first_level(ordered: FloatArray, begin: int, total: int) -> tuple[int, int] | None:
    """Return (first, past) of the softest shared level from an index on, or None."""
    needed = max(_LEAST_REPEATS, ceil(_LEAST_SHARE * total))
    past = np.searchsorted(ordered, _SAME_LEVEL * ordered, side="right")
    enough = np.flatnonzero(past[begin:] - np.arange(begin, ordered.size) >= needed)
    if enough.size == 0:
        return None
    first = begin + int(enough[0])
    return first, int(past[first])


def planned_level(recording: Recording) -> float | None:
    """Return the planned peak force [N], or None if none is stored."""
    levels = [dict(s.detail).get("level") for s in recording.provenance]
    stored = [x for x in levels if isinstance(x, int | float) and x > 0]
    return float(stored[-1]) if stored else None


def _compared(recording: Recording, peaks: FloatArray, limits: HitLimits) -> Recording:
    planned = planned_level(recording)
    if planned is None and _own_level(recording):
        return recording
    hits = tuple(_judged(hit, planned, peaks, limits) for hit in recording.hits)
    return recording if hits == recording.hits else replace(recording, hits=hits)


def _own_level(recording: Recording) -> bool:
    own = np.array([h.peak_force for h in recording.hits if h.verdict in _COMPARED])
    if own.size < _OWN_HITS:
        return False
    usual = float(np.median(own))
    same = (own < _SAME_LEVEL * usual) & (own > usual / _SAME_LEVEL)
    return bool(np.count_nonzero(same) >= _OWN_HITS)


def _judged(
    hit: Hit, planned: float | None, peaks: FloatArray, limits: HitLimits
) -> Hit:
    if hit.verdict is not Verdict.OK:
        return hit
    level, limit, words = _reference(hit.peak_force, planned, peaks, limits)
    ratio = hit.peak_force / level
    if ratio >= limit:
        return hit
    reason = (
        f"peak force {hit.peak_force:.4g} N is {100 * ratio:.2g} % of {words}, "
        f"{level:.4g} N (limit {100 * limit:.0f} %): a glancing hit"
    )
    return replace(hit, verdict=Verdict.WEAK, measure=ratio, reason=reason)


def _reference(
    peak: float, planned: float | None, peaks: FloatArray, limits: HitLimits
) -> tuple[float, float, str]:
    """Return the reference of a peak [N], the limit [-], and its name."""
    single = max(limits.weak_ratio, limits.ladder_ratio)
    if planned is not None:
        return planned, single, "the planned level"
    softest = softest_level(peaks, limits.ladder_ratio)
    if softest is None:
        harder = peaks[peaks > peak]
        following = float(harder.min()) if harder.size else peak
        return following, limits.ladder_ratio, "the next harder hit"
    if softest.several:
        return softest.level, limits.ladder_ratio, "the campaign's lowest level"
    return softest.level, single, "the campaign's level"
