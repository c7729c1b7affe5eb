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
_FIRST_STEPS = 5
"""Steps from each of several starts, after which only the best two continue [-]."""
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
    return Found(*_best(sought, np.array(starts, dtype=np.float64), *bounds))


@compiled(error_model="numpy")
def _width(sought: Sought, at: FloatArray) -> float:
    """Return the width of the blur among parameters, 0 without one [samples]."""
    if sought.effect == FormEffect.BLUR or sought.effect == FormEffect.TIP:
        return float(at[3] if sought.noisy else at[2])
    return 0.0


@compiled(error_model="numpy")
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


@compiled(error_model="numpy")
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


@compiled(error_model="numpy")
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


@compiled(error_model="numpy")
def _solve(curvature: FloatArray, descent: FloatArray, damping: float) -> FloatArray:
    """Return the step of damped normal equations by their Cholesky root."""
    size = descent.size
    root, step = np.empty((size, size)), np.empty(size)
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
        step[i] = descent[i]
        for k in range(i):
            step[i] -= root[i, k] * step[k]
        step[i] /= root[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            step[i] -= root[k, i] * step[k]
        step[i] /= root[i, i]
    return step


@compiled(error_model="numpy")
def _normal_equations(
    jacobian: FloatArray,
    gap: FloatArray,
    norm: FloatArray,
    curvature: FloatArray,
    descent: FloatArray,
) -> None:
    """Fill in the normal equations, each parameter scaled by its column.

    By loops, as all here: expressions of arrays take ten times longer to compile.

    Args:
        jacobian: shape (n_residuals, n_parameters).
        gap: residuals, shape (n_residuals,).
        norm: of the columns, 0 of parameters that are held, shape (n_parameters,).
        curvature: filled; that of a held parameter is 1, shape (n_parameters,) * 2.
        descent: filled; that of a held parameter is 0, shape (n_parameters,).
    """
    for i in range(norm.size):
        descent[i] = 0.0
        for k in range(norm.size):
            curvature[i, k] = 1.0 if i == k else 0.0
        if norm[i] == 0:
            continue
        for j in range(gap.size):
            descent[i] -= jacobian[j, i] * gap[j] / norm[i]
        for k in range(i):
            if norm[k] == 0:
                continue
            total = 0.0
            for j in range(gap.size):
                total += jacobian[j, i] * jacobian[j, k]
            curvature[i, k] = total / (norm[i] * norm[k])


@compiled(error_model="numpy")
def _fill_norms(
    jacobian: FloatArray,
    gap: FloatArray,
    here: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    norm: FloatArray,
) -> None:
    """Fill in the norms of the columns, 0 of parameters at an active bound."""
    for i in range(here.size):
        slope, square = 0.0, 0.0
        for j in range(gap.size):
            slope += jacobian[j, i] * gap[j]
            square += jacobian[j, i] * jacobian[j, i]
        below = here[i] <= lower[i] and slope > 0
        above = here[i] >= upper[i] and slope < 0
        norm[i] = 0.0 if below or above else math.sqrt(square)


@compiled(error_model="numpy")
def _one(
    sought: Sought, start: FloatArray, lower: FloatArray, upper: FloatArray, most: int
) -> tuple[FloatArray, FloatArray, float]:
    """Return the local minimum next to a start, as far as some steps lead."""
    count = start.size
    here, there, norm = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        here[i] = min(max(start[i], lower[i]), upper[i])
    gap, trial = np.empty(sought.lag.size), np.empty(sought.lag.size)
    forms, jacobian = np.empty((2, gap.size)), np.empty((gap.size, count))
    curvature, descent = np.empty((count, count)), np.empty(count)
    _fill_forms(sought, here, forms)
    squares, damping = _residual(sought, here, forms, gap), _FIRST_DAMPING
    settled = False
    for taken in range(most + 1):
        _fill_jacobian(sought, here, gap, upper, jacobian)
        if settled or taken == most:
            break
        _fill_norms(jacobian, gap, here, lower, upper, norm)
        _normal_equations(jacobian, gap, norm, curvature, descent)
        best = squares
        for _ in range(_MOST_TRIALS):
            step = _solve(curvature, descent, damping)
            for i in range(count):
                moved = here[i] + (step[i] / norm[i] if norm[i] > 0 else 0.0)
                there[i] = min(max(moved, lower[i]), upper[i])
            _fill_forms(sought, there, forms)
            cost = _residual(sought, there, forms, trial)
            if cost < squares:
                here, there, squares = there, here, cost
                gap, trial = trial, gap
                damping *= _EASE
                break
            damping *= _TIGHTEN
        settled = best - squares <= _SETTLED * best
    return here, jacobian, squares


@compiled(error_model="numpy")
def _best(
    sought: Sought, starts: FloatArray, lower: FloatArray, upper: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return the best local minimum of all starts, the most promising two in full.

    The starts are overwritten by where they lead.
    """
    count = starts.shape[0]
    squares = np.empty(count)
    best = (starts[0], starts, np.inf)
    # One place that calls the search: each is compiled on its own.
    for k in range(count + 2 if count > 1 else 1):
        last, at = count == 1 or k >= count, k
        if k >= count:
            at = 0
            for i in range(1, count):
                at = i if squares[i] < squares[at] else at
        most = _MOST_STEPS if last else _FIRST_STEPS
        found = _one(sought, starts[at], lower, upper, most)
        squares[at] = np.inf if last else found[2]
        for i in range(starts.shape[1]):
            starts[at, i] = found[0][i]
        if last and not found[2] >= best[2]:
            best = found
    return best
