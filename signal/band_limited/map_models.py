# SPDX-License-Identifier: MIT
"""Models of a map that are compared: with and without lay, roll-off, blur and noise."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.band_limited.map_likelihood import (
    MOST_STEPS,
    MapLikelihood,
    MapMaximum,
    maximise_map,
)
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
from jointbench.signal.band_limited.seen_bins import seen_bins

LAY_RATIO = 16.3
"""Twice the gain in log-likelihood by a lay above which it is named: a level of 0.1 %
for three parameters [-]."""
FEW = 6
"""Sectors for surfaces without a lay [-]: images differ between them."""
_SOME_STEPS = 8
"""Most steps of models other than the best from few bins to all [-]: within 0.06 of
their maximum in log-likelihood."""
_FIRST_STEPS, _LAST_STEPS, _AS_GOOD = 5, 2, 0.5
"""Steps from each of several starts; steps in all bins where only the size of a gain is
wanted; and difference in log-likelihood of two starts after their steps that lead to
the same maximum [-]."""
_SOME = 12
"""Sectors for the search for a lay that moments hardly show [-]."""
_START_ROLL_OFFS = (0.03, 0.3)
"""Roll-offs over the length from which the search starts [-]."""
_SMALL = {BLUR: 0.3, NOISE: 0.1}
"""Blur [samples^2] and noise [-] from which the search starts."""
_FAR = 20.0
"""Largest logarithm of density between directions [-]."""
_TURNS = 4
"""Angles from which the search for a lay starts, besides the one by moments [-]."""
_CLEAR_START = 1.15
"""Ratio by moments above which its angle is a start of its own [-]."""
_LAY_SEEN = 5.0
"""Score of a lay below which none is searched [-]: seven in ten surfaces without one
have less, and a gain of `LAY_RATIO` by a lay leaves more."""
_CLEAR_ROLL_OFF = 20.0
"""Gain in log-likelihood by a roll-off that no blur or noise undoes [-]."""
_CLOSE = 8.0
"""Distance of Akaike's criterion within which a model has weight [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MapModels:
    """Maxima with a roll-off and without one, each with several blurs and noises.

    Attributes:
        likelihood: of the map.
        rolling: with a roll-off, the best first.
        endless: without one, the best first.
        lay: whether they have a lay.
    """

    likelihood: MapLikelihood
    rolling: tuple[MapMaximum, ...]
    endless: tuple[MapMaximum, ...]
    lay: bool

    @property
    def best(self) -> MapMaximum:
        """The best one with a roll-off."""
        return self.rolling[0]

    @property
    def density(self) -> FloatArray:
        """Spectrum of the best one with a roll-off in each bin."""
        return self.likelihood.density(self.best.parameters)

    @property
    def ratio(self) -> float:
        """Twice the gain in log-likelihood by a roll-off [-]."""
        gain = self.best.criterion + 1 - self.endless[0].criterion
        return max(0.0, 2 * gain)


def map_models(likelihood: MapLikelihood) -> MapModels:
    """Return the maxima of all models that the heights support."""
    free = np.zeros(8, dtype=np.bool_)
    free[[LEVEL, HURST, ROLL_OFF]] = True
    tip = likelihood.bins.sample.transfer.tip is not None
    free[BLUR] = tip
    # Few bins suffice to find the surface without a lay.
    few = in_sectors(likelihood, FEW)
    starts = [_start(few, share, tip=tip) for share in _START_ROLL_OFFS]
    tried = [maximise_map(few, one, free) for one in starts]
    plain = _sorted(_with_instrument(few, max(tried, key=_criterion), starts))
    best, *others = plain
    few_steps = [refitted(likelihood, one, most=_SOME_STEPS) for one in others]
    plain = _sorted([refitted(likelihood, best), *few_steps])
    turned = plain[0]
    if _lay_score(likelihood, plain[0]) > _LAY_SEEN:
        turned = _with_lay(likelihood, plain[0])
    if 2 * (turned.value - plain[0].value) <= LAY_RATIO:
        return MapModels(likelihood, plain, _endless(likelihood, plain), False)
    close = [one for one in plain[1:] if one.criterion > plain[0].criterion - _CLOSE]
    found = _sorted([turned, *(_turned_too(likelihood, m, turned) for m in close)])
    return MapModels(likelihood, found, _endless(likelihood, found), True)


def in_sectors(likelihood: MapLikelihood, sectors: int) -> MapLikelihood:
    """Return the likelihood of the same map in few sectors."""
    sample = likelihood.bins.sample.merged(sectors)
    return replace(likelihood, bins=seen_bins(sample, few=True))


def _turned_too(
    likelihood: MapLikelihood, plain: MapMaximum, turned: MapMaximum
) -> MapMaximum:
    """Return the lay of one model fitted with the blur and noise of another."""
    free = plain.free.copy()
    start = plain.parameters.copy()
    for k in (RATIO, ANGLE, SKEW):
        free[k], start[k] = True, turned.parameters[k]
    return maximise_map(likelihood, start, free)


def again(models: MapModels, tolerance: float) -> MapModels:
    """Return the maxima under another tolerance, each from the one before."""
    likelihood = replace(models.likelihood, tolerance=tolerance)
    rolling = [refitted(likelihood, one) for one in models.rolling]
    endless = [refitted(likelihood, one) for one in models.endless]
    return replace(
        models,
        likelihood=likelihood,
        rolling=_sorted(rolling),
        endless=_sorted(endless),
    )


def refitted(
    likelihood: MapLikelihood, one: MapMaximum, *, most: int = MOST_STEPS
) -> MapMaximum:
    """Return the maximum of another likelihood next to one, with what was free."""
    return maximise_map(likelihood, one.parameters, one.free, most=most)


def _criterion(one: MapMaximum) -> float:
    return one.criterion


def _sorted(found: list[MapMaximum]) -> tuple[MapMaximum, ...]:
    """Return the models that have weight, the best first."""
    ranked = sorted(found, key=_criterion, reverse=True)
    return tuple(m for m in ranked if ranked[0].criterion - m.criterion < _CLOSE)


def _start(likelihood: MapLikelihood, share: float, *, tip: bool) -> FloatArray:
    """Return parameters of a surface with a roll-off at a share of the length."""
    sample = likelihood.bins.sample
    at = np.zeros(8)
    at[HURST] = 0.6
    at[ROLL_OFF] = np.log(share * sample.length)
    at[BLUR] = _SMALL[BLUR] * tip
    # The level follows from the others.
    power, density = sample.power, likelihood.density(at)
    at[LEVEL] = np.log(np.average(power / density, weights=sample.count))
    return at


def _with_instrument(
    likelihood: MapLikelihood, plain: MapMaximum, starts: list[FloatArray]
) -> list[MapMaximum]:
    """Return a model, and the same with blur, noise and both where they are there.

    Both together start from each start as well: without them the best H of a blurred
    surface may be at the end of its range.
    """
    found = [plain]
    open_ = [k for k in (BLUR, NOISE) if not plain.free[k]]
    for kind in (open_, *([k] for k in open_ if len(open_) > 1)):
        free = plain.free.copy()
        free[kind] = True
        best = max(found, key=_criterion).parameters
        tried = []
        for at in [best, *starts] if kind is open_ else [best]:
            start = at.copy()
            for k in (BLUR, NOISE):
                start[k] = max(float(start[k]), _SMALL[k]) if free[k] else 0.0
            tried.append(start)
        one = _best_of(likelihood, tried, free)
        # A blur or noise of nothing is the model without it.
        if np.all(one.parameters[kind] > 0):
            found.append(one)
    return found


def _lay_score(likelihood: MapLikelihood, plain: MapMaximum) -> float:
    """Return the score statistic of a lay at the maximum without one [-].

    A lay adds a wave of half a turn to ln density, with a size that changes with ln
    wavenumber where lines along and across have two exponents: four parameters.

    Source:
        Rao, Proc. Camb. Phil. Soc. 44 (1948) 50.
    """
    sample, count = likelihood.bins.sample, likelihood.counts
    rest = sample.power / likelihood.density(plain.parameters) - 1
    turn = 2 * np.arctan2(sample.down, sample.along)
    far = 0.5 * np.log(np.square(sample.along) + np.square(sample.down))
    far -= float(count @ far) / float(count.sum())
    waves = np.array([np.cos(turn), np.sin(turn)])
    rates = np.concatenate([waves, far * waves])
    slope = rates @ (count * rest)
    return float(slope @ np.linalg.solve((rates * count) @ rates.T, slope))


def _with_lay(likelihood: MapLikelihood, plain: MapMaximum) -> MapMaximum:
    """Return the best fit with a lay, from several directions."""
    free = plain.free.copy()
    free[[RATIO, ANGLE]] = True
    starts = []
    for angle, wide in _lays(likelihood, plain):
        start = plain.parameters.copy()
        start[[RATIO, ANGLE]] = wide, angle
        starts.append(start)
    where = likelihood if len(starts) == 1 else in_sectors(likelihood, _SOME)
    found = _best_of(where, starts, free)
    if where is likelihood:
        found = max(plain, found, key=_value)
    free[SKEW] = True
    found = maximise_map(where, found.parameters, free)
    if where is likelihood:
        return found
    found = refitted(likelihood, found, most=_SOME_STEPS)
    # Half of what a lay needs is not doubled by further steps.
    if 2 * (found.value - plain.value) < 0.5 * LAY_RATIO:
        return found
    return refitted(likelihood, found)


def _best_of(
    likelihood: MapLikelihood, starts: list[FloatArray], free: BoolArray
) -> MapMaximum:
    """Return the best maximum from several starts, the most promising two in full.

    A second one that is as good as the first by then is on the way to the same.
    """
    if len(starts) > 1:
        begun = [maximise_map(likelihood, x, free, most=_FIRST_STEPS) for x in starts]
        begun.sort(key=_value, reverse=True)
        same = begun[0].value - begun[1].value < _AS_GOOD
        starts = [one.parameters for one in begun[: 1 if same else 2]]
    return max((maximise_map(likelihood, x, free) for x in starts), key=_value)


def _value(one: MapMaximum) -> float:
    return one.value


def _lays(likelihood: MapLikelihood, plain: MapMaximum) -> list[tuple[float, float]]:
    """Return starts of angle and ln ratio, by the second moments of ln density."""
    sample = likelihood.bins.sample
    count, power = likelihood.counts, sample.power
    share = power / likelihood.density(plain.parameters)
    turn = 2 * np.arctan2(sample.down, sample.along)
    rates = np.array([np.ones_like(turn), np.cos(turn), np.sin(turn)])
    steepness = 1 + float(plain.parameters[HURST])
    found = np.zeros(3)
    for _ in range(6):
        rest = share * np.exp(-np.clip(found @ rates, -_FAR, _FAR)) - 1
        step = np.linalg.solve((rates * count) @ rates.T, rates @ (count * rest))
        found += np.clip(step, -1, 1)
    # More power across the lay: ln density falls by the steepness times ln ratio.
    wide = min(float(np.hypot(found[1], found[2])) / steepness, 3.0)
    angle = 0.5 * float(np.arctan2(found[2], found[1])) + np.pi / 2
    first = (angle, wide)
    if np.exp(wide) > _CLEAR_START:
        return [first]
    return [first, *((k * np.pi / _TURNS, 0.3) for k in range(_TURNS))]


def _endless(
    likelihood: MapLikelihood, rolling: tuple[MapMaximum, ...]
) -> tuple[MapMaximum, ...]:
    """Return the same models without a roll-off; the best alone where it is clear."""
    found: list[MapMaximum] = []
    for one in rolling:
        start, free = one.parameters.copy(), one.free.copy()
        start[ROLL_OFF], free[ROLL_OFF] = likelihood.bounds[1][ROLL_OFF], False
        found.append(_without_roll_off(likelihood, one, start, free))
        if rolling[0].value - found[0].value > _CLEAR_ROLL_OFF:
            break
    return _sorted(found)


def _without_roll_off(
    likelihood: MapLikelihood, one: MapMaximum, start: FloatArray, free: BoolArray
) -> MapMaximum:
    """Return the maximum of a model without its roll-off.

    Args:
        likelihood: of the map.
        one: the maximum with a roll-off.
        start: its parameters with the farthest one.
        free: which of them are searched.
    """
    if one.value - likelihood(start) < _CLEAR_ROLL_OFF:
        return maximise_map(likelihood, start, free)
    # Far from the maximum the way is shorter with few bins.
    some = in_sectors(likelihood, _SOME)
    begun = maximise_map(some, start, free, most=_FIRST_STEPS)
    lost = some(one.parameters) - begun.value
    # Where a roll-off is clear it does not matter by how much.
    most = _LAST_STEPS if lost > 2 * _CLEAR_ROLL_OFF else MOST_STEPS
    return refitted(likelihood, begun, most=most)
