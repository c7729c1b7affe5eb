# SPDX-License-Identifier: MIT
"""The joint fit: curves, shapes and every hit's start, to the lines of all hits.

Penalised least squares by damped Gauss-Newton steps. Real and imaginary parts of the
whitened lines have variance 1, so that the inverse of the normal matrix is the
covariance.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.band_lines import BandLines
from jointbench.signal.amplitude.linearised import LinearBand, linearised
from jointbench.signal.amplitude.mode_state import JointFit, ModeState, moved
from jointbench.signal.amplitude.smoothness import (
    inverse,
    largest_change,
    penalty,
    penalty_cost,
    reweighted,
    scales,
)

_STEPS = 25
# A step that gains less than this of chi-squared ends the fit.
_GAIN, _ENOUGH = 0.02, 1e-7
# Above this residual ratio it may be this share of chi-squared.
_POOR, _ROUGH = 3.0, 2e-3
# Smoothness has settled: largest change of ln weight.
_SETTLED = 0.3
# Smoothness is left alone while a step still gains more than this share.
_FAR = 0.05
_DAMPING, _MOST_DAMPING = 1e-6, 1e2


def fit_jointly(
    lines: BandLines,
    modes: Sequence[ModeState],
    power: int,
    *,
    steps: int = _STEPS,
    enough: float = _ENOUGH,
) -> JointFit:
    """Fit all modes of a band to all hits.

    Args:
        lines: of the band.
        modes: where to start.
        power: derivatives of the response.
        steps: most steps tried; 0 only linearises.
        enough: a step that gains less than this share of chi-squared is the last.

    Raises:
        LinAlgError: the start gives no finite signal, or the fit is singular.
    """
    state, damping = tuple(modes), _DAMPING
    now = linearised(lines, state, power)
    if not np.isfinite(now.chi2):
        raise np.linalg.LinAlgError("the fit cannot start: its signals overflow")
    for _ in range(steps):
        matrix, prior_gradient = penalty(state, now.gradient.size)
        cost = now.chi2 + penalty_cost(state)
        new, ahead, damping = _step(
            lines, state, power, now, (matrix, prior_gradient, cost), damping
        )
        if ahead is None:
            break
        gained = cost - ahead.chi2 - penalty_cost(new)
        noise = max(1.0, ahead.chi2 / max(2.0 * ahead.residual.size, 1.0))
        near = gained < _FAR * cost
        changed = reweighted(new, ahead.normal, noise) if near else new
        change = largest_change(new, changed)
        state, now = changed, ahead
        # Where the model does not hold, the last digits of its fit mean nothing.
        poor = now.chi2 > _POOR**2 * lines.freedom
        share = max(enough, _ROUGH) if poor else enough
        if near and gained < _GAIN + share * cost and (change < _SETTLED or poor):
            break
    return _finished(lines, state, now)


def _step(
    lines: BandLines,
    state: tuple[ModeState, ...],
    power: int,
    now: LinearBand,
    prior: tuple[FloatArray, FloatArray, float],
    damping: float,
) -> tuple[tuple[ModeState, ...], LinearBand | None, float]:
    """Try steps with more and more damping until one gains."""
    matrix = now.normal + prior[0]
    _, prior_gradient, cost = prior
    while damping < _MOST_DAMPING:
        damped = matrix + damping * np.diag(np.diag(now.normal) + 1e-12)
        step = _solve(damped, now.gradient - prior_gradient)
        new = moved(state, step)
        if new is not None:
            ahead = linearised(lines, new, power)
            # Not a number is no gain.
            if ahead.chi2 + penalty_cost(new) <= cost:
                return new, ahead, max(0.1 * damping, 1e-9)
        damping = max(10.0 * damping, 1e-4)
    return state, None, damping


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a scaled positive system; directions without information stay."""
    scale = scales(matrix)
    scaled = matrix * scale[:, None] * scale
    scaled[np.diag_indices_from(scaled)] += 1e-12
    try:
        factor = scipy.linalg.cho_factor(scaled)
        return np.asarray(scale * scipy.linalg.cho_solve(factor, scale * right))
    except np.linalg.LinAlgError:
        solved = np.linalg.lstsq(scaled, scale * right, rcond=1e-12)[0]
        return np.asarray(scale * solved)


def _finished(
    lines: BandLines, modes: tuple[ModeState, ...], now: LinearBand
) -> JointFit:
    covariance = inverse(now.normal + penalty(modes, now.gradient.size)[0])
    used = float(np.sum(covariance * now.normal))
    return JointFit(
        modes=modes,
        residual=now.residual,
        normal=now.normal,
        gradient=now.gradient,
        covariance=covariance,
        chi2=now.chi2,
        freedom=lines.freedom - used,
    )
