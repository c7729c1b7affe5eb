# SPDX-License-Identifier: MIT
"""Fast least squares of the few bounded parameters of a seen surface, compiled."""

import math
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.signal.fractal.levelling_loss import fill_loss
from jointbench.signal.fractal.seen_forms import (
    LIMIT_RANGE,
    FormEffect,
    chebyshev,
    fill_form,
    rolled,
    rounded,
)

_MOST_STEPS = 40
"""Most steps of one search; fits of a surface take about 10 [-]."""
_FIRST_STEPS, _KEPT = 5, 2
"""Steps from each of many starts, after which only so many of the best continue [-]."""
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
_LEAST_PIVOT = 1e-14
"""Least pivot of scaled normal equations: no division by zero [-]."""


class Sought(NamedTuple):
    """What a search needs of a problem, its model and the weights.

    Parameters are s [-], ln S of the surface at the pivot, then, where the model has
    them, 2 noise / smallest S [-], width of the blur [samples] and ln corner.

    Attributes:
        lag: above 0 [samples], shape (n_lags,).
        value: measured S [m^2], same shape.
        reference: S to which residuals are relative [m^2], same shape.
        root: lower Cholesky root of the covariance of S over it, (n_lags, n_lags).
        limit: form of a sharp band limit over lag^s, as Chebyshev coefficients over
            `LIMIT_RANGE`, shape (n_coefficients, n_lags); empty for other models.
        log_pivot: ln of the lag of the level [samples].
        least: smallest S [m^2].
        points: of a profile [-].
        loss_share: loss by levelling over that by a mean line [-].
        quantum: height step [m].
        axes: directions in which the instrument acts.
        effect: an `FormEffect`.
        noisy: whether noise is a parameter.
        rolls_off: whether the corner is.
    """

    lag: FloatArray
    value: FloatArray
    reference: FloatArray
    root: FloatArray
    limit: FloatArray
    log_pivot: float
    least: float
    points: float
    loss_share: float
    quantum: float
    axes: int
    effect: int
    noisy: bool
    rolls_off: bool


class Found(NamedTuple):
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
    sought: Sought, starts: FloatArray, lower: FloatArray, upper: FloatArray
) -> Found:
    """Find the parameters within bounds with the least sum of squares.

    Args:
        sought: measured values, model and weights.
        starts: start values, shape (n_starts, n_parameters).
        lower: bounds, shape (n_parameters,).
        upper: bounds, shape (n_parameters,).

    Returns:
        The best of the local minima from all starts.

    Source:
        Levenberg-Marquardt with the damping relative to the curvature: Marquardt,
        SIAM J. Appl. Math. 11 (1963) 431. Parameters at an active bound are fixed.
    """
    bounds = np.ascontiguousarray(lower), np.ascontiguousarray(upper)
    return Found(*_best(sought, np.asarray(starts, dtype=np.float64), *bounds))


@compiled()
def _width(sought: Sought, at: FloatArray) -> float:
    """Return the width of the blur among parameters, 0 without one [samples]."""
    if sought.effect == FormEffect.BLUR or sought.effect == FormEffect.TIP:
        return float(at[3] if sought.noisy else at[2])
    return 0.0


@compiled()
def _fill_forms(sought: Sought, at: FloatArray, forms: FloatArray) -> None:
    """Fill in what depends on exponent and width alone.

    Args:
        sought: the problem and its model.
        at: parameters.
        forms: S of amplitude 1 and the loss by levelling, shape (2, n_lags), filled.
    """
    width = _width(sought, at)
    fill_form(sought.lag, at[0], width, sought.axes, sought.effect, forms[0])
    if sought.effect == FormEffect.LIMIT:
        low, high = LIMIT_RANGE
        here = (2 * at[0] - low - high) / (high - low)
        for i in range(sought.lag.size):
            forms[0, i] *= chebyshev(sought.limit, i, here)
    fill_loss(sought.lag / sought.points, at[0], forms[1])


@compiled()
def _residual(
    sought: Sought, at: FloatArray, forms: FloatArray, white: FloatArray
) -> float:
    """Fill in the whitened relative residuals; return their sum of squares."""
    exponent = at[0]
    noise = 0.5 * at[2] * sought.least if sought.noisy else 0.0
    amplitude = math.exp(at[1] - exponent * sought.log_pivot)
    ceiling, whole = 0.0, amplitude * sought.points**exponent
    if sought.rolls_off:
        ceiling = math.exp(at[at.size - 1] * exponent)
        whole *= (rolled(whole, amplitude * ceiling) / whole) ** 2
    total = 0.0
    for i in range(white.size):
        shape = forms[0, i]
        if sought.rolls_off:
            shape = rolled(shape, ceiling)
        seen = amplitude * shape + 2 * noise
        if sought.quantum > 0:
            seen = rounded(seen, sought.quantum)
        seen -= sought.loss_share * whole * forms[1, i]
        rest = (sought.value[i] - seen) / sought.reference[i]
        for j in range(i):
            rest -= sought.root[i, j] * white[j]
        white[i] = rest / sought.root[i, i]
        total += white[i] * white[i]
    return total


@compiled()
def _fill_jacobian(
    sought: Sought,
    at: FloatArray,
    gap: FloatArray,
    upper: FloatArray,
    jacobian: FloatArray,
) -> None:
    """Fill in the derivatives of the residuals by differences inside the bounds."""
    same, forms = np.empty((2, gap.size)), np.empty((2, gap.size))
    trial, moved, width = np.empty(gap.size), at.copy(), _width(sought, at)
    _fill_forms(sought, at, same)
    for i in range(at.size):
        step = _DIFFERENCE * max(1.0, abs(at[i]))
        if at[i] + step > upper[i]:
            step = -step
        moved[i] = at[i] + step
        if i == 0 or _width(sought, moved) != width:
            _fill_forms(sought, moved, forms)
            _residual(sought, moved, forms, trial)
        else:
            _residual(sought, moved, same, trial)
        moved[i] = at[i]
        for j in range(gap.size):
            jacobian[j, i] = (trial[j] - gap[j]) / step


@compiled()
def _solve(curvature: FloatArray, descent: FloatArray, damping: float) -> FloatArray:
    """Return the step of damped normal equations by their Cholesky root."""
    size = descent.size
    root, step = np.zeros((size, size)), descent.copy()
    for i in range(size):
        for j in range(i + 1):
            total = curvature[i, j]
            if i == j:
                total += damping
            for k in range(j):
                total -= root[i, k] * root[j, k]
            if i == j:
                root[i, i] = math.sqrt(max(total, _LEAST_PIVOT))
            else:
                root[i, j] = total / root[j, j]
    for i in range(size):
        for k in range(i):
            step[i] -= root[i, k] * step[k]
        step[i] /= root[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            step[i] -= root[k, i] * step[k]
        step[i] /= root[i, i]
    return step


@compiled()
def _scales(
    jacobian: FloatArray,
    gap: FloatArray,
    here: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the norms of the columns, 0 of parameters that are held, and slopes."""
    norm, slope = np.zeros(here.size), jacobian.T @ gap
    for i in range(here.size):
        below = here[i] <= lower[i] and slope[i] > 0
        above = here[i] >= upper[i] and slope[i] < 0
        if not (below or above):
            norm[i] = math.sqrt(np.sum(jacobian[:, i] ** 2))
    return norm, slope


@compiled()
def _one(
    sought: Sought, start: FloatArray, lower: FloatArray, upper: FloatArray, most: int
) -> tuple[FloatArray, FloatArray, float]:
    """Return the local minimum next to a start, as far as some steps lead."""
    here = np.minimum(np.maximum(start, lower), upper)
    gap, trial = np.empty(sought.lag.size), np.empty(sought.lag.size)
    forms, jacobian = np.empty((2, gap.size)), np.empty((gap.size, start.size))
    _fill_forms(sought, here, forms)
    squares, damping = _residual(sought, here, forms, gap), _FIRST_DAMPING
    for _ in range(most):
        _fill_jacobian(sought, here, gap, upper, jacobian)
        norm, slope = _scales(jacobian, gap, here, lower, upper)
        free = np.flatnonzero(norm > 0)
        # The normal equations of the free parameters, each scaled by its column.
        scaled = jacobian[:, free] / norm[free]
        curvature, descent = scaled.T @ scaled, -slope[free] / norm[free]
        best = squares
        for _ in range(_MOST_TRIALS):
            there = here.copy()
            there[free] += _solve(curvature, descent, damping) / norm[free]
            there = np.minimum(np.maximum(there, lower), upper)
            _fill_forms(sought, there, forms)
            cost = _residual(sought, there, forms, trial)
            if cost < squares:
                here, squares = there, cost
                gap[:] = trial
                damping *= _EASE
                break
            damping *= _TIGHTEN
        if best - squares <= _SETTLED * best:
            break
    _fill_jacobian(sought, here, gap, upper, jacobian)
    return here, jacobian, squares


@compiled()
def _best(
    sought: Sought, starts: FloatArray, lower: FloatArray, upper: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return the best local minimum of all starts that are promising."""
    begun, squares = starts.copy(), np.zeros(starts.shape[0])
    if squares.size > _KEPT:
        for k in range(squares.size):
            found = _one(sought, starts[k], lower, upper, _FIRST_STEPS)
            begun[k], squares[k] = found[0], found[2]
    order = np.argsort(squares)
    best = _one(sought, begun[order[0]], lower, upper, _MOST_STEPS)
    for k in order[1:_KEPT]:
        found = _one(sought, begun[k], lower, upper, _MOST_STEPS)
        if found[2] < best[2]:
            best = found
    return best
