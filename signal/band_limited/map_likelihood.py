# SPDX-License-Identifier: MIT
"""Whittle's likelihood of a map's spectrum, and its maximum by scoring."""

import math
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, read_only
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum, line_of
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
from jointbench.signal.band_limited.map_sample import MapSample
from jointbench.signal.band_limited.seen_bins import SeenBins, SeenDensity
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
MOST_STEPS, _TRIALS = 40, 8
"""Most steps of a search, and most dampings of one [-]."""
_SETTLED = 2e-3
"""Expected gain of the log-likelihood that ends a search [-]."""
_NUDGE = 1e-3
"""Step of the derivative of a stated tip's prior over the blur, or over 1 [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MapLikelihood:
    """Log-likelihood of a map.

    Attributes:
        bins: of its spectrum.
        tolerance: standard deviation of ln density by which each bin may differ from
            the model [-].
        heeds_tip: whether the stated radius of a stylus is a prior of the blur.
        counts: ordinates of each bin, fewer where the model is only tolerated [-].
        pivot: wavenumber of the level [rad/sample]: the geometric middle of the band.
        unit_noise: variance of white heights with the least density of the spectrum.
        bounds: lower and upper bounds of the parameters.
    """

    bins: SeenBins
    tolerance: float = 0.0
    heeds_tip: bool = True
    counts: FloatArray = field(init=False)
    pivot: float = field(init=False)
    unit_noise: float = field(init=False)
    bounds: tuple[FloatArray, FloatArray] = field(init=False)

    def __post_init__(self) -> None:
        """Work out what a search looks at hundreds of times."""
        sample, tolerance = self.bins.sample, self.tolerance
        counts = read_only(sample.count / (1 + sample.count * tolerance**2))
        top = min(np.pi, sample.transfer.highest)
        pivot = math.sqrt(top * 2 * np.pi / sample.length)
        object.__setattr__(self, "counts", counts)
        object.__setattr__(self, "pivot", pivot)
        object.__setattr__(self, "unit_noise", self.bins.cell * sample.floor)
        object.__setattr__(self, "bounds", _bounds(sample))

    def model(self, at: FloatArray) -> LaySpectrum:
        """Return the surface of given parameters."""
        return LaySpectrum(
            level=math.exp(at[LEVEL]),
            pivot=self.pivot,
            hurst=float(at[HURST]),
            roll_off=math.exp(at[ROLL_OFF]),
            blur=max(0.0, float(at[BLUR])),
            noise=max(0.0, float(at[NOISE])) * self.unit_noise,
            ratio=math.exp(at[RATIO]),
            angle=float(at[ANGLE]),
            skew=float(at[SKEW]),
        )

    def density(self, at: FloatArray) -> FloatArray:
        """Return the expected spectrum in each bin."""
        return self.seen(at).density

    def seen(self, at: FloatArray, *, turned: bool = True) -> SeenDensity:
        """Return the expected spectrum in each bin, for its derivatives as well.

        Args:
            at: parameters.
            turned: whether they have a lay, or derivatives by one are asked for.
        """
        return self.bins.seen(self.model(at), least=FLOOR, turned=turned)

    def __call__(self, at: FloatArray) -> float:
        """Return the log-likelihood of parameters."""
        return self.of_density(self.density(at), at)

    def of_density(self, density: FloatArray, at: FloatArray) -> float:
        """Return the log-likelihood of an expected spectrum."""
        power = self.bins.sample.power
        total = -float(self.counts @ (np.log(density) + power / density))
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


def _bounds(sample: MapSample) -> tuple[FloatArray, FloatArray]:
    """Return lower and upper bounds of the parameters, each of shape (8,)."""
    level = float(np.log(np.median(sample.power)))
    far = np.log([_SHORTEST_ROLL_OFF, LONGEST_ROLL_OFF * sample.length])
    low = [level - 60, HURST_RANGE[0], far[0], 0, 0]
    high = [level + 60, HURST_RANGE[1], far[1]]
    high += [(_WIDEST_CUT * sample.length) ** 2, 1.5]
    return (
        read_only(np.array([*low, -_LONGEST_RATIO, -np.inf, -_LARGEST_SKEW])),
        read_only(np.array([*high, _LONGEST_RATIO, np.inf, _LARGEST_SKEW])),
    )


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
    likelihood: MapLikelihood,
    start: FloatArray,
    free: BoolArray,
    *,
    most: int = MOST_STEPS,
) -> MapMaximum:
    """Find the maximum next to a start, by the parameters that are free.

    Args:
        likelihood: of the map.
        start: parameters, shape (8,).
        free: which of them are searched, same shape.
        most: steps.

    Source:
        Method of scoring: Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, damped as by
        Marquardt; parameters at an active bound are held.
    """
    lower, upper = likelihood.bounds
    here, seen = _levelled(likelihood, _within(start, lower, upper), free)
    value, damping = likelihood.of_density(seen.density, here), 1e-3
    scores = _scores(likelihood, here, seen, free)
    for _ in range(most):
        steps = _steps(scores, here, likelihood.bounds)
        if not steps.damped(0.0) @ scores.slope > 2 * _SETTLED:
            break
        before = value
        for _ in range(_TRIALS):
            step = steps.damped(damping)
            there = _within(here + step, lower, upper)
            there, trial = _levelled(likelihood, there, free)
            reached = likelihood.of_density(trial.density, there)
            if reached <= value:
                # A bent ridge: the step followed by what it missed by.
                bend = steps.bent(scores, seen, trial, there - here, damping)
                there = _within(here + step + bend, lower, upper)
                there, trial = _levelled(likelihood, there, free)
                reached = likelihood.of_density(trial.density, there)
            if reached > value:
                here, seen, value, damping = there, trial, reached, 0.2 * damping
                break
            damping = max(1e-3, 8 * damping)
        if value - before < _SETTLED:
            break
        scores = _scores(likelihood, here, seen, free)
    return _with_long_waves_along(MapMaximum(here, value, scores.information))


def _levelled(
    likelihood: MapLikelihood, at: FloatArray, free: BoolArray
) -> tuple[FloatArray, SeenDensity]:
    """Return parameters with the likeliest level, where it is known, and the density.

    Without noise the density is in proportion to it. Scoring lowers the level of a
    density that is far too high by no more than a factor e in a step.
    """
    turned = bool(free[RATIO]) or at[RATIO] != 0 or at[SKEW] != 0
    seen = likelihood.seen(at, turned=turned)
    if at[NOISE] > 0 or not free[LEVEL]:
        return at, seen
    ratio = likelihood.bins.sample.power / seen.density
    factor = float(likelihood.counts @ ratio / likelihood.counts.sum())
    lower, upper = likelihood.bounds
    if not lower[LEVEL] < at[LEVEL] + math.log(factor) < upper[LEVEL]:
        return at, seen
    raised = at.copy()
    raised[LEVEL] += math.log(factor)
    return raised, seen.raised(factor)


def _with_long_waves_along(found: MapMaximum) -> MapMaximum:
    """Return the description of a lay whose ratio is 1 or above."""
    if found.parameters[RATIO] >= 0:
        return found
    sign = np.ones(found.parameters.size)
    sign[[RATIO, SKEW]] = -1
    at = sign * found.parameters
    at[ANGLE] += np.pi / 2
    return MapMaximum(at, found.value, found.information * np.outer(sign, sign))


@dataclass(frozen=True, slots=True, eq=False)
class _DensityScores:
    """Derivatives at one place.

    Attributes:
        free: parameters that are searched, shape (n_parameters,).
        rates: of ln density in each bin by these, shape (n_free, n_bins).
        weighted: the same times the number of ordinates.
        information: Fisher's, shape (n_parameters, n_parameters).
        slope: of the log-likelihood, shape (n_parameters,).
    """

    free: BoolArray
    rates: FloatArray
    weighted: FloatArray
    information: FloatArray
    slope: FloatArray


def _scores(
    likelihood: MapLikelihood, at: FloatArray, seen: SeenDensity, free: BoolArray
) -> _DensityScores:
    """Return Fisher's information and the derivatives of the log-likelihood."""
    sample, counts, density = likelihood.bins.sample, likelihood.counts, seen.density
    white = likelihood.unit_noise / likelihood.bins.cell
    places = free.nonzero()[0]
    rates = np.empty((places.size, density.size))
    for row, k in enumerate(places.tolist()):
        if k == LEVEL:
            rates[row] = density - max(0.0, float(at[NOISE])) * white
        elif k == NOISE:
            rates[row] = white
        else:
            rates[row] = seen.rate(k)
    rates /= density
    information = np.zeros((at.size, at.size))
    weighted = rates * counts
    information[np.ix_(free, free)] = weighted @ rates.T
    slope = np.zeros(at.size)
    slope[free] = weighted @ (sample.power / density - 1)
    if likelihood.heeds_tip and sample.transfer.tip is not None and free[BLUR]:
        _add_tip(likelihood, at, information, slope)
    return _DensityScores(free, rates, weighted, information, slope)


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
    nudge = _NUDGE * max(1.0, float(at[BLUR]))
    moved[BLUR] += nudge
    slope[BLUR] -= here * (likelihood.tip_surprise(moved) - here) / nudge


@dataclass(frozen=True, slots=True, eq=False)
class _ScoringSteps:
    """Normal equations of the moving parameters, each scaled by its information.

    Attributes:
        moving: shape (n_parameters,).
        size: root of the information of the moving ones, shape (n_moving,).
        curvature: shape (n_moving, n_moving).
        slope: of the log-likelihood over `size`, shape (n_moving,).
    """

    moving: BoolArray
    size: FloatArray
    curvature: FloatArray
    slope: FloatArray

    def damped(self, damping: float) -> FloatArray:
        """Return the damped step of all parameters."""
        return self._solved(self.slope, damping)

    def bent(
        self,
        scores: _DensityScores,
        seen: SeenDensity,
        trial: SeenDensity,
        step: FloatArray,
        damping: float,
    ) -> FloatArray:
        """Return the correction of a step by the bend of ln density along it.

        Args:
            scores: where the step begins.
            seen: density there.
            trial: density at its end.
            step: of all parameters.
            damping: of the step.

        Source:
            Transtrum, Machta and Sethna, Phys. Rev. E 83 (2011) 036701, sec. VII.
        """
        bend = np.log(trial.density / seen.density) - step[scores.free] @ scores.rates
        slope = np.zeros(self.moving.size)
        slope[scores.free] = scores.weighted @ bend
        return -self._solved(slope[self.moving] / self.size, damping)

    def _solved(self, slope: FloatArray, damping: float) -> FloatArray:
        """Return the damped solution for all parameters."""
        step = np.zeros(self.moving.size)
        if self.size.size:
            curvature = self.curvature.copy()
            curvature.flat[:: self.size.size + 1] += damping + 1e-9
            step[self.moving] = np.linalg.solve(curvature, slope) / self.size
        return step


def _steps(
    scores: _DensityScores, here: FloatArray, bounds: tuple[FloatArray, FloatArray]
) -> _ScoringSteps:
    """Return what the steps of all dampings have in common."""
    lower, upper = bounds
    information, slope = scores.information, scores.slope
    moving = scores.free & (information.diagonal() > 0)
    moving &= ~((here <= lower) & (slope < 0)) & ~((here >= upper) & (slope > 0))
    part = information[moving][:, moving]
    size = np.sqrt(part.diagonal())
    return _ScoringSteps(
        moving, size, part / (size[:, None] * size), slope[moving] / size
    )


def _within(values: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Return values within their bounds, and the angle within half a turn.

    Where the ratio is nearly 1 a step of the angle may be millions of turns, of which
    rounding leaves no angle.
    """
    # `numpy.clip` takes longer to be called.
    within: FloatArray = np.minimum(np.maximum(values, lower), upper)
    within[ANGLE] = math.remainder(float(within[ANGLE]), math.pi)
    return within
