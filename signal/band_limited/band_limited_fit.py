# SPDX-License-Identifier: MIT
"""The band-limited self-affine surface: H, roll-off, short cut, heights and slopes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import brentq

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.band_limited.band_records import (
    BandLimitedFit,
    DrawnModels,
    Interval95,
    RollOffVerdict,
    RoughnessMoments,
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
from jointbench.signal.band_limited.likelihood_ends import height_ends, roll_off_ends
from jointbench.signal.band_limited.line_sample import LineSample, line_sample
from jointbench.signal.band_limited.map_fit import fit_map
from jointbench.signal.band_limited.roughness_moments import (
    cut_wavelength,
    longest_wave,
    measured_density,
    measured_moments,
    modelled_moments,
    spectral_moments,
)
from jointbench.signal.band_limited.scoring_search import Maximum, maximise
from jointbench.signal.band_limited.spectral_likelihood import SpectralLikelihood
from jointbench.signal.band_limited.tip_width import tip_deviation, tip_surprise
from jointbench.signal.band_limited.weighted_draws import WeightedDraws, draw

_STARTS = (0.02, 0.3)
"""Roll-offs over the length from which the search starts [-]."""
_SMALL = (0.3, 0.1)
"""Blur [samples^2] and noise [-] from which the search starts."""
_SURFACE = np.array([True, True, True, False, False])
"""Which parameters are the surface's."""


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """Fits with a roll-off and without one, each with and without blur and noise."""

    likelihood: SpectralLikelihood
    rolling: tuple[Maximum, ...]
    endless: tuple[Maximum, ...]

    @property
    def best(self) -> Maximum:
        return max(self.rolling, key=lambda one: one.criterion)

    @property
    def best_endless(self) -> Maximum:
        return max(self.endless, key=lambda one: one.criterion)

    @property
    def ratio(self) -> float:
        gain = self.best.criterion + 1 - self.best_endless.criterion
        return max(0.0, 2 * gain)

    @property
    def saturated(self) -> bool:
        return self.ratio > SATURATED_RATIO


@one_thread()
def fit_band_limited(surfaces: Sequence[Surface], *, degree: int = 1) -> BandLimitedFit:
    """Fit a band-limited self-affine surface to lines or to a map, see `fit_map`.

    The long waves of lines enter by the exact likelihood of means of blocks, others by
    Whittle's likelihood of the spectrum, with the filters of the instrument as stated.
    Blur and noise beyond them are fitted. A likelihood-ratio test decides whether the
    surface rolls off.

    Args:
        surfaces: one profile or map, or independent profiles of one surface.
        degree: of the form that was removed; a line is always left out.

    Returns:
        The surface with intervals, or the moments of the measured spectrum and the
        reason why no self-affine band describes it.

    Raises:
        UsageError: lines shorter than 64 points, or several maps.
        SurfaceTooSmall: too few measured points.

    Source:
        Whittle, Ark. Mat. 2 (1953) 423. Roll-off: Self and Liang, J. Am. Stat. Assoc.
        82 (1987) 605, for a parameter at the end of its range.
    """
    first = surfaces[0]
    if len(surfaces) == 1 and isinstance(first, Areal):
        mapped = fit_map(first, degree=max(1, degree))
        if mapped is not None:
            return mapped
    return fit_lines(surfaces, degree=degree)


@one_thread()
def fit_lines(surfaces: Sequence[Surface], *, degree: int = 1) -> BandLimitedFit:
    """Fit the lines of profiles or of a map, with draws or the measured density.

    Args:
        surfaces: one profile or map, or independent profiles of one surface.
        degree: of the form that was removed; a line is always left out.

    Raises:
        UsageError: lines shorter than 64 points, or several maps.
        SurfaceTooSmall: too few measured points.
    """
    sample = line_sample(surfaces, degree=max(1, degree))
    found = _both(SpectralLikelihood(sample))
    excess = _excess(found)
    if excess > 0:
        found = _tolerated(sample, found)
    if found.likelihood.tolerance > WIDEST_TOLERANCE:
        share = 100 * found.likelihood.tolerance
        return _no_band(found, f"{OTHER_FORM} by {share:.0f} %")
    fit = _described(found)
    if fit.hurst is not None and fit.hurst.value <= LEAST_HURST:
        return _no_band(found, "the spectrum is level at all wavelengths")
    return fit


def _both(likelihood: SpectralLikelihood, near: FloatArray | None = None) -> _Found:
    """Return the maxima with and without a roll-off."""
    starts = [near] if near is not None else _starts(likelihood)
    rolling = _models(likelihood, starts, np.array([True, True, True]))
    end = max(rolling, key=lambda one: one.criterion).parameters.copy()
    end[2] = likelihood.bounds[2][1]
    endless = _models(likelihood, [end], np.array([True, True, False]))
    return _Found(likelihood, rolling, endless)


def _models(
    likelihood: SpectralLikelihood, starts: list[FloatArray], free: BoolArray
) -> tuple[Maximum, ...]:
    """Return the maxima without blur and noise, with either, and with both.

    A blur or noise whose likeliest value is nothing counts as well: it may still be
    there, and draws without it would leave its effect on curvature and H out.
    """
    found: list[Maximum] = []
    # A stated tip acts on every trace.
    tip = likelihood.sample.transfer.tip is not None
    for blur, noise in product((True,) if tip else (False, True), (False, True)):
        mask = np.concatenate([free, [blur, noise]])
        tried = [
            maximise(likelihood, np.where(mask | _SURFACE, start, 0.0), mask)
            for start in starts
        ]
        best = max(tried, key=lambda one: one.value)
        if not found:
            starts = [np.append(best.parameters[:3], _SMALL)]
        found.append(best)
    return tuple(found)


def _starts(likelihood: SpectralLikelihood) -> list[FloatArray]:
    sample = likelihood.sample
    level = float(
        np.interp(np.log(likelihood.pivot), np.log(sample.omega), np.log(sample.power))
    )
    long = [float(np.log(share * sample.points)) for share in _STARTS]
    return [np.array([level, 0.6, one, *_SMALL]) for one in long]


def _excess(found: _Found) -> float:
    """Return by how much the deviance exceeds that of a right model, if it does."""
    deviance, _ = found.likelihood.deviance(found.best.parameters)
    mean, sd = expected_deviance(found.likelihood.counts)
    return deviance - mean if deviance > mean + REJECTED * sd else 0.0


def _tolerated(sample: LineSample, found: _Found) -> _Found:
    """Return the fits with the least tolerance that makes the deviance an ordinary one.

    Each tolerance is fitted from the last one.
    """
    low, high = 0.0, 0.02
    while high <= 2 * WIDEST_TOLERANCE:
        found = _both(SpectralLikelihood(sample, high), found.best.parameters)
        if _surplus(found) <= 0:
            break
        low, high = high, 2 * high
    for _ in range(3):
        middle = 0.5 * (low + high)
        trial = _both(SpectralLikelihood(sample, middle), found.best.parameters)
        if _surplus(trial) > 0:
            low = middle
        else:
            high, found = middle, trial
    return found


def _surplus(found: _Found) -> float:
    deviance, _ = found.likelihood.deviance(found.best.parameters)
    return deviance - expected_deviance(found.likelihood.counts)[0]


def _no_band(found: _Found, reason: str) -> BandLimitedFit:
    """Return the moments of the measured spectrum and the reason for no more."""
    sample = found.likelihood.sample
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
        moments=measured_moments(sample),
        tolerance=found.likelihood.tolerance,
        model=None,
        pitch=sample.pitch,
        scale=sample.scale,
        density=measured_density(sample),
    )


def _described(found: _Found) -> BandLimitedFit:
    """Return the accepted fit with intervals."""
    likelihood, sample = found.likelihood, found.likelihood.sample
    saturated = found.saturated
    # Where the trace does not decide, both kinds have the weight they deserve.
    kinds = found.rolling if saturated else (*found.rolling, *found.endless)
    best = found.best.parameters
    draws = draw(likelihood, kinds)
    model = likelihood.model(best)
    beyond = min(_beyond(found), longest_wave(sample))
    verdict = RollOffVerdict.SATURATED
    if not saturated:
        whole = beyond >= float(sample.points)
        verdict = RollOffVerdict.FRACTAL if whole else RollOffVerdict.UNDECIDED
    cut = draws.estimate(
        sample.pitch * cut_wavelength(draws.parameters[:, 3]),
        float(sample.pitch * cut_wavelength(best[3:4])[0]),
    )
    return BandLimitedFit(
        verdict=verdict,
        reason=_reason(found, beyond),
        hurst=draws.estimate(draws.parameters[:, 1], float(best[1])),
        roll_off=_roll_off(found, draws) if saturated else None,
        roll_off_beyond=beyond * sample.pitch,
        height=_whole_height(likelihood, draws, best) if saturated else None,
        short_cut=cut if best[3] > 0 else replace(cut, low=0.0),
        tip_deviation=None if sample.transfer.tip is None else _tip(found),
        noise=sample.scale * float(np.sqrt(model.noise)),
        moments=_moments(found, draws),
        tolerance=likelihood.tolerance,
        model=model,
        pitch=sample.pitch,
        scale=sample.scale,
        draws=DrawnModels(
            tuple(likelihood.model(one) for one in draws.parameters),
            tuple(float(one) for one in draws.weight),
        ),
    )


def _roll_off(found: _Found, draws: WeightedDraws) -> Interval95:
    pitch, best = found.likelihood.sample.pitch, found.best
    values = pitch * np.exp(draws.parameters[:, 2])
    drawn = draws.estimate(values, float(pitch * np.exp(best.parameters[2])))
    return roll_off_ends(found.likelihood, best, drawn)


def _moments(found: _Found, draws: WeightedDraws) -> RoughnessMoments | None:
    likelihood, best = found.likelihood, found.best
    drawn = modelled_moments(likelihood, draws, best.parameters)
    if drawn is None:
        return None
    pitch = likelihood.sample.pitch
    waves = (drawn.shortest / pitch, drawn.longest / pitch)
    return replace(drawn, height=height_ends(likelihood, best, waves, drawn.height))


def _whole_height(
    likelihood: SpectralLikelihood, draws: WeightedDraws, best: FloatArray
) -> Interval95:
    """Return the root mean square of all waves [m]."""
    models = [likelihood.model(one) for one in (best, *draws.parameters)]
    total = spectral_moments(models, 0.0, np.pi)[:, 0]
    value, *drawn = likelihood.sample.scale * np.sqrt(total)
    return draws.estimate(np.array(drawn), float(value))


def _tip(found: _Found) -> float:
    """Return how far the blur that the heights show is from the stated tip's [sd]."""
    bare = replace(found.likelihood, heeds_tip=False)
    mask = np.diag(found.best.information) > 0
    free = maximise(bare, found.best.parameters, mask)
    covariance = np.zeros_like(free.information)
    part = free.information[np.ix_(mask, mask)]
    covariance[np.ix_(mask, mask)] = np.linalg.pinv(part, hermitian=True)

    def surprise(at: FloatArray) -> float:
        return tip_surprise(bare.model(at), bare.sample)

    return tip_deviation(surprise, free.parameters, covariance)


def _beyond(found: _Found) -> float:
    """Return the shortest roll-off that the heights do not exclude [samples]."""
    likelihood = found.likelihood
    top = max(found.best, found.best_endless, key=lambda one: one.value)
    held = np.diag(top.information) > 0
    held[2] = False
    start = top.parameters.copy()

    def lost(log_roll_off: float) -> float:
        at = start.copy()
        at[2] = log_roll_off
        value = maximise(likelihood, at, held).value
        return 2 * (top.value - value) - BEYOND_RATIO

    high = float(top.parameters[2])
    low = high
    floor = likelihood.bounds[2][0]
    while low > floor:
        low = max(floor, low - 0.7)
        if lost(low) > 0:
            return float(np.exp(brentq(lost, low, high, xtol=0.03)))
        high = low
    return float(np.exp(floor))


def _reason(found: _Found, beyond: float) -> str:
    sample, ratio = found.likelihood.sample, found.ratio
    length = 1e6 * sample.length
    if found.saturated:
        words = f"the spectrum is level at long waves: chi2 falls by {ratio:.1f}"
    else:
        words = (
            f"no roll-off below {1e6 * beyond * sample.pitch:.3g} um (95 %) in "
            f"{length:.4g} um; with one chi2 falls by {ratio:.1f}, less than "
            f"{SATURATED_RATIO:g}"
        )
    if found.likelihood.tolerance > 0:
        words += f"; ln density within {found.likelihood.tolerance:.2f} of the model"
    return words
