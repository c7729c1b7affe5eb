# SPDX-License-Identifier: MIT
"""Intervals of parameters, of one solution or of all admissible ones."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.solution_branches import (
    LARGEST_LOG_SD,
)
from jointbench.analysis.structures.identification.stiffness_descent import (
    descend,
    with_value,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
)

Interval = tuple[float | None, float | None]
"""Lower and upper end [SI]; None where it is open."""

# 95 % of a normal distribution, and of chi-squared of one degree of freedom.
_Z = 1.959963984540054
LEVEL = _Z**2
# Tolerance of an end in ln.
_RESOLUTION = 0.02


def local_interval(end: Optimum, at: int, scale: float) -> Interval:
    """Return the 95 % interval of one unknown around one solution, from its slopes.

    Args:
        end: solution.
        at: number of the unknown.
        scale: of the variances.
    """
    sd = float(np.sqrt(scale * end.covariance()[at, at]))
    if sd >= LARGEST_LOG_SD:
        return (None, None)
    centre = float(end.unknowns[at])
    return (float(np.exp(centre - _Z * sd)), float(np.exp(centre + _Z * sd)))


def admissible_interval(
    problem: StiffnessProblem, standing: Sequence[Optimum], at: int, scale: float
) -> Interval:
    """Return the union of the 95 % intervals of all admissible solutions.

    Args:
        problem: of the identification.
        standing: solutions, the best first.
        at: number of the unknown.
        scale: of the variances.

    Returns:
        The ends of the union [SI]; None where all values up to the bound of the search
        are admissible.
    """
    variance = [one.covariance()[at, at] for one in standing]
    sd = np.sqrt(scale * np.array(variance))
    value = np.array([one.unknowns[at] for one in standing])
    known = sd < LARGEST_LOG_SD
    ends: list[float | None] = []
    for sign, bound in ((-1.0, problem.low[at]), (1.0, problem.high[at])):
        reach = sign * (value + sign * _Z * np.where(known, sd, 0.0))
        furthest = float(reach.max())
        if not known.all():
            # Among the solutions that do not determine it, the outermost is followed.
            outer = np.where(known, -np.inf, sign * value)
            edge = _edge(problem, standing[int(np.argmax(outer))], at, bound, scale)
            furthest = max(furthest, np.inf if edge is None else sign * edge)
        inside = furthest < sign * float(bound)
        ends.append(float(np.exp(sign * furthest)) if inside else None)
    return (ends[0], ends[1])


def _edge(
    problem: StiffnessProblem, start: Optimum, at: int, bound: float, scale: float
) -> float | None:
    """Return the value of one unknown at which chi2 exceeds its limit.

    Returns:
        Logarithm; None if it does not before the bound.

    Source:
        Venzon and Moolgavkar 1988, J. R. Stat. Soc. C 37, 87-94 (profile likelihood).
    """
    level = start.chi2 + LEVEL * scale

    def fit(value: float, last: FloatArray) -> Optimum:
        return descend(problem, with_value(last, at, value), [at])

    if fit(float(bound), start.unknowns).chi2 <= level:
        return None
    last, inside, outside = start.unknowns, float(start.unknowns[at]), float(bound)
    while abs(outside - inside) > _RESOLUTION:
        middle = 0.5 * (inside + outside)
        end = fit(middle, last)
        if end.chi2 <= level:
            last, inside = end.unknowns, middle
        else:
            outside = middle
    return inside
