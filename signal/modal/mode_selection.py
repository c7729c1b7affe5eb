# SPDX-License-Identifier: MIT
"""Selection of modes among candidate poles by the chi-squared of the FRF.

A pole that is stable over orders may still describe noise, or the residual of a
stronger mode. So a candidate is kept only if leaving it out raises chi-squared by more
than noise and the local residual can explain.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.signal.modal.computational_modes import find_beyond
from jointbench.signal.modal.fit_residuals import residual_around
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.line_noise import (
    line_noise,
    local_level,
    local_residual,
    model_error,
)
from jointbench.signal.modal.lscf import Progress
from jointbench.signal.modal.lsfd import LinearFit, fit_residues
from jointbench.signal.modal.refined_pole_covariance import (
    RefinedPoles,
    refine_poles,
    unresolved,
)

# Relative model error assumed before a fit has estimated it [-].
_FIRST_MODEL_ERROR = 0.02
# Probability that noise anywhere in the band passes for a mode; every line is one test
# (Bonferroni).
_CHANCE = 1e-6
# A mode whose damping has a relative sd above this is dropped.
_VAGUE = 1.0 / 3.0
_STEPS = 30


@dataclass(frozen=True, slots=True, eq=False)
class FittedModes:
    """Accepted modes with the results of their fit.

    Attributes:
        chosen: indices of the accepted candidates, shape (n_modes,).
        poles: refined, with covariance and inflation.
        fit: residues on the same lines.
        variance: noise and model error of each line, shape (n_frf, n_lines).
        significance: increase of chi-squared without each mode, over the local
            residual, shape (n_modes,).
        model_error: of the fit, as a share of the local level [-].
        residual_ratio: around each mode, rms residual over noise [-], shape (n_modes,).
    """

    chosen: IntArray
    poles: RefinedPoles
    fit: LinearFit
    variance: FloatArray
    significance: FloatArray
    model_error: float
    residual_ratio: FloatArray


def fit_modes(
    lines: FrfLines,
    candidates: ComplexArray,
    scatter: FloatArray | None,
    *,
    held: BoolArray | None = None,
    refine: bool = True,
    progress: Progress | None = None,
) -> FittedModes:
    """Refine candidate poles and keep those that the FRF needs.

    The weights are calculated twice: the first fit assumes a model error of 2 % of the
        local level in addition to the noise, the second uses the error found by the
        first.

    Args:
        lines: lines of the fit.
        candidates: poles [rad/s], shape (n_candidates,).
        scatter: variance of the FRF from its hits, shape (n_frf, n_lines), or None.
        held: True for candidates that are always kept, shape (n_candidates,), or None.
        refine: False keeps the poles of LSCF.
        progress: called with the current step and its share; None for no reports.

    Returns:
        The modes, possibly none.
    """
    noise, level = line_noise(lines.response, scatter), local_level(lines.response)
    variance = noise + _FIRST_MODEL_ERROR**2 * level
    steps = _STEPS if refine else 0
    held = np.zeros(candidates.size, bool) if held is None else held
    report = progress or _silent
    report("refining modes", 0.0)
    chosen, poles = _first_fit(lines, candidates, held, noise, variance, steps)
    report("refining modes", 0.4)
    # The response itself is rough at resonances; the residual of a fit is not.
    noise = line_noise(lines.response, scatter, poles.residual)
    beyond = poles.beyond
    if refine:
        beyond = find_beyond(lines, poles.pole, beyond, poles.residual, noise, variance)
    residual = (
        poles.residual
        if beyond.size == poles.beyond.size
        else refine_poles(lines, poles.pole, variance, beyond=beyond, steps=0).residual
    )
    error = model_error(residual, noise, lines.response)
    variance = noise + error**2 * level
    kept = _needed(lines, poles.pole, held[chosen], noise, variance, beyond)
    report("refining modes", 0.7)
    while True:
        chosen = chosen[kept]
        poles = refine_poles(
            lines,
            candidates[chosen],
            variance,
            beyond=beyond,
            doubt=poles.inflation[kept],
            begin=poles.pole[kept],
            steps=steps,
        )
        beyond = poles.beyond
        fit = fit_residues(lines, np.append(poles.pole, beyond), variance)
        significance = _significance(lines, fit, poles.pole, noise, beyond)
        aside = unresolved(lines, poles.pole) & ~held[chosen]
        bad = (_vague(lines, poles, significance) & ~held[chosen]) | aside
        if not bad.any():
            report("refining modes", 1.0)
            return FittedModes(
                chosen,
                poles,
                fit.of_modes(chosen.size),
                variance,
                significance,
                error,
                residual_around(lines, poles.pole, poles.residual, noise),
            )
        beyond = np.append(beyond, poles.pole[aside])
        kept = np.flatnonzero(~bad)


def _silent(what: str, share: float) -> None:
    """Report nothing."""


def _first_fit(
    lines: FrfLines,
    candidates: ComplexArray,
    held: BoolArray,
    noise: FloatArray,
    variance: FloatArray,
    steps: int,
) -> tuple[IntArray, RefinedPoles]:
    """Refine what is needed; poles that end beyond the band become computational."""
    none = np.empty(0, complex)
    chosen = _needed(lines, candidates, held, noise, variance, none)
    poles = refine_poles(lines, candidates[chosen], variance, steps=steps)
    aside = unresolved(lines, poles.pole) & ~held[chosen]
    if not aside.any() or steps == 0:
        return chosen, poles
    left = refine_poles(
        lines,
        candidates[chosen[~aside]],
        variance,
        beyond=poles.pole[aside],
        begin=poles.pole[~aside],
        steps=steps,
    )
    return chosen[~aside], left


def _vague(lines: FrfLines, poles: RefinedPoles, significance: FloatArray) -> BoolArray:
    """Return which modes to drop because their damping is uncertain.

    The damping is taken without the window's: under a strong exponential window every
    noise peak has the window's width.

    Two poles on one peak are both vague, and the fit is as good with one: of
    overlapping vague poles only the least significant goes, then the rest are refitted.
    """
    width = measured_width(lines, poles.pole)
    sd = np.sqrt(poles.covariance[:, 0, 0] * poles.inflation)
    vague: BoolArray = sd > _VAGUE * np.abs(poles.pole.real)
    apart = np.abs(poles.pole.imag[:, None] - poles.pole.imag)
    overlap = apart < 2.0 * (width[:, None] + width)
    rival = overlap & vague & (significance < significance[:, None])
    return np.asarray(vague & ~rival.any(axis=1))


def _needed(
    lines: FrfLines,
    pole: ComplexArray,
    held: BoolArray,
    noise: FloatArray,
    variance: FloatArray,
    beyond: ComplexArray,
) -> IntArray:
    """Drop the least needed pole until all that are left are needed; return indices."""
    left = np.arange(pole.size)
    chance = _CHANCE / lines.laplace.size
    limit = chi2_limit(chance, 2 * lines.response.shape[0])
    while left.size:
        fit = fit_residues(lines, np.append(pole[left], beyond), variance)
        significance = _significance(lines, fit, pole[left], noise, beyond)
        weak: BoolArray = (significance < limit) & ~held[left]
        if not weak.any():
            break
        # Weak poles may replace each other: only the weakest is dropped, and those far
        # below the limit.
        weak &= significance <= max(0.1 * limit, float(significance[weak].min()))
        left = left[~weak]
    return left


def _significance(
    lines: FrfLines,
    fit: LinearFit,
    pole: ComplexArray,
    noise: FloatArray,
    beyond: ComplexArray,
) -> FloatArray:
    """Judge each mode by the noise or by the local residual, whichever is larger."""
    local = local_residual(lines.response - fit.synthesis)
    everything = np.append(pole, beyond)
    judged = fit_residues(lines, everything, np.maximum(noise, local))
    apparent = np.nan_to_num(judged.significance[: pole.size])
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
