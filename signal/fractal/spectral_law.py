# SPDX-License-Identifier: MIT
"""D and S of very smooth and very jagged profiles from their spectra, by likelihood.

Where H exceeds 3/4, means of squared differences scatter with the longest waves, which
levelling changes: S at 25 lags has twice the scatter of D that the heights allow, and
its covariance is nearly singular. Below 1/4 noise is nearly the same as roughness, and
the few profiles that seem to have it scatter. Ordinates of the spectrum are independent
at any H.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_above
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.instrument_choice import (
    Doubt,
    no_doubt,
)
from jointbench.signal.fractal.least_squares import GlsFit, Model
from jointbench.signal.fractal.model_choice import Choice
from jointbench.signal.fractal.self_affine import SeenSurface
from jointbench.signal.fractal.spectral_bend import expected_spectrum, find_kink
from jointbench.signal.surface.binned_spectrum import BinnedSpectrum

_JAGGED, _SMOOTH = 0.5, 1.5
"""Exponents s = 2H below and above which D is taken from the spectrum [-]."""
_EXPONENTS = (0.02, 1.99)
"""Range of s in the search [-]."""
_CLEAR_EFFECT = 14.0
"""Gain of chi2 by noise, or by a blur, that is significant [-]: one clean profile in
10,000. Each that is taken for a noisy one is off by ten standard deviations of D."""
_CAST_DOUBT = 2.71
"""Gain from which they add uncertainty [-]: one clean profile in 20."""
_CLEAR_BEND = 20.0
"""Gain by a significant bend, the largest of all tried [-]."""
_LEAST_PROBABILITY = 1e-4
"""Least probability of a larger chi2, of all ordinates and of the longest waves [-]."""
_LONG_BINS = 10
"""Bins of the longest waves [-]."""
_CLEAR_CORNER = 20.0
"""The same by a roll-off [-]. A smaller one concerns the lowest ordinates, which hardly
bear on D; the band-limited fit decides whether there is one."""
_FEWEST_BINS = 16
"""Least bins of a spectrum that is to be judged [-]."""
_FIRST_LAG = 1.5
"""Shortest lag of the fit above which a filter is stated, which the whole spectrum does
not leave out [samples]."""
_STEPS, _HALVINGS = 60, 12
"""Most steps of the search, and of their halvings [-]."""
_SETTLED = 1e-7
"""Expected gain of the likelihood that ends it [-]."""
_NUDGE = 1e-4
"""Step of the derivatives of ln density [-]."""


class _Extra(StrEnum):
    """What one more parameter may describe."""

    NONE = "none"
    NOISE = "noise"
    BLUR = "blur"
    CORNER = "corner"


@dataclass(frozen=True, slots=True, eq=False)
class _Maximum:
    """End of a search: s, ln S at the pivot and the extra parameter, if any."""

    parameters: FloatArray
    covariance: FloatArray
    likelihood: float


@dataclass(frozen=True, slots=True)
class _SpectralFit:
    """Whittle's likelihood of a power law with one extra parameter or none."""

    problem: FractalProblem
    spectrum: BinnedSpectrum
    extra: _Extra = _Extra.NONE

    def seen(self, parameters: FloatArray) -> SeenSurface:
        """Return the surface of given parameters."""
        exponent, level = float(parameters[0]), float(parameters[1])
        more = float(parameters[2]) if parameters.size > 2 else 0.0
        noisy, blurred = self.extra is _Extra.NOISE, self.extra is _Extra.BLUR
        return SeenSurface(
            exponent=exponent,
            amplitude=float(np.exp(level - exponent * self.problem.log_pivot)),
            noise=0.5 * more * self.problem.least if noisy else 0.0,
            psf_width=float(np.sqrt(more)) if blurred else 0.0,
        )

    def density(self, parameters: FloatArray) -> FloatArray:
        """Return the expected spectrum of height differences."""
        omega = self.spectrum.omega
        density = expected_spectrum(omega, self.seen(parameters))
        if self.extra is _Extra.CORNER:
            corner = float(parameters[2]) * omega[0] ** 2
            fall = 0.5 * (1 + float(parameters[0]))
            density = density * (omega**2 / (omega**2 + corner)) ** fall
        return density

    def likelihood(self, density: FloatArray) -> float:
        """Return the log-likelihood of a density."""
        ratio = self.spectrum.power / density
        return float(np.sum(self.spectrum.count * (np.log(ratio) - ratio)))

    def slopes(self, at: FloatArray, density: FloatArray) -> FloatArray:
        """Return the derivatives of ln density, shape (n_bins, n_parameters)."""
        columns = []
        for k in range(at.size):
            moved = at.copy()
            moved[k] += _NUDGE
            columns.append((np.log(self.density(moved) / density)) / _NUDGE)
        return np.stack(columns, axis=1)

    def maximise(self, start: FloatArray) -> _Maximum:
        """Return the maximum by the method of scoring."""
        here = start.copy()
        density = self.density(here)
        value = self.likelihood(density)
        count = self.spectrum.count
        for _ in range(_STEPS):
            slopes = self.slopes(here, density)
            rest = slopes.T @ (count * (self.spectrum.power / density - 1))
            free = np.ones(here.size, dtype=np.bool_)
            free[2:] = (here[2:] > 0) | (rest[2:] > 0)
            information = (slopes * count[:, None]).T @ slopes
            step = np.zeros(here.size)
            step[free] = np.linalg.solve(information[np.ix_(free, free)], rest[free])
            if rest @ step < _SETTLED:
                break
            for halving in range(_HALVINGS):
                there = here + 0.5**halving * step
                there[0] = np.clip(there[0], *_EXPONENTS)
                there[2:] = np.maximum(there[2:], 0.0)
                trial = self.density(there)
                if self.likelihood(trial) > value:
                    break
            else:
                break
            here, density, value = there, trial, self.likelihood(trial)
        slopes = self.slopes(here, density)
        information = (slopes * count[:, None]).T @ slopes
        covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
        return _Maximum(here, covariance, value)


def spectral_choice(problem: FractalProblem) -> Choice | None:
    """Return the power law of a smooth or jagged profile by its spectrum.

    Args:
        problem: the structure function at the lags of the fit, without tolerance.

    Returns:
        None for maps, pooled profiles, heights in steps, spectra that show noise, a
        blur, a roll-off or a bend, and for H from 1/4 to 3/4, where S is as precise.

    Source:
        Whittle, Ark. Mat. 2 (1953) 423. Limit of H: Istas and Lang, Ann. Inst. H.
        Poincare 33 (1997) 407, section 3.
    """
    spectrum = _spectrum_of(problem)
    if spectrum is None:
        return None
    plain_fit = _SpectralFit(problem, spectrum)
    line = problem.straight()
    start = np.array([line.exponent, np.log(line.surface(np.array(problem.pivot)))])
    plain = plain_fit.maximise(start)
    exponent = float(plain.parameters[0])
    at_end = not _EXPONENTS[0] + _NUDGE < exponent < _EXPONENTS[1] - _NUDGE
    if at_end or _JAGGED < exponent < _SMOOTH:
        return None
    doubt = _doubt(plain_fit, plain)
    if doubt is None:
        return None
    return _judged(plain_fit, plain, doubt)


def _spectrum_of(problem: FractalProblem) -> BinnedSpectrum | None:
    """Return the spectrum of a single profile in full, or None."""
    estimate = problem.estimate
    single = len(estimate.samplings) == 1 and estimate.profiles == 1
    known = estimate.spectrum is not None and estimate.quantum == 0
    if not (single and known and problem.lag[0] < _FIRST_LAG):
        return None
    spectrum = estimate.spectrum
    many = spectrum is not None and spectrum.omega.size >= _FEWEST_BINS
    return spectrum if many else None


def _doubt(plain_fit: _SpectralFit, plain: _Maximum) -> Doubt | None:
    """Return the effect of an insignificant instrument; None for a significant one.

    The larger model includes the true one, so the full distance from it counts.
    """
    found, most = no_doubt(), _CAST_DOUBT
    for extra in (_Extra.NOISE, _Extra.BLUR, _Extra.CORNER):
        fit = _SpectralFit(plain_fit.problem, plain_fit.spectrum, extra)
        large = fit.maximise(np.append(plain.parameters, 0.0))
        gain = 2 * (large.likelihood - plain.likelihood)
        if gain > (_CLEAR_CORNER if extra is _Extra.CORNER else _CLEAR_EFFECT):
            return None
        if extra is not _Extra.CORNER and gain > most:
            most = gain
            apart = large.parameters[:2] - plain.parameters[:2]
            widened = large.covariance[:2, :2] - plain.covariance
            found = Doubt(np.zeros(2), widened + np.outer(apart, apart))
    return found


def _judged(fit: _SpectralFit, plain: _Maximum, doubt: Doubt) -> Choice | None:
    """Return the choice where spectrum and long lags agree with the power law."""
    problem, spectrum = fit.problem, fit.spectrum
    seen = fit.seen(plain.parameters)
    count = spectrum.count
    # A mean of exponential ordinates has a nearly Gaussian cube root.
    share = spectrum.power / fit.density(plain.parameters)
    gap = np.sqrt(count) * (3 * (np.cbrt(share) - 1) + 1 / (3 * count))
    chi2, dof = float(gap @ gap), spectrum.omega.size - 2
    long = float(np.sum(gap[:_LONG_BINS] ** 2))
    sure = min(chi2_above(chi2, dof), chi2_above(long, _LONG_BINS))
    if sure < _LEAST_PROBABILITY or find_kink(problem, seen, _CLEAR_BEND):
        return None
    described = GlsFit(
        model=Model(),
        seen=seen,
        lag=problem.lag,
        predicted=problem.predicted(seen),
        parameters=plain.parameters,
        covariance=plain.covariance,
        gain=np.zeros((2, problem.lag.size)),
        pivot=problem.pivot,
        chi2=chi2,
        log_determinant=0.0,
        dof=dof,
    )
    excess = max(1.0, problem.tails, chi2 / (dof + 2 * np.sqrt(2 * dof)))
    return Choice(
        fit=described,
        law=plain.parameters + doubt.shift,
        covariance=excess * plain.covariance + doubt.covariance,
        problem=problem,
        long_probability=sure,
    )
