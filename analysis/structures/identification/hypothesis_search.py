# SPDX-License-Identifier: MIT
"""Searches of hypotheses about one state: each alone, then from the ends of others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.structures.identification.hypotheses import (
    HypothesisSettings,
    StructureHypothesis,
)
from jointbench.analysis.structures.identification.hypothesis_evidence import (
    WeighedEnd,
    weigh_end,
)
from jointbench.analysis.structures.identification.solution_branches import (
    exchanged_starts,
    same_branch,
)
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
    pose_problem,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.identification.surveyed_starts import (
    SurveyedStarts,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues

POOR_FIT = 1e-3
"""No hypothesis fits if the probability of a larger chi2 is below this."""
# Ends whose evidence is below the best one's by this in ln carry no weight.
_NO_WEIGHT = 12.0
# Most rounds in which directions of a joint are exchanged in the best solution ...
_EXCHANGES = 3
# ... as long as chi2 falls below this part of itself.
_BETTER = 0.9
# Most further rounds of searches, from the ends of so many leading hypotheses ...
_MORE_ROUNDS = 3
_LEADING = 3
# ... and from so many points around the own end, apart by this in ln: where two modes
# cross, chi2 of modes paired by order has an edge on which a descent stops.
_AROUND = 6
_AROUND_SD = 0.1

TriedHypothesis = tuple[StiffnessProblem, list[WeighedEnd]]
"""The problem of a hypothesis, and the distinct ends of its search."""


@dataclass(frozen=True, slots=True, eq=False)
class HypothesisSearch:
    """What the searches of all hypotheses about a state have in common.

    Attributes:
        known: values of the directions that are not sought.
        sought: names of the others; None for all.
        start: solution as measured by name, where each search begins as well.
        surveyed: points of the box with their frequencies.
        settings: how hypotheses are tried.
    """

    known: JointValues | None
    sought: Sequence[str] | None
    start: Mapping[str, float]
    surveyed: SurveyedStarts
    settings: HypothesisSettings

    def ends(self, one: StructureHypothesis) -> TriedHypothesis:
        """Search one hypothesis; its distinct ends with their evidence."""
        problem = posed(one, self.known, self.sought)
        return self._searched(one, problem, self._points(problem, one.evidence), [])

    def further(
        self, cases: Sequence[StructureHypothesis], tried: list[TriedHypothesis]
    ) -> list[TriedHypothesis]:
        """Search on as long as no hypothesis explains the measurement.

        That a search stopped short is a usual reason for it: each one begins again
        where the leading ones ended, and around its own end.
        """
        rng = np.random.default_rng(self.settings.seed)
        for _ in range(_MORE_ROUNDS):
            if cases[0].evidence.modes is None or any(map(_explained, tried)):
                break
            leading = _leading(cases, tried)
            tried = [
                self._searched(
                    case,
                    problem,
                    [_moved_to(problem, own, other) for other in leading]
                    + _around(_best(own), problem, rng),
                    [one.end for one in own],
                )
                for case, (problem, own) in zip(cases, tried, strict=True)
            ]
        return tried

    def _searched(
        self,
        one: StructureHypothesis,
        problem: StiffnessProblem,
        starts: Sequence[FloatArray],
        known: Sequence[Optimum],
    ) -> TriedHypothesis:
        """Descend from starts; the distinct ends, those known before among them."""
        ends = [*known, *(descend(problem, at) for at in starts)]
        for _ in range(_EXCHANGES if one.evidence.modes is not None else 0):
            last = min(ends, key=lambda end: end.chi2)
            ends += [descend(problem, at) for at in exchanged_starts(problem, last)]
            if min(end.chi2 for end in ends) > _BETTER * last.chi2:
                break
        distinct: list[WeighedEnd] = []
        for end in sorted(ends, key=lambda end: end.chi2):
            if not any(same_branch(end, other.end) for other in distinct):
                distinct.append(weigh_end(problem, end, self.settings.largest_noise))
        best = max(end.log_evidence for end in distinct)
        return problem, [e for e in distinct if e.log_evidence > best - _NO_WEIGHT]

    def _points(
        self, problem: StiffnessProblem, evidence: StructureEvidence
    ) -> list[FloatArray]:
        points = []
        if self.start:
            own = [self.start.get(name, 1.0) for name in problem.names]
            points.append(np.log(own))
        if evidence.modes is not None or not points:
            # FRFs need no pairing, which a search could miss, and are slow.
            points += self.surveyed.best(problem, evidence, self.settings.starts)
        return points


def _explained(tried: TriedHypothesis) -> bool:
    """Return whether a hypothesis explains the measurement at the stated noise."""
    return any(
        one.end.chi2 <= chi2_limit(POOR_FIT, one.end.slopes.shape[0])
        for one in tried[1]
    )


def _best(ends: Sequence[WeighedEnd]) -> Optimum:
    """Return the end that fits best."""
    return min((one.end for one in ends), key=lambda end: end.chi2)


def _leading(
    cases: Sequence[StructureHypothesis], tried: Sequence[TriedHypothesis]
) -> list[dict[str, float]]:
    """Return the best ends of the most probable hypotheses, by name."""
    found = sorted(
        zip(cases, tried, strict=True),
        key=lambda one: -max(log_weights(one[0], one[1][1])),
    )
    return [
        dict(zip(problem.names, _best(ends).unknowns, strict=True))
        for _, (problem, ends) in found[:_LEADING]
    ]


def _moved_to(
    problem: StiffnessProblem, own: Sequence[WeighedEnd], other: Mapping[str, float]
) -> FloatArray:
    """Return the end of another hypothesis in the unknowns of a problem."""
    start = dict(zip(problem.names, _best(own).unknowns, strict=True))
    return np.array([other.get(name, value) for name, value in start.items()])


def _around(
    end: Optimum, problem: StiffnessProblem, rng: np.random.Generator
) -> list[FloatArray]:
    away = _AROUND_SD * rng.standard_normal((_AROUND, problem.size))
    return list(np.clip(end.unknowns + away, problem.low, problem.high))


def posed(
    one: StructureHypothesis, known: JointValues | None, sought: Sequence[str] | None
) -> StiffnessProblem:
    """Return the problem of a hypothesis.

    Args:
        one: the hypothesis.
        known: values of the directions that are not sought.
        sought: names of the others; None for all.
    """
    return pose_problem(
        one.model,
        [one.evidence],
        known=_widened(known, len(one.model.names)),
        sought=sought,
        priors=one.priors,
    )


def _widened(known: JointValues | None, count: int) -> JointValues | None:
    """Add the factors that a hypothesis frees to known values."""
    if known is None or known.stiffness.size == count:
        return known
    more = count - known.stiffness.size
    return JointValues(
        np.concatenate([known.stiffness, np.ones(more)]),
        np.concatenate([known.damping, np.zeros(more)]),
    )


def log_weights(one: StructureHypothesis, ends: Sequence[WeighedEnd]) -> FloatArray:
    """Return ln of what the ends of a hypothesis weigh, shape (n_ends,)."""
    own = np.array([end.log_evidence for end in ends])
    return np.asarray(own + np.log(one.prior) + one.chance)
