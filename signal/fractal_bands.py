# SPDX-License-Identifier: MIT
"""Looks for a band of lags that scales where no model fits the whole range."""

import numpy as np

from jointbench.acquisition.arrays import BoolArray
from jointbench.signal.fractal_choice import Choice, choose_straight, spans_decade
from jointbench.signal.fractal_judgement import judge
from jointbench.signal.fractal_problem import FractalProblem

ROUGHLY_STRAIGHT = 0.1
"""Largest departure of ln S from a line in a band that is worth a fit [-]: a true
power law's scatter stays below it at lags up to a tenth of the length but the last."""
FEWEST_LAGS = 6
"""Lags of a band that leave degrees of freedom for every model [-]."""


def find_band(problem: FractalProblem) -> Choice | None:
    """Return the widest straight band of a decade or more that shows a surface.

    Args:
        problem: the structure function at all lags of the fit, with the tolerance
            that is to hold in the band.

    Returns:
        The accepted fit, or None where no decade is straight.
    """
    for keep in _windows(problem):
        part = problem.within(keep)
        log_lag, log_value = np.log(part.lag), np.log(part.estimate.value)
        line = np.polyval(np.polyfit(log_lag, log_value, 1), log_lag)
        if np.max(np.abs(log_value - line)) > ROUGHLY_STRAIGHT:
            continue
        choice = choose_straight(part)
        if choice.accepted and judge(choice).scales:
            return choice
    return None


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
