# SPDX-License-Identifier: MIT
"""Starts of a race: a candidate set, as far as a directed test foretells it."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE, Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.search.descent import (
    cost_at,
    minimise,
)
from jointbench.analysis.gap.search.screening import Direction
from jointbench.analysis.gap.search.search_settings import SEARCH

MOST_STEPS = SEARCH.middle_iterations
SHARES = SEARCH.start_shares


@dataclass(frozen=True, slots=True, eq=False)
class CandidateFit:
    """One start of one candidate set, as far as it has come."""

    problem: FitProblem
    x: FloatArray
    cost: float
    fit: Fit | None = None

    @property
    def label(self) -> str:
        """The candidates in words, in an order of their own."""
        return words_of(self.problem.candidates)


def along(
    problem: FitProblem, fit: Fit, direction: Direction, resolution: Resolution
) -> CandidateFit:
    """Return the best start on the way that a directed test foretells.

    The effect comes in and the base gives way together; what is far from small is
    not foretold well, so shorter ways are looked at too.

    Args:
        problem: of the fit's effects and the one tested, in that order.
        fit: that was tested.
        direction: the test.
        resolution: at which starts are compared.
    """
    full = np.concatenate([fit.x + direction.shift, direction.coordinates])
    trials = [np.concatenate([fit.x, direction.coordinates])]
    for share in SHARES:
        trial = full.copy()
        trial[: fit.x.size] = fit.x + share * direction.shift
        if not direction.candidate.effect.parameters[0].starts:
            trial[fit.x.size] *= share
        trials.append(trial)
    trials = [np.clip(x, problem.lower, problem.upper) for x in trials]
    costs = []
    for x in trials:
        costs.append(cost_at(problem, x, resolution))
    best = int(np.argmin(costs))
    return CandidateFit(problem, trials[best], costs[best])


def started(bench: Bench, fit: Fit, direction: Direction) -> Fit:
    """Return a first fit of what a directed test points to.

    Args:
        bench: measurement and model.
        fit: what the candidate is added to.
        direction: the test.
    """
    problem = make_problem(bench, (*fit.candidates, direction.candidate))
    candidate_fit = along(problem, fit, direction, MIDDLE)
    return minimise(problem, candidate_fit.x, MIDDLE, iterations=MOST_STEPS)
