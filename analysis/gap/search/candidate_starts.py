# SPDX-License-Identifier: MIT
"""Start values of a set of candidates, predicted by a directed test."""

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
    """One start of a set of candidates, and its fit so far."""

    problem: FitProblem
    x: FloatArray
    cost: float
    fit: Fit | None = None

    @property
    def label(self) -> str:
        """The candidates as text, sorted by label."""
        return words_of(self.problem.candidates)


def along(
    problem: FitProblem, fit: Fit, direction: Direction, resolution: Resolution
) -> CandidateFit:
    """Return the best start along the step that a directed test predicts.

    The step changes effect and base together; the prediction is inaccurate for large
    effects, so shorter steps are also evaluated.

    Args:
        problem: of the fit's effects and the tested one, in that order.
        fit: fit that was tested.
        direction: the directed test.
        resolution: at which the starts are compared.
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
    """Return a first fit of the candidate of a directed test.

    Args:
        bench: measurement and model.
        fit: fit that the candidate is added to.
        direction: the directed test.
    """
    problem = make_problem(bench, (*fit.candidates, direction.candidate))
    candidate_fit = along(problem, fit, direction, MIDDLE)
    return minimise(problem, candidate_fit.x, MIDDLE, iterations=MOST_STEPS)
