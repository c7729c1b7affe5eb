# SPDX-License-Identifier: MIT
"""Maximum of the likelihood by Fisher scoring within bounds."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.band_limited.spectral_likelihood import (
    FLOOR,
    IMPOSSIBLE,
    SpectralLikelihood,
)
from jointbench.signal.band_limited.tip_width import (
    SHARE,
    contact_length,
    tip_information,
)

_STEPS = 60
"""Most steps of a search; 8 to 15 are usual [-]."""
_TRIALS = 10
"""Most dampings of a step [-]."""
_SETTLED = 2e-3
"""Expected gain of the log-likelihood that ends a search [-]."""
_SHARE = 0.01
"""Step of a numerical derivative over the parameter's standard deviation [-]."""
_NUDGE = np.array([1e-4, 1e-4, 1e-3, 1e-3, 1e-3])
"""Steps of the derivatives of ln density; of the blur relative to it as well."""
_STEEPEST = 1e8
"""Largest derivative of the log-likelihood in standard deviations of a parameter; it
is as large only where the density is nil [-]."""
_WEAK = 1e-12
"""Least information of a free parameter [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Maximum:
    """End of a search.

    Attributes:
        parameters: shape (n,).
        value: log-likelihood.
        information: Fisher's, shape (n, n); rows of parameters that were held are 0.
    """

    parameters: FloatArray
    value: float
    information: FloatArray

    @property
    def criterion(self) -> float:
        """Log-likelihood less the number of parameters that were free (Akaike)."""
        return self.value - int(np.count_nonzero(np.diag(self.information)))


def maximise(
    likelihood: SpectralLikelihood, start: FloatArray, free: BoolArray
) -> Maximum:
    """Find the maximum next to a start, by the parameters that are free.

    Source:
        Method of scoring: Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, damped as by
        Marquardt; parameters at an active bound are held.
    """
    lower, upper = np.array(likelihood.bounds).T
    here = np.clip(start, lower, upper)
    value, damping = likelihood(here), 1e-3
    for _ in range(_STEPS):
        information = information_at(likelihood, here, free)
        slope = _slope(likelihood, here, value, information, upper)
        moving = free & ~((here <= lower) & (slope < 0))
        moving &= ~((here >= upper) & (slope > 0)) & (np.diag(information) > _WEAK)
        step, gain = _step(information, slope, moving, 0.0)
        if not gain >= _SETTLED or value <= IMPOSSIBLE:
            break
        best = value
        for _ in range(_TRIALS):
            step, _ = _step(information, slope, moving, damping)
            there = np.clip(here + step, lower, upper)
            trial = likelihood(there)
            if trial > value:
                here, value, damping = there, trial, 0.2 * damping
                break
            damping = max(1e-3, 5 * damping)
        if value - best < 1e-4:
            break
    return Maximum(here, value, information_at(likelihood, here, free))


def information_at(
    likelihood: SpectralLikelihood, at: FloatArray, free: BoolArray
) -> FloatArray:
    """Return Fisher's information of ordinates of the spectrum, shape (n, n).

    The long waves count as ordinates of the length, one for each profile.
    """
    sample = likelihood.sample
    omega, counts = sample.omega, likelihood.counts
    if sample.blocks is not None:
        waves = np.arange(1, sample.blocks.means.shape[0] // 2)
        omega = np.concatenate([2 * np.pi * waves / sample.points, omega])
        long = np.full(waves.size, float(sample.blocks.means.shape[1]))
        counts = np.concatenate([long, counts])
    slopes = np.zeros((at.size, omega.size))
    base = np.log(likelihood.model(at).sampled(omega, sample.transfer) + FLOOR)
    for k in np.flatnonzero(free):
        moved = at.copy()
        move = _NUDGE[k] * max(1.0, abs(float(at[k])) if k > 2 else 1.0)
        moved[k] += move
        density = likelihood.model(moved).sampled(omega, sample.transfer)
        slopes[k] = (np.log(density + FLOOR) - base) / move
    information: FloatArray = (slopes * counts) @ slopes.T
    if likelihood.heeds_tip and sample.transfer.tip is not None and free[3]:
        width = SHARE * contact_length(likelihood.model(at), sample)
        information[3, 3] += tip_information(at, width)
    return information


def _slope(
    likelihood: SpectralLikelihood,
    here: FloatArray,
    value: float,
    information: FloatArray,
    upper: FloatArray,
) -> FloatArray:
    """Return the derivatives of the log-likelihood by differences."""
    slope = np.zeros(here.size)
    strength = np.diag(information)
    for k in np.flatnonzero(strength > _WEAK):
        move = min(_SHARE / np.sqrt(strength[k]), 0.1)
        move = -move if here[k] + move > upper[k] else move
        moved = here.copy()
        moved[k] += move
        # The quadratic part of a one-sided difference is known.
        slope[k] = (likelihood(moved) - value) / move + 0.5 * strength[k] * move
    return slope


def _step(
    information: FloatArray, slope: FloatArray, moving: BoolArray, damping: float
) -> tuple[FloatArray, float]:
    """Return the damped step of the moving parameters, and the gain it promises."""
    step = np.zeros(slope.size)
    if not moving.any():
        return step, 0.0
    size = np.sqrt(np.diag(information)[moving])
    scaled = information[np.ix_(moving, moving)] / np.outer(size, size)
    scaled += (damping + 1e-9) * np.eye(size.size)
    ratio = np.clip(slope[moving] / size, -_STEEPEST, _STEEPEST)
    step[moving] = np.linalg.solve(scaled, ratio) / size
    return step, float(0.5 * ratio @ (step[moving] * size))
