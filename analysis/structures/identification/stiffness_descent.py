# SPDX-License-Identifier: MIT
"""Least-squares descent of an identification problem, from one start."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
    residuals,
    states_apart,
)

_MOST_STEPS = 100


def descend(
    problem: StiffnessProblem, start: FloatArray, fixed: Sequence[int] = ()
) -> Optimum:
    """Minimise from one start, with some unknowns fixed.

    Args:
        problem: of the identification.
        start: logarithms, shape (n_unknowns,).
        fixed: numbers of the fixed unknowns.

    Returns:
        The end of the descent.
    """
    parts = states_apart(problem)
    if len(parts) == 1:
        return _descend(problem, start, fixed)
    ends = []
    for part, own in parts:
        held = np.flatnonzero(np.isin(own, np.asarray(fixed, np.int64)))
        ends.append(_descend(part, start[own], held.tolist()))
    return joined(problem, ends)


def joined(problem: StiffnessProblem, ends: Sequence[Optimum]) -> Optimum:
    """Join the ends of all states."""
    unknowns = np.empty(problem.size)
    rows = sum(end.slopes.shape[0] for end in ends)
    slopes, begin = np.zeros((rows, problem.size)), 0
    for (_, own), end in zip(states_apart(problem), ends, strict=True):
        unknowns[own] = end.unknowns
        after = begin + end.slopes.shape[0]
        slopes[begin:after, own] = end.slopes
        begin = after
    return Optimum(unknowns, sum(end.chi2 for end in ends), slopes)


def _descend(
    problem: StiffnessProblem, start: FloatArray, fixed: Sequence[int]
) -> Optimum:
    free = np.setdiff1d(np.arange(problem.size), np.asarray(fixed, np.int64))
    base = np.clip(start, problem.low, problem.high)
    last: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def evaluate(part: FloatArray) -> tuple[FloatArray, FloatArray]:
        key = part.tobytes()
        if key not in last:
            last.clear()
            whole = base.copy()
            whole[free] = part
            last[key] = residuals(problem, whole)
        return last[key]

    def rows(part: FloatArray) -> FloatArray:
        return evaluate(part)[0]

    def slopes_of(part: FloatArray) -> FloatArray:
        return np.asarray(evaluate(part)[1][:, free])

    end = base.copy()
    if free.size:
        result = least_squares(
            rows,
            base[free],
            jac=slopes_of,
            bounds=(problem.low[free], problem.high[free]),
            x_scale="jac",
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-10,
            max_nfev=_MOST_STEPS,
        )
        end[free] = result.x
    left, slopes = residuals(problem, end)
    return Optimum(end, float(left @ left), slopes)


def with_value(unknowns: FloatArray, at: int, value: float) -> FloatArray:
    """Return unknowns with one value replaced."""
    moved = unknowns.copy()
    moved[at] = value
    return moved
