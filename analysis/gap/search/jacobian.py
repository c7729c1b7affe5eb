# SPDX-License-Identifier: MIT
"""Slopes of a residual: those that the bench has, and differences for the others."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.response.threads import each
from jointbench.analysis.gap.search.search_settings import SEARCH


def _steps_of(problem: FitProblem, x: FloatArray) -> FloatArray:
    """Return the difference steps of x, directed inwards at a bound."""
    step = np.full(x.size, SEARCH.base_step)
    tail = slice(problem.n_base, None)
    step[tail] = SEARCH.effect_step * np.maximum(np.abs(x[tail]), 1e-2)
    return np.where(x + step > problem.upper, -step, step)


def jacobian_of(
    problem: FitProblem,
    x: FloatArray,
    residual: FloatArray,
    resolution: Resolution,
) -> SlopeArray:
    """Return the Jacobian of the residual by differences, shape (n_rows, n).

    Args:
        problem: least-squares problem.
        x: coordinates, shape (n,).
        residual: at x, shape (n_rows,).
        resolution: of the residual.
    """
    shared = x.size - problem.own
    columns, missing = _with_room(problem.base_slopes(x, resolution), x, residual)
    steps = _steps_of(problem, x)

    def difference(i: int) -> None:
        moved = x.copy()
        moved[i] += steps[i]
        change = problem.residual(moved, resolution)
        change -= residual
        change /= steps[i]
        columns[i] = change

    by_difference = missing[missing < shared]
    each(lambda k: difference(int(by_difference[k])), by_difference.size)
    if problem.own:
        moved = x.copy()
        moved[shared:] += steps[shared:]
        change = problem.residual(moved, resolution) - residual
        change = change.reshape(problem.own, -1) / steps[shared:, None]
        columns[shared:] = 0.0
        for i, rows in enumerate(change):
            columns[shared + i].reshape(problem.own, -1)[i] = rows
    return columns.T


def _with_room(
    known: SlopeArray | None, x: FloatArray, residual: FloatArray
) -> tuple[SlopeArray, IntArray]:
    """Return columns for all coordinates, and which of them are not known yet.

    Args:
        known: slopes by the first of them, or by all with NaN, shape (n_rows, n).
        x: coordinates, shape (n,).
        residual: at x, shape (n_rows,).
    """
    if known is None:
        return np.empty((x.size, residual.size)), np.arange(x.size)
    count = known.shape[1]
    if count == x.size:
        columns = known.T
        return columns, np.flatnonzero(np.isnan(columns.sum(axis=1)))
    columns = np.empty((x.size, residual.size), dtype=known.dtype)
    columns[:count] = known.T
    return columns, np.arange(count, x.size)
