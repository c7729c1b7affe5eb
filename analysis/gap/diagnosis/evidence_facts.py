# SPDX-License-Identifier: MIT
"""Facts about a residual, derived once and used by all sentences of a report."""

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
    """Facts about a residual on which all sentences are based.

    Attributes:
        finding: the verdict. A cause is suggested only for `unknown`; named effects
            are the cause, and sentences then only describe observations.
        levels: recurrence at softer hits.
        seen: scaling of the residual with the hit, from that recurrence.
        scaling: the same as reported; `UNDETERMINED` if `seen` contradicts the named
            effects.
        uneven: channel with a far larger residual over response than another, or empty.
    """

    finding: Finding
    levels: tuple[Recurrence, ...]
    seen: LevelScaling
    scaling: LevelScaling
    uneven: str

    @property
    def guessed(self) -> bool:
        """Whether the cause is unknown, so that sentences suggest one."""
        return self.finding is Finding.UNKNOWN


def gather(
    bench: LumpedBench,
    base: Fit,
    outcome: SearchOutcome,
    finding: Finding,
    channels: Mapping[str, float],
) -> Facts:
    """Derive the facts about the residual of the base.

    Args:
        bench: measurement and noise.
        base: fit without effects on that bench.
        outcome: of the search on that bench.
        finding: the verdict on it.
        channels: residual over response of each channel [-].
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
    """Return the scaling of a residual that the effects of a fit would cause.

    A force law, and a fault that clips or adds a signal, is not proportional to the
    hit; all other effects are, except those that depend on the order of the hits.
    """
    entries = [action.entry for action in bench.actions(fit.terms)]
    if any(e.law is not None or e.shape is not None for e in entries):
        return LevelScaling.CHANGES
    if any(e.effect.follows_order for e in entries):
        return LevelScaling.UNDETERMINED
    return LevelScaling.PROPORTIONAL
