# SPDX-License-Identifier: MIT
"""Search for a band of lags with a power law where no model fits the whole range."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_above
from jointbench.signal.fractal.fit_judgement import judge
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.lag_weights import weigh
from jointbench.signal.fractal.model_choice import Choice, choose_straight, spans_decade
from jointbench.signal.fractal.self_affine import SeenSurface

ROUGHLY_STRAIGHT = 0.1
"""Largest departure of ln S from a line in a band [-]: a band selected among many must
also be straight."""
PRUNING_PROBABILITY = 1e-3
"""Least probability of a line through ln S in a band that is fitted [-]."""
EXPONENT_STEP = 0.1
"""Exponents at which the covariance of a band is calculated [-]: it varies slowly."""
FEWEST_LAGS = 6
"""Least lags of a band, for degrees of freedom with every model [-]."""


def find_band(problem: FractalProblem) -> Choice | None:
    """Return the widest straight band of a decade or more that shows a surface.

    Args:
        problem: the structure function at all lags of the fit, with the tolerance for
            the band.

    Returns:
        The accepted fit, or None where no decade is straight.
    """
    whole: dict[float, FloatArray] = {}
    log_lag, log_value = np.log(problem.lag), np.log(problem.estimate.value)
    for keep in _windows(problem):
        if _bent(log_lag[keep], log_value[keep]):
            continue
        part = problem.within(keep)
        line = part.straight()
        exponent = EXPONENT_STEP * round(line.exponent / EXPONENT_STEP)
        if exponent not in whole:
            whole[exponent] = problem.scatter(SeenSurface(exponent, 1.0))
        scatter = whole[exponent][np.ix_(keep, keep)]
        if _pruned(part, scatter):
            continue
        quick = choose_straight(part, weigh(part, line, scatter=scatter))
        if not (quick.accepted and judge(quick).scales):
            continue
        settled = choose_straight(part, weigh(part, quick.fit.seen))
        if settled.accepted and judge(settled).scales:
            return settled
    return None


def _bent(log_lag: FloatArray, value: FloatArray) -> bool:
    """Return whether ln S departs from the line through it by more than the limit."""
    place, rest = log_lag - log_lag.mean(), value - value.mean()
    rest -= float(place @ rest) / float(place @ place) * place
    return bool(np.abs(rest).max() > ROUGHLY_STRAIGHT)


def _pruned(problem: FractalProblem, scatter: FloatArray) -> bool:
    """Return whether ln S departs from a line by far more than its scatter."""
    covariance = scatter + problem.model_error(problem.straight())
    design = np.stack([np.ones(problem.lag.size), np.log(problem.lag)], axis=1)
    value = np.log(problem.estimate.value)
    weighted = np.linalg.solve(covariance, design)
    line = np.linalg.solve(design.T @ weighted, weighted.T @ value)
    gap = value - design @ line
    distance = float(gap @ np.linalg.solve(covariance, gap))
    return chi2_above(distance, problem.lag.size - 2) < PRUNING_PROBABILITY


def _windows(problem: FractalProblem) -> list[BoolArray]:
    """Return all runs of lags that span a decade, the widest first."""
    lag = problem.lag
    ends = [
        (first, last)
        for first in range(lag.size)
        for last in range(first + FEWEST_LAGS - 1, lag.size)
        if spans_decade((float(lag[first]), float(lag[last])))
    ]
    ends.sort(key=lambda pair: -float(lag[pair[1]] / lag[pair[0]]))
    index = np.arange(lag.size)
    return [(index >= first) & (index <= last) for first, last in ends]
