# SPDX-License-Identifier: MIT
"""The average of one condition while it grows: FRF, coherence, and who spoils it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData
from jointbench.acquisition.records import Channel, Hit, Recording, Verdict
from jointbench.signal.frf import Frf, estimate_frf
from jointbench.signal.hit_verdicts import HitLimits
from jointbench.signal.live_hits import CutHit

_ELSEWHERE = 0.5  # a slender point is struck more softly than the others
_ENOUGH = 3  # hits from which one of them can be told to spoil the others


@dataclass(frozen=True, slots=True, eq=False)
class Accepted:
    """A hit in an average.

    Attributes:
        cut: its samples.
        hit: as judged.
    """

    cut: CutHit
    hit: Hit


def average(
    accepted: Sequence[Accepted], channels: Sequence[Channel], sample_rate: float
) -> Frf | None:
    """Return the FRF of the hits of one condition, None where they give none."""
    if not accepted:
        return None
    shortest = min(each.cut.samples.shape[1] for each in accepted)
    hits = [
        replace(
            each.hit,
            start=i * shortest,
            trigger=i * shortest + each.cut.trigger,
            stop=(i + 1) * shortest,
            verdict=Verdict.OK,
        )
        for i, each in enumerate(accepted)
    ]
    joined = np.hstack([each.cut.samples[:, :shortest] for each in accepted])
    recording = Recording(
        "average", joined, sample_rate, tuple(channels), hits=tuple(hits)
    )
    try:
        return estimate_frf(recording)
    except BadData:
        return None


def mean_coherence(frf: Frf | None) -> float | None:
    """Return the coherence over the excited band, each output weighed alike [-].

    The dips at antiresonances, where there is nothing but noise, are left aside: the
    median over lines is taken of each output.
    """
    if frf is None or frf.coherence is None or frf.averages < 2:
        return None
    low, high = frf.usable_band or (frf.frequency[0], frf.frequency[-1])
    inside = (frf.frequency >= low) & (frf.frequency <= high)
    lines: FloatArray = frf.coherence[:, 0, inside]
    return float(np.median(lines, axis=1).mean()) if lines.size else None


@dataclass(frozen=True, slots=True)
class Spoiler:
    """The one hit of an average without which the others agree.

    Attributes:
        position: among the hits of the average.
        together: coherence with it [-].
        reason: one line.
    """

    position: int
    together: float
    reason: str


def find_spoiler(
    accepted: Sequence[Accepted],
    channels: Sequence[Channel],
    *,
    sample_rate: float,
    wanted: float,
) -> Spoiler | None:
    """Find the hit that takes the coherence of the others below what is wanted.

    Whether it was the first or the last of them does not matter: each is left out in
    turn.

    Args:
        accepted: hits of one condition.
        channels: of their rows.
        sample_rate: [Hz].
        wanted: coherence [-].

    Returns:
        The hit without which the coherence is highest, if that is what is wanted; None
        where all agree, or where no single one is to blame.
    """
    if len(accepted) < _ENOUGH:
        return None
    together = mean_coherence(average(accepted, channels, sample_rate))
    if together is None or together >= wanted:
        return None
    without = [
        mean_coherence(
            average([*accepted[:i], *accepted[i + 1 :]], channels, sample_rate)
        )
        or 0.0
        for i in range(len(accepted))
    ]
    position = int(np.argmax(without))
    if without[position] < wanted:
        return None
    return Spoiler(
        position,
        together,
        f"coherence {without[position]:.3f} without this hit, {together:.3f} with it "
        f"(limit {wanted:g}); it struck another place or direction",
    )


def weak_force(
    level: float | None, accepted: Sequence[Accepted], elsewhere: Sequence[float] = ()
) -> float | None:
    """Return the least useful peak [N]: a third of the level, or of the usual hit.

    Args:
        level: that was asked for [N], None for any.
        accepted: hits of the condition so far.
        elsewhere: peaks of trial hits and of hits at other conditions [N]. The first
            hit of a condition is compared with these, half as strictly: a slender part
            is struck more softly.
    """
    limits = HitLimits()
    if level is not None:
        return limits.weak_ratio * level
    peaks = [each.hit.peak_force for each in accepted]
    if not peaks and not elsewhere:
        return None
    if peaks:
        return limits.weak_ratio * float(np.median(peaks))
    return _ELSEWHERE * limits.weak_ratio * float(np.median(elsewhere))
