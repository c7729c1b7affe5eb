# SPDX-License-Identifier: MIT
"""Whittle's likelihood of a map's spectrum, and its maximum by scoring."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum, SeenBins
from jointbench.signal.band_limited.line_spectrum_of_map import line_of
from jointbench.signal.band_limited.map_parameters import (
    ANGLE,
    BLUR,
    HURST,
    LEVEL,
    NOISE,
    RATIO,
    ROLL_OFF,
    SKEW,
)
from jointbench.signal.band_limited.spectral_likelihood import (
    FLOOR,
    HURST_RANGE,
    LONGEST_ROLL_OFF,
)
from jointbench.signal.band_limited.tip_width import (
    SHARE,
    contact_length,
    tip_information,
    tip_surprise,
)

_SHORTEST_ROLL_OFF = 4.0
"""Shortest roll-off [samples]."""
_WIDEST_CUT = 0.05
"""Widest short cut over the length [-]."""
_LONGEST_RATIO = 6.0
"""Largest logarithm of the ratio along over across [-]."""
_LARGEST_SKEW = 0.6
"""Largest e [-]: exponents along and across of a factor 4."""
_STEPS, _TRIALS = 40, 8
"""Most steps of a search, and most dampings of one [-]."""
_SETTLED = 2e-3
"""Expected gain of the log-likelihood that ends a search [-]."""
_NUDGE = np.array([0, 1e-4, 1e-4, 1e-3, 0, 1e-4, 1e-4, 1e-4])
"""Steps of the derivatives of ln density; level and noise have closed ones."""


@dataclass(frozen=True, slots=True, eq=False)
class MapLikelihood:
    """Log-likelihood of a map.

    Attributes:
        bins: of its spectrum.
        tolerance: standard deviation of ln density by which each bin may differ from
            the model [-].
        heeds_tip: whether the stated radius of a stylus is a prior of the blur.
    """

    bins: SeenBins
    tolerance: float = 0.0
    heeds_tip: bool = True

    @property
    def pivot(self) -> float:
        """Wavenumber of the level [rad/sample]: the geometric middle of the band."""
        top = min(np.pi, self.bins.sample.transfer.highest)
        return float(np.sqrt(top * 2 * np.pi / self.bins.sample.length))

    @property
    def counts(self) -> FloatArray:
        """Ordinates of each bin, fewer where the model is only tolerated [-]."""
        count = self.bins.sample.count
        counts: FloatArray = count / (1 + count * self.tolerance**2)
        return counts

    @property
    def unit_noise(self) -> float:
        """Variance of white heights with the least density of the spectrum."""
        sample = self.bins.sample
        return 4 * np.pi**2 / sample.stretch * sample.floor

    def model(self, at: FloatArray) -> LaySpectrum:
        """Return the surface of given parameters."""
        return LaySpectrum(
            level=float(np.exp(at[LEVEL])),
            pivot=self.pivot,
            hurst=float(at[HURST]),
            roll_off=float(np.exp(at[ROLL_OFF])),
            blur=max(0.0, float(at[BLUR])),
            noise=max(0.0, float(at[NOISE])) * self.unit_noise,
            ratio=float(np.exp(at[RATIO])),
            angle=float(at[ANGLE]),
            skew=float(at[SKEW]),
        )

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds of the parameters."""
        sample = self.bins.sample
        level = float(np.log(np.median(sample.power)))
        far = np.log([_SHORTEST_ROLL_OFF, LONGEST_ROLL_OFF * sample.length])
        low = [level - 60, HURST_RANGE[0], far[0], 0, 0]
        high = [level + 60, HURST_RANGE[1], far[1]]
        high += [(_WIDEST_CUT * sample.length) ** 2, 1.5]
        return (
            np.array([*low, -_LONGEST_RATIO, -np.inf, -_LARGEST_SKEW]),
            np.array([*high, _LONGEST_RATIO, np.inf, _LARGEST_SKEW]),
        )

    def density(self, at: FloatArray) -> FloatArray:
        """Return the expected spectrum in each bin."""
        return np.maximum(self.bins.density(self.model(at)), FLOOR)

    def of_density(self, density: FloatArray, at: FloatArray) -> float:
        """Return the log-likelihood of an expected spectrum."""
        power = self.bins.sample.power
        total = -float(np.sum(self.counts * (np.log(density) + power / density)))
        if self.heeds_tip and self.bins.sample.transfer.tip is not None:
            total -= 0.5 * self.tip_surprise(at) ** 2
        return total

    def tip_surprise(self, at: FloatArray) -> float:
        """Return how far the blur is from that of the stated tip [sd]."""
        return tip_surprise(line_of(self.model(at)), self.bins.sample)

    def deviance_of(self, density: FloatArray) -> float:
        """Return the gamma deviance of the spectrum, see `SpectralLikelihood`."""
        ratio = self.bins.sample.power / density
        return float(np.sum(2 * self.counts * (ratio - 1 - np.log(ratio))))


@dataclass(frozen=True, slots=True, eq=False)
class MapMaximum:
    """End of a search.

    Attributes:
        parameters: shape (8,).
        value: log-likelihood.
        information: Fisher's, shape (8, 8); rows of parameters that were held are 0.
    """

    parameters: FloatArray
    value: float
    information: FloatArray

    @property
    def free(self) -> BoolArray:
        """Which parameters have information."""
        return np.diag(self.information) > 0

    @property
    def criterion(self) -> float:
        """Log-likelihood less the number of parameters that were free (Akaike)."""
        return self.value - int(np.count_nonzero(self.free))


def maximise_map(
    likelihood: MapLikelihood, start: FloatArray, free: BoolArray
) -> MapMaximum:
    """Find the maximum next to a start, by the parameters that are free.

    Source:
        Method of scoring: Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, damped as by
        Marquardt; parameters at an active bound are held.
    """
    lower, upper = likelihood.bounds
    here = np.clip(start, lower, upper)
    density = likelihood.density(here)
    value, damping = likelihood.of_density(density, here), 1e-3
    information, slope = _scores(likelihood, here, density, free)
    for _ in range(_STEPS):
        moving = free & (np.diag(information) > 0)
        moving &= ~((here <= lower) & (slope < 0)) & ~((here >= upper) & (slope > 0))
        if not _step(information, slope, moving, 0.0) @ slope > 2 * _SETTLED:
            break
        before = value
        for _ in range(_TRIALS):
            step = _step(information, slope, moving, damping)
            there = np.clip(here + step, lower, upper)
            trial = likelihood.density(there)
            reached = likelihood.of_density(trial, there)
            if reached > value:
                here, density, value, damping = there, trial, reached, 0.2 * damping
                break
            damping = max(1e-3, 8 * damping)
        if value - before < _SETTLED:
            break
        information, slope = _scores(likelihood, here, density, free)
    return _with_long_waves_along(MapMaximum(here, value, information))


def _with_long_waves_along(found: MapMaximum) -> MapMaximum:
    """Return the description of a lay whose ratio is 1 or above."""
    if found.parameters[RATIO] >= 0:
        return found
    sign = np.ones(found.parameters.size)
    sign[[RATIO, SKEW]] = -1
    at = sign * found.parameters
    at[ANGLE] += np.pi / 2
    return MapMaximum(at, found.value, found.information * np.outer(sign, sign))


def _scores(
    likelihood: MapLikelihood, at: FloatArray, density: FloatArray, free: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return Fisher's information and the derivatives of the log-likelihood."""
    sample, counts = likelihood.bins.sample, likelihood.counts
    rates = np.zeros((at.size, density.size))
    cell = 4 * np.pi**2 / sample.stretch
    white = likelihood.unit_noise / cell
    rates[LEVEL] = (density - max(0.0, float(at[NOISE])) * white) / density
    rates[NOISE] = white / density
    logs = np.log(density)
    for k in np.flatnonzero(free & (_NUDGE > 0)):
        moved = at.copy()
        nudge = _NUDGE[k] * max(1.0, abs(float(at[k])) if k == BLUR else 1.0)
        moved[k] += nudge
        rates[k] = (np.log(likelihood.density(moved)) - logs) / nudge
    rates[~free] = 0.0
    information = (rates * counts) @ rates.T
    slope: FloatArray = rates @ (counts * (sample.power / density - 1))
    if likelihood.heeds_tip and sample.transfer.tip is not None and free[BLUR]:
        _add_tip(likelihood, at, information, slope)
    return information, slope


def _add_tip(
    likelihood: MapLikelihood,
    at: FloatArray,
    information: FloatArray,
    slope: FloatArray,
) -> None:
    """Add the prior of a stated tip to information and slope."""
    width = SHARE * contact_length(
        line_of(likelihood.model(at)), likelihood.bins.sample
    )
    information[BLUR, BLUR] += tip_information(at, width)
    here = likelihood.tip_surprise(at)
    moved = at.copy()
    nudge = 1e-3 * max(1.0, float(at[BLUR]))
    moved[BLUR] += nudge
    slope[BLUR] -= here * (likelihood.tip_surprise(moved) - here) / nudge


def _step(
    information: FloatArray, slope: FloatArray, moving: BoolArray, damping: float
) -> FloatArray:
    """Return the damped step of the moving parameters."""
    step = np.zeros(slope.size)
    if moving.any():
        size = np.sqrt(np.diag(information)[moving])
        scaled = information[np.ix_(moving, moving)] / np.outer(size, size)
        scaled += (damping + 1e-9) * np.eye(size.size)
        step[moving] = np.linalg.solve(scaled, slope[moving] / size) / size
    return step
