# SPDX-License-Identifier: MIT
"""Profile likelihood: chi2 over one fixed parameter, with the others fitted."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.joint_result import LikelihoodProfile
from jointbench.analysis.structures.identification.parameter_intervals import LEVEL
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
)

# Steps away from the best value, in standard deviations.
_STEPS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
# Largest step in ln: a factor of about 4.5.
_LARGEST_STEP = 1.5


def profile_likelihood(
    problem: StiffnessProblem,
    best: Optimum,
    covariance: FloatArray,
    scale: float,
    wanted: bool = True,
) -> dict[str, LikelihoodProfile]:
    """Follow the likelihood of every parameter away from its best value.

    Args:
        problem: of the identification.
        best: solution.
        covariance: of the logarithms.
        scale: chi2 over degrees of freedom, at least 1.
        wanted: False skips the profiles, which cost about ten fits per parameter.

    Returns:
        Profiles by the names of the parameters. An interval is open where chi2 does
        not reach its limit within three standard deviations or the box.

    Source:
        Venzon and Moolgavkar 1988, J. R. Stat. Soc. C 37, 87-94.
    """
    found: dict[str, LikelihoodProfile] = {}
    if not wanted:
        return found
    for at, name in enumerate(problem.names):
        sd = min(float(np.sqrt(covariance[at, at])), _LARGEST_STEP / _STEPS[0])
        down = _walk(problem, best, at, -sd, scale)
        up = _walk(problem, best, at, sd, scale)
        points = [*reversed(down), (float(best.unknowns[at]), best.chi2), *up]
        value, chi2 = np.array(points).T
        limit = best.chi2 + LEVEL * scale
        found[name] = LikelihoodProfile(
            np.exp(value),
            chi2,
            _crossing(value[::-1], chi2[::-1], limit, float(best.unknowns[at]), -1),
            _crossing(value, chi2, limit, float(best.unknowns[at]), 1),
        )
    return found


def _walk(
    problem: StiffnessProblem, best: Optimum, at: int, sd: float, scale: float
) -> list[tuple[float, float]]:
    """Fix one parameter at increasing distance; start each fit at the last result."""
    points: list[tuple[float, float]] = []
    last = best.unknowns
    for step in _STEPS:
        target = float(best.unknowns[at]) + step * sd
        if not problem.low[at] < target < problem.high[at]:
            break
        start = last.copy()
        start[at] = target
        end = descend(problem, start, fixed=[at])
        points.append((target, end.chi2))
        last = end.unknowns
        if end.chi2 > best.chi2 + 1.5 * LEVEL * scale:
            break
    return points


def _crossing(
    value: FloatArray, chi2: FloatArray, limit: float, centre: float, sign: int
) -> float | None:
    """Return where chi2 first reaches the limit on one side, by interpolation."""
    outside = sign * (value - centre) >= 0
    value, chi2 = value[outside], chi2[outside]
    above = np.flatnonzero(chi2 >= limit)
    if not above.size or above[0] == 0:
        return None
    high, low = int(above[0]), int(above[0]) - 1
    # Chi2 is about a parabola: its root is about a straight line.
    base = chi2[0]
    ends = np.sqrt(np.maximum(chi2[[low, high]] - base, 0.0))
    share = (np.sqrt(limit - base) - ends[0]) / (ends[1] - ends[0])
    return float(np.exp(value[low] + share * (value[high] - value[low])))
