# SPDX-License-Identifier: MIT
"""An experiment with its bench time and what it is expected to give."""

from collections.abc import Sequence
from dataclasses import dataclass

from jointbench.analysis.design.expected_gain import ExpectedGain
from jointbench.analysis.gap.next_experiment.next_settings import NEXT


@dataclass(frozen=True, slots=True)
class RankedExperiment:
    """One candidate.

    Attributes:
        name: short, for tables.
        words: what to do, in one clause.
        minutes: bench time.
        expected: what it gives.
        index: of the candidate in its list.
    """

    name: str
    words: str
    minutes: float
    expected: ExpectedGain
    index: int

    @property
    def gain_per_hour(self) -> float:
        """Expected gain of probability per hour of bench time [1/h]."""
        return self.expected.gain / (self.minutes / 60.0)


def ranked(found: Sequence[RankedExperiment]) -> tuple[RankedExperiment, ...]:
    """Return experiments that are expected to decide, by gain per hour, then others.

    Args:
        found: in any order; those that rather do not decide follow by the share of
            decisions, because each costs another assembly.
    """

    def place(one: RankedExperiment) -> tuple[bool, float]:
        decides = one.expected.decided >= NEXT.decides
        return not decides, -(one.gain_per_hour if decides else one.expected.decided)

    return tuple(sorted(found, key=place))


def advice(found: Sequence[RankedExperiment]) -> str:
    """Return the recommended experiment as a sentence; empty without any.

    Args:
        found: ranked experiments.
    """
    if not found or found[0].expected.gain <= 0:
        return ""
    best = found[0]
    mean = sum(one.expected.decided for one in found) / len(found)
    return (
        f"{best.words} ({best.minutes:.0f} min): expected to decide in "
        f"{100 * best.expected.decided:.0f} % of cases, an experiment drawn at random "
        f"in {100 * mean:.0f} %"
    )
