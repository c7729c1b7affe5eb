# SPDX-License-Identifier: MIT
"""Fast least squares of a few bounded parameters."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_MOST_STEPS = 40
"""Most steps of one search; fits of a surface take about 10 [-]."""
_MOST_TRIALS = 12
"""Trial dampings of one step [-]."""
_SETTLED = 1e-7
"""Relative change of the sum of squares that ends a search [-]."""
_DIFFERENCE = 1e-6
"""Step of the numerical derivatives of parameters of order one [-]."""
_FIRST_DAMPING = 1e-3
"""Damping of the first step over the curvature [-]."""
_EASE, _TIGHTEN = 0.2, 5.0
"""Factors on the damping after an accepted and after a rejected step [-]."""

_Residual = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """Result of a search.

    Attributes:
        parameters: shape (n_parameters,).
        jacobian: of the residuals there, shape (n_residuals, n_parameters).
        squares: sum of squares of the residuals.
    """

    parameters: FloatArray
    jacobian: FloatArray
    squares: float


def search(
    residual: _Residual, start: FloatArray, lower: FloatArray, upper: FloatArray
) -> Found:
    """Find the parameters within bounds with the least sum of squares.

    Args:
        residual: residuals for parameters, whitened.
        start: start values, shape (n,).
        lower: bounds, shape (n,).
        upper: bounds, shape (n,).

    Returns:
        The end of the search, a local minimum.

    Source:
        Levenberg-Marquardt with the damping relative to the curvature: Marquardt,
        SIAM J. Appl. Math. 11 (1963) 431. Parameters at an active bound are fixed.
    """
    here = np.clip(start, lower, upper)
    gap = residual(here)
    squares, damping = float(gap @ gap), _FIRST_DAMPING
    for _ in range(_MOST_STEPS):
        jacobian = _jacobian(residual, here, gap, upper)
        best = squares
        for _ in range(_MOST_TRIALS):
            there = np.clip(
                here + _step(jacobian, gap, damping, here, lower, upper), lower, upper
            )
            trial = residual(there)
            cost = float(trial @ trial)
            if cost < squares:
                here, gap, squares = there, trial, cost
                damping *= _EASE
                break
            damping *= _TIGHTEN
        if best - squares <= _SETTLED * best:
            break
    return Found(here, _jacobian(residual, here, gap, upper), squares)


def _jacobian(
    residual: _Residual, at: FloatArray, gap: FloatArray, upper: FloatArray
) -> FloatArray:
    """Return the derivatives of the residuals by differences inside the bounds."""
    columns = np.empty((gap.size, at.size))
    for i in range(at.size):
        step = _DIFFERENCE * max(1.0, abs(float(at[i])))
        step = -step if at[i] + step > upper[i] else step
        moved = at.copy()
        moved[i] += step
        columns[:, i] = (residual(moved) - gap) / step
    return columns


def _step(
    jacobian: FloatArray,
    gap: FloatArray,
    damping: float,
    here: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
) -> FloatArray:
    """Return the damped step of the free parameters."""
    slope = jacobian.T @ gap
    free = ~(((here <= lower) & (slope > 0)) | ((here >= upper) & (slope < 0)))
    size = np.linalg.norm(jacobian, axis=0)
    free &= size > 0
    step = np.zeros(here.size)
    if free.any():
        scaled = jacobian[:, free] / size[free]
        curvature = scaled.T @ scaled + damping * np.eye(int(free.sum()))
        step[free] = np.linalg.solve(curvature, -slope[free] / size[free]) / size[free]
    return step
