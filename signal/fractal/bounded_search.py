# SPDX-License-Identifier: MIT
"""Fast least squares of a few bounded parameters."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray

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
    here = _within(start, lower, upper)
    gap = residual(here)
    squares, damping = float(gap @ gap), _FIRST_DAMPING
    for _ in range(_MOST_STEPS):
        jacobian = _jacobian(residual, here, gap, upper)
        normal = _normal_equations(jacobian, gap, here, lower, upper)
        best = squares
        for _ in range(_MOST_TRIALS):
            there = _within(here + _step(normal, damping), lower, upper)
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


@dataclass(frozen=True, slots=True, eq=False)
class _NormalEquations:
    """Normal equations of the free parameters, each scaled by its column.

    Attributes:
        free: parameters that are not at an active bound, shape (n_parameters,).
        size: norm of the columns of the free ones, shape (n_free,).
        curvature: shape (n_free, n_free).
        descent: minus the gradient, shape (n_free,).
    """

    free: BoolArray
    size: FloatArray
    curvature: FloatArray
    descent: FloatArray


def _normal_equations(
    jacobian: FloatArray,
    gap: FloatArray,
    here: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
) -> _NormalEquations:
    """Return what the steps of all dampings have in common."""
    slope = jacobian.T @ gap
    free = ~(((here <= lower) & (slope > 0)) | ((here >= upper) & (slope < 0)))
    norm = np.sqrt((jacobian * jacobian).sum(axis=0))
    free &= norm > 0
    size = norm[free]
    scaled = jacobian[:, free] / size
    return _NormalEquations(free, size, scaled.T @ scaled, -slope[free] / size)


def _step(normal: _NormalEquations, damping: float) -> FloatArray:
    """Return the damped step of the free parameters."""
    step = np.zeros(normal.free.size)
    if normal.size.size:
        curvature = normal.curvature.copy()
        curvature.flat[:: normal.size.size + 1] += damping
        step[normal.free] = np.linalg.solve(curvature, normal.descent) / normal.size
    return step


def _within(values: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Return values within their bounds; `numpy.clip` takes longer to be called."""
    within: FloatArray = np.minimum(np.maximum(values, lower), upper)
    return within
