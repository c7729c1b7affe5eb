# SPDX-License-Identifier: MIT
"""The band-limited self-affine surface of a map, isotropic or with a lay."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.surfaces import Areal
from jointbench.signal.band_limited.band_records import (
    BandLimitedFit,
    Interval95,
    RollOffVerdict,
    RoughnessMoments,
    SurfaceLay,
)
from jointbench.signal.band_limited.fit_limits import (
    BEYOND_RATIO,
    LEAST_HURST,
    OTHER_FORM,
    REJECTED,
    SATURATED_RATIO,
    WIDEST_TOLERANCE,
)
from jointbench.signal.band_limited.gamma_deviance import expected_deviance
from jointbench.signal.band_limited.lay_spectrum import line_of
from jointbench.signal.band_limited.map_likelihood import (
    MapLikelihood,
    MapMaximum,
    maximise_map,
)
from jointbench.signal.band_limited.map_models import (
    FEW,
    MapModels,
    again,
    in_sectors,
    map_models,
    refitted,
)
from jointbench.signal.band_limited.map_moments import (
    longest_map_wave,
    measured_map_moments,
    ring_moments,
    shortest_map_wave,
)
from jointbench.signal.band_limited.map_parameters import (
    ANGLE,
    BLUR,
    HURST,
    RATIO,
    ROLL_OFF,
)
from jointbench.signal.band_limited.map_sample import map_sample
from jointbench.signal.band_limited.moment_units import in_metres
from jointbench.signal.band_limited.roughness_moments import (
    cut_wavelength,
)
from jointbench.signal.band_limited.seen_bins import seen_bins
from jointbench.signal.band_limited.tip_width import tip_deviation
from jointbench.signal.band_limited.weighted_draws import WIDEST_ROLL_OFF
from jointbench.signal.fractal.verdict_records import NORMAL_97_5

_ROUNDS = 3
"""Times that tolerance and fit follow each other [-]; the last change is 1 %."""
_LARGEST_TOLERANCE = 1.0
"""Largest tolerance that is tried [-]."""
_CLEAR = 40.0
"""Twice the gain by a roll-off above which its likelihood is a parabola [-]."""
_WEAKEST = 1e-9
"""Least information of a parameter in an interval, over the largest one scaled [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Weighed:
    """Models with the weight of Akaike's criterion, and the spread of each."""

    likelihood: MapLikelihood
    maxima: tuple[MapMaximum, ...]
    weight: FloatArray
    spread: tuple[FloatArray, ...]

    def estimate(
        self, function: Callable[[FloatArray], FloatArray], *, log: bool = True
    ) -> list[Interval95]:
        """Return functions of the parameters with their intervals.

        The variance is that of each model and that between models.

        Source:
            Buckland et al., Biometrics 53 (1997) 603, eq. (9).
        """

        def taken(at: FloatArray) -> FloatArray:
            value = np.atleast_1d(function(at))
            return np.log(np.maximum(value, 1e-300)) if log else value

        values, variances = [], []
        for one, spread in zip(self.maxima, self.spread, strict=True):
            at = one.parameters
            values.append(taken(at))
            slopes = np.zeros((values[-1].size, at.size))
            for k in np.flatnonzero(one.free):
                moved = at.copy()
                moved[k] += 0.1 * np.sqrt(spread[k, k]) + 1e-12
                slopes[:, k] = (taken(moved) - values[-1]) / (moved[k] - at[k])
            variances.append(np.einsum("ij,jk,ik->i", slopes, spread, slopes))
        centre = self.weight @ np.array(values)
        between = np.array(variances) + (np.array(values) - centre) ** 2
        reach = NORMAL_97_5 * np.sqrt(self.weight @ between)
        best = values[0]
        ends = [
            best,
            np.minimum(best, centre - reach),
            np.maximum(best, centre + reach),
        ]
        table = np.exp(ends) if log else np.array(ends)
        return [Interval95(*map(float, column)) for column in table.T]


@one_thread()
def fit_map(areal: Areal, *, degree: int = 1) -> BandLimitedFit | None:
    """Fit a band-limited self-affine surface to a map over both wavenumbers.

    Whittle's likelihood of the spectrum in bins of wavelength and direction, with the
    filters of the instrument as stated. A likelihood-ratio test decides whether the
    surface has a lay, another whether it rolls off.

    Args:
        areal: the map; its largest part without gaps counts.
        degree: of the form that was removed; a plane is always left out.

    Returns:
        The surface with intervals, or the moments of the measured spectrum and the
        reason why no self-affine band describes it; None where the part without gaps
        has sides of fewer than 48 points.

    Raises:
        UsageError: the map is a plane.

    Source:
        Whittle, Biometrika 41 (1954) 434; tapers against the bias of its edges:
        Dahlhaus and Kuensch, Biometrika 74 (1987) 877.
    """
    sample = map_sample(areal, degree=degree)
    if sample is None:
        return None
    models = _tolerated(map_models(MapLikelihood(seen_bins(sample))))
    if models.likelihood.tolerance > WIDEST_TOLERANCE:
        share = 100 * models.likelihood.tolerance
        return _no_band(models, f"{OTHER_FORM} by {share:.0f} %")
    if models.best.parameters[HURST] <= LEAST_HURST or _all_noise(models):
        return _no_band(models, "the spectrum is level at all wavelengths")
    return _described(models)


def _all_noise(models: MapModels) -> bool:
    """Return whether noise exceeds the surface at every wavelength."""
    bins = models.likelihood.bins
    white = models.likelihood.model(models.best.parameters).noise / bins.cell
    return bool(np.all(models.density < 2 * white))


def _tolerated(models: MapModels) -> MapModels:
    """Return the models with the least tolerance that makes the deviance ordinary."""
    if _surplus(models, 0.0, REJECTED) <= 0:
        return models
    for _ in range(_ROUNDS):
        found = _needed(models)
        models = again(models, found)
        if found >= _LARGEST_TOLERANCE:
            break
    return models


def _needed(models: MapModels) -> float:
    """Return the tolerance under which a fit has the deviance of a right model."""
    if _surplus(models, 0.0, 0.0) <= 0:
        return 0.0
    if _surplus(models, _LARGEST_TOLERANCE, 0.0) > 0:
        return _LARGEST_TOLERANCE
    found = brentq(
        lambda one: _surplus(models, one, 0.0), 0.0, _LARGEST_TOLERANCE, xtol=1e-3
    )
    return float(found)


def _surplus(models: MapModels, tolerance: float, margin: float) -> float:
    """Return by how much the deviance exceeds that of a right model."""
    likelihood = replace(models.likelihood, tolerance=tolerance)
    mean, sd = expected_deviance(likelihood.counts)
    return likelihood.deviance_of(models.density) - mean - margin * sd


def _no_band(models: MapModels, reason: str) -> BandLimitedFit:
    """Return the moments of the measured spectrum and the reason for no more."""
    sample = models.likelihood.bins.sample
    return BandLimitedFit(
        verdict=RollOffVerdict.NO_BAND,
        reason=f"{reason}; the moments are sums of the measured spectrum",
        hurst=None,
        roll_off=None,
        roll_off_beyond=None,
        height=None,
        short_cut=None,
        tip_deviation=None,
        noise=0.0,
        moments=measured_map_moments(sample),
        tolerance=models.likelihood.tolerance,
        model=None,
        pitch=sample.pitch,
        scale=sample.scale,
        mapped=True,
    )


def _weighed(models: MapModels, maxima: tuple[MapMaximum, ...]) -> _Weighed:
    best = max(one.criterion for one in maxima)
    weight = np.array([np.exp(one.criterion - best) for one in maxima])
    spread = tuple(_covariance(one) for one in maxima)
    return _Weighed(models.likelihood, maxima, weight / weight.sum(), spread)


def _covariance(one: MapMaximum) -> FloatArray:
    """Return the inverse of Fisher's information of the free parameters."""
    free = one.free
    information = one.information.copy()
    information[ROLL_OFF, ROLL_OFF] += free[ROLL_OFF] / WIDEST_ROLL_OFF**2
    size = np.sqrt(np.diag(information)[free])
    scaled = information[np.ix_(free, free)] / np.outer(size, size)
    inverse = np.linalg.inv(scaled + _WEAKEST * np.eye(size.size))
    spread = np.zeros_like(one.information)
    spread[np.ix_(free, free)] = inverse / np.outer(size, size)
    return spread


def _described(models: MapModels) -> BandLimitedFit:
    """Return the accepted fit with intervals."""
    likelihood, sample = models.likelihood, models.likelihood.bins.sample
    saturated = models.ratio > SATURATED_RATIO
    kinds = models.rolling if saturated else (*models.rolling, *models.endless)
    kinds = tuple(sorted(kinds, key=lambda one: -one.criterion))
    weighed = _weighed(models, kinds)
    best = kinds[0].parameters
    model = likelihood.model(best)
    beyond = min(_beyond(models), longest_map_wave(sample))
    verdict = RollOffVerdict.SATURATED
    if not saturated:
        whole = beyond >= sample.length
        verdict = RollOffVerdict.FRACTAL if whole else RollOffVerdict.UNDECIDED
    far = sample.pitch
    (hurst,) = weighed.estimate(lambda at: at[HURST], log=False)
    roll_off = None
    if saturated:
        (roll_off,) = weighed.estimate(lambda at: far * np.exp(at[ROLL_OFF]))
    return BandLimitedFit(
        verdict=verdict,
        reason=_reason(models, beyond),
        hurst=hurst,
        roll_off=roll_off,
        roll_off_beyond=beyond * far,
        height=_whole_height(weighed) if saturated else None,
        short_cut=_short_cut(weighed, far),
        tip_deviation=None if sample.transfer.tip is None else _tip(models),
        noise=sample.scale * float(np.sqrt(model.noise)),
        moments=_moments(weighed),
        tolerance=likelihood.tolerance,
        model=line_of(model),
        pitch=far,
        scale=sample.scale,
        mapped=True,
        lay=_lay(weighed, saturated=saturated) if models.lay else None,
        map_model=model,
    )


def _short_cut(weighed: _Weighed, pitch: float) -> Interval95:
    def cut(at: FloatArray) -> FloatArray:
        return pitch * cut_wavelength(at[BLUR : BLUR + 1])

    if weighed.maxima[0].parameters[BLUR] <= 0:
        widest = max(float(cut(one.parameters)[0]) for one in weighed.maxima)
        return Interval95(0.0, 0.0, widest)
    (found,) = weighed.estimate(cut, log=False)
    return replace(found, low=max(0.0, found.low))


def _whole_height(weighed: _Weighed) -> Interval95:
    """Return the root mean square of all waves [m]."""
    likelihood = weighed.likelihood
    scale = likelihood.bins.sample.scale

    def height(at: FloatArray) -> FloatArray:
        return scale * np.sqrt(ring_moments(likelihood.model(at), 0.0, np.pi)[:1])

    return weighed.estimate(height)[0]


def _moments(weighed: _Weighed) -> RoughnessMoments | None:
    """Return the moments within the wavelengths that show the surface."""
    likelihood = weighed.likelihood
    sample = likelihood.bins.sample
    model = likelihood.model(weighed.maxima[0].parameters)
    short, long = shortest_map_wave(sample, model), longest_map_wave(sample)
    if not long > 2 * short:
        return None
    ends = 2 * np.pi / long, 2 * np.pi / short
    parts = weighed.estimate(
        lambda at: np.sqrt(ring_moments(likelihood.model(at), *ends))
    )
    return in_metres(sample.pitch, sample.scale, (short, long), parts, modelled=True)


def _lay(weighed: _Weighed, *, saturated: bool) -> SurfaceLay:
    """Return direction, ratio, exponents and roll-offs of a lay."""
    likelihood, pitch = weighed.likelihood, weighed.likelihood.bins.sample.pitch
    best = float(weighed.maxima[0].parameters[ANGLE])
    centre = (best + np.pi / 2) % np.pi - np.pi / 2

    def angle(at: FloatArray) -> FloatArray:
        # Models that are compared may differ by half a turn.
        apart = (at[ANGLE] - best + np.pi / 2) % np.pi - np.pi / 2
        return np.array([centre + apart])

    def exponents(at: FloatArray) -> FloatArray:
        return np.array(likelihood.model(at).exponents)

    def roll_offs(at: FloatArray) -> FloatArray:
        return pitch * np.array(likelihood.model(at).roll_offs)

    along, across = weighed.estimate(exponents, log=False)
    far: list[Interval95 | None] = [None, None]
    if saturated:
        far = list(weighed.estimate(roll_offs))
    return SurfaceLay(
        angle=weighed.estimate(angle, log=False)[0],
        ratio=weighed.estimate(lambda at: np.exp(at[RATIO]))[0],
        hurst_along=along,
        hurst_across=across,
        roll_off_along=far[0],
        roll_off_across=far[1],
    )


def _tip(models: MapModels) -> float:
    """Return how far the blur that the heights show is from the stated tip's [sd]."""
    likelihood = models.likelihood
    bare = MapLikelihood(likelihood.bins, likelihood.tolerance, heeds_tip=False)
    free = maximise_map(bare, models.best.parameters, models.best.free)
    return tip_deviation(bare.tip_surprise, free.parameters, _covariance(free))


def _beyond(models: MapModels) -> float:
    """Return the shortest roll-off that the heights do not exclude [samples].

    By the likelihood, or by its curvature where the roll-off is clear.
    """
    likelihood = models.likelihood
    if models.ratio > _CLEAR:
        spread = float(_covariance(models.best)[ROLL_OFF, ROLL_OFF])
        low = float(models.best.parameters[ROLL_OFF])
        return float(np.exp(low - np.sqrt(BEYOND_RATIO * spread)))
    if not models.lay:
        likelihood = in_sectors(likelihood, FEW)
    top = max(models.best, models.endless[0], key=lambda one: one.value)
    top = refitted(likelihood, top)
    held = top.free.copy()
    held[ROLL_OFF] = False
    start = top.parameters.copy()

    def lost(log_roll_off: float) -> float:
        start[ROLL_OFF] = log_roll_off
        found = maximise_map(likelihood, start, held)
        start[:] = found.parameters
        return 2 * (top.value - found.value) - BEYOND_RATIO

    high = float(top.parameters[ROLL_OFF])
    floor = float(likelihood.bounds[0][ROLL_OFF])
    spread = models.best.information[ROLL_OFF, ROLL_OFF]
    step = float(np.clip(2 / np.sqrt(max(spread, 1e-6)), 0.05, 0.7))
    low = high
    while low > floor:
        low = max(floor, low - step)
        if lost(low) > 0:
            return float(np.exp(brentq(lost, low, high, xtol=0.1 * step)))
        high, step = low, 1.5 * step
    return float(np.exp(floor))


def _reason(models: MapModels, beyond: float) -> str:
    sample, ratio = models.likelihood.bins.sample, models.ratio
    rows, columns = sample.shape
    if ratio > SATURATED_RATIO:
        words = f"the spectrum is level at long waves: chi2 falls by {ratio:.1f}"
    else:
        words = (
            f"no roll-off below {1e6 * beyond * sample.pitch:.3g} um (95 %) in "
            f"{1e6 * sample.length * sample.pitch:.4g} um; with one chi2 falls by "
            f"{ratio:.1f}, less than {SATURATED_RATIO:g}"
        )
    if models.likelihood.tolerance > 0:
        share = models.likelihood.tolerance
        words += f"; ln density within {share:.2f} of the model"
    return f"{words}; {rows} x {columns} points"
