# SPDX-License-Identifier: MIT
"""What is known of a misfit, decided once: all sentences of a page are made from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.level_evidence import (
    LevelScaling,
    Recurrence,
    levels_of,
    scaling_of,
)
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench

UNEVEN = DIAGNOSIS.uneven_ratio


@dataclass(frozen=True, slots=True, eq=False)
class Facts:
    """What every sentence about a misfit rests on.

    Attributes:
        finding: the verdict. A cause is guessed at where it is `unknown` only; where
            effects are named they are the cause, and sentences say what is seen.
        levels: recurrence at softer hits.
        seen: how the misfit goes with the hit, by that recurrence.
        scaling: the same as reported; `UNDETERMINED` if `seen` contradicts the named
            effects.
        uneven: channel whose misfit over response is far above another's, or empty.
    """

    finding: Finding
    levels: tuple[Recurrence, ...]
    seen: LevelScaling
    scaling: LevelScaling
    uneven: str

    @property
    def guessed(self) -> bool:
        """Whether the cause is open, so that what it may be is worth a word."""
        return self.finding is Finding.UNKNOWN


def gather(
    bench: LumpedBench,
    base: Fit,
    outcome: SearchOutcome,
    finding: Finding,
    channels: Mapping[str, float],
) -> Facts:
    """Decide what is known of the misfit of the base.

    Args:
        bench: measurement and noise.
        base: fit without effects on that bench.
        outcome: of the loop on that bench.
        finding: the verdict on it.
        channels: misfit over response of each channel [-].
    """
    shown: Sequence[Fit] = ()
    if finding in (Finding.NAMED, Finding.AMBIGUOUS):
        shown = outcome.level
    levels = levels_of(bench, base)
    seen = scaling_of(levels)
    expected = {scaling_by(bench, fit) for fit in shown} - {LevelScaling.UNDETERMINED}
    agree = not expected or seen in expected
    top = max(channels, key=lambda name: channels[name])
    uneven = channels[top] > UNEVEN * max(min(channels.values()), 1e-12)
    return Facts(
        finding=finding,
        levels=levels,
        seen=seen,
        scaling=seen if agree else LevelScaling.UNDETERMINED,
        uneven=top if uneven else "",
    )


def scaling_by(bench: LumpedBench, fit: Fit) -> LevelScaling:
    """Return how the misfit must go with the hit if the effects of a fit are its cause.

    A force law, and a fault that clips or adds, is not in proportion to the hit; all
    others are, but for those that go with the order of the hits.
    """
    entries = [action.entry for action in bench.actions(fit.terms)]
    if any(e.law is not None or e.shape is not None for e in entries):
        return LevelScaling.CHANGES
    if any(e.effect.follows_order for e in entries):
        return LevelScaling.UNDETERMINED
    return LevelScaling.PROPORTIONAL
