# SPDX-License-Identifier: MIT
"""Which modes of a fit the FRF needs.

A mode is needed where leaving it out raises chi-squared by more than noise and the
local residual can explain.
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    squared_size,
)
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.line_noise import local_residual
from jointbench.signal.modal.lsfd import fit_residues, pole_significance

# Probability that noise anywhere in the band passes for a mode; every line is one test
# (Bonferroni).
_CHANCE = 1e-6
# FRFs that are looked at first: where they need every mode, so do all.
_FIRST_FRFS = 12
# Distance over the half-power half-width below which one pole does for two. Repeated
# roots come as two candidates 1e-4 apart, either of which alone is hardly needed.
_ONE_PLACE = 0.5


def least_significance(lines: FrfLines) -> float:
    """Return the chi-squared above which a mode is needed [-]."""
    chance = _CHANCE / lines.laplace.size
    return chi2_limit(chance, 2 * lines.response.shape[0])


def needed(
    lines: FrfLines,
    pole: ComplexArray,
    held: BoolArray,
    noise: FloatArray,
    variance: FloatArray,
    beyond: ComplexArray,
    residual: ComplexArray | None = None,
) -> IntArray:
    """Drop the least needed pole until all that are left are needed.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n_modes,).
        held: poles that are always kept, shape (n_modes,).
        noise: noise variance of the lines, shape (n_frf, n_lines).
        variance: noise and model error, same shape.
        beyond: computational poles [rad/s].
        residual: of the fit with all of them, None if it is not known.

    Returns:
        Indices of the poles that are left.
    """
    left = np.arange(pole.size)
    limit = least_significance(lines)
    if _all_needed(lines, pole, noise, variance, beyond):
        return left
    while left.size:
        if residual is None:
            fit = fit_residues(lines, np.append(pole[left], beyond), variance)
            residual = lines.response - fit.synthesis
        found = significance(lines, residual, pole[left], noise, beyond)
        residual = None
        weak: BoolArray = (found < limit) & ~held[left]
        if not weak.any():
            break
        # Weak poles may replace each other: only the weakest is dropped, and those far
        # below the limit, of poles at one place again the weakest.
        weak &= found <= max(0.1 * limit, float(found[weak].min()))
        weak &= ~_replaced(pole[left], found, weak)
        left = left[~weak]
    return left


def _replaced(pole: ComplexArray, found: FloatArray, weak: BoolArray) -> BoolArray:
    """Return which poles stand in for a weaker one that is about to be dropped."""
    rank = np.argsort(np.argsort(found, kind="stable"))
    half, apart = np.abs(pole.real), np.abs(pole[:, None] - pole)
    near = apart < _ONE_PLACE * np.minimum(half[:, None], half)
    return np.asarray(np.any(near & weak & (rank < rank[:, None]), axis=1))


def _all_needed(
    lines: FrfLines,
    pole: ComplexArray,
    noise: FloatArray,
    variance: FloatArray,
    beyond: ComplexArray,
) -> bool:
    """Return whether a few FRFs need every pole; False where that is not known.

    The significance is a sum over FRFs of what is not negative, so that a part of them
    gives a lower bound.
    """
    if lines.response.shape[0] < 2 * _FIRST_FRFS or pole.size == 0:
        return False
    level = np.sum(squared_size(lines.response) / noise, axis=1)
    rows = np.argsort(-level)[:_FIRST_FRFS]
    few = replace(lines, response=lines.response[rows])
    fit = fit_residues(few, np.append(pole, beyond), variance[rows])
    found = significance(few, few.response - fit.synthesis, pole, noise[rows], beyond)
    return bool(np.all(found >= least_significance(lines)))


def significance(
    lines: FrfLines,
    residual: ComplexArray,
    pole: ComplexArray,
    noise: FloatArray,
    beyond: ComplexArray,
) -> FloatArray:
    """Judge each mode by the noise or by the local residual, whichever is larger.

    Args:
        lines: lines of the fit.
        residual: of a fit with all poles, shape (n_frf, n_lines).
        pole: modes [rad/s], shape (n_modes,).
        noise: noise variance of the lines, shape (n_frf, n_lines).
        beyond: computational poles [rad/s].

    Returns:
        Increase of chi-squared without each mode, shape (n_modes,).
    """
    local = local_residual(residual)
    everything = np.append(pole, beyond)
    judged = pole_significance(lines, everything, np.maximum(noise, local))
    apparent = np.nan_to_num(judged[: pole.size])
    return np.asarray(apparent / _window_gain(lines, pole))


def _window_gain(lines: FrfLines, pole: ComplexArray) -> FloatArray:
    """Return the noise at a mode over that on its lines, 1 or more.

    An exponential window exp(-a t) on a block T keeps the noise early in the block,
    where the mode is too: its power there is 2 a T / (1 - exp(-2 a T)) times the mean.
    Weighted with a decay exp(-(a + d) t), that is the factor below; 1 without a window.
    In terms of lines: the window correlates the errors of neighbours.
    """
    added = float(lines.laplace.real[0])
    if added <= 0.0:
        return np.ones(pole.size)
    exponent = 2.0 * added * 2.0 * np.pi / float(np.median(np.diff(lines.laplace.imag)))
    early = exponent / -np.expm1(-exponent)
    width = measured_width(lines, pole)
    return np.asarray(np.maximum(1.0, early * width / (width + added)))
