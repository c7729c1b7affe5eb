# SPDX-License-Identifier: MIT
"""What a surface is that one self-affine band does not describe."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.band_limited.band_records import BandLimitedFit, RollOffVerdict
from jointbench.signal.band_limited.gamma_deviance import expected_deviance
from jointbench.signal.band_limited.map_sample import map_sample, sectors_of
from jointbench.signal.band_limited.spectrum_sections import spectrum_sections
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.periodic_marks import PeriodicMarks, periodic_marks

_LEAST_GAIN = 12.0
"""Least fall of the deviance by a bend between two power laws [-]; of 60 saturated and
fractal lines without one it was at most 9."""
_WIDTH, _KNOTS = 0.6, 0.15
"""Width of the bend and distance of those that are tried, in ln wavelength [-]."""
_STEPS, _LONGEST, _SETTLED = 12, 2.0, 1e-4
"""Most steps of scoring, the longest one, and the one that ends it [-]."""
_LEAST_BEND = 0.5
"""Least change of the slope of the spectrum at a bend [-]: of H by a quarter."""
_SIDE = 2.5
"""Least ratio of wavelengths on each side of a bend [-]."""
_FLATTEST = 1.1
"""Flattest slope of the spectrum of a power law [-]: H = 0.05."""
_FEWEST = 10
"""Least bins of a spectrum [-]."""
_SKEWED = 0.8
"""Skewness of heights from which two processes shaped them [-]."""
_OF_SKEWNESS = 6.0
"""Variance of the skewness of Gaussian heights times their number [-]."""
_CLEAR = 4.0
"""Skewness over its scatter from which it is no chance [-]."""
_TURNS = 36
"""Most directions of the search for a second lay [-]."""
_RING, _RINGS = 0.3, 4
"""Width of a ring in ln wavenumber, and rings of an octave and a half [-]."""
_UNEVEN = 1.5
"""Least power of the first direction over the mean of all [-]."""
_SMOOTHED = float(np.sqrt(6) / 4)
"""Scatter of a profile of directions smoothed by 1, 2, 1 over that of each [-]."""
_NO_CHANCE = 5.0
"""Least rise of a second lay over its scatter [-]; many directions are looked at."""
_SECOND = 0.28
"""Least height of a second lay over the first, above the valley between [-]."""


@dataclass(frozen=True, slots=True)
class Bend:
    """Two power laws of one spectrum.

    Attributes:
        wavelength: at which they meet [m].
        hurst_short: H of shorter waves [-].
        hurst_long: H of longer waves [-].
    """

    wavelength: float
    hurst_short: float
    hurst_long: float


@dataclass(frozen=True, slots=True)
class SurfaceKinds:
    """What is found on a surface beside a self-affine band.

    Attributes:
        marks: that repeat; None without.
        bend: between two power laws; None without.
        directions: in which two sets of scratches run [rad]; empty without.
        skewness: of the levelled heights [-].
        two_processes: whether the heights are as skewed as two processes leave them.
    """

    marks: PeriodicMarks | None
    bend: Bend | None
    directions: tuple[float, ...]
    skewness: float
    two_processes: bool


def surface_kinds(surface: Surface, fit: BandLimitedFit | None) -> SurfaceKinds:
    """Return what is found on a surface beside a self-affine band.

    Args:
        surface: as it was fitted.
        fit: of it.
    """
    marks = periodic_marks(surface)
    directions = () if not isinstance(surface, Areal) else _two_directions(surface)
    bend = None
    if fit is not None and marks is None and not directions:
        bend = _bend(surface, fit)
    skewness, sure = _skewness(surface)
    return SurfaceKinds(marks, bend, directions, skewness, sure)


def not_one_band(fit: BandLimitedFit, said: str) -> BandLimitedFit:
    """Return a fit without H and roll-off where a surface has no single power law.

    A roll-off that was named stays: marks and crossing directions leave it.

    Args:
        fit: of the surface.
        said: what it is instead.
    """
    if fit.verdict in {RollOffVerdict.NO_BAND, RollOffVerdict.SATURATED}:
        return fit
    return replace(
        fit,
        verdict=RollOffVerdict.NO_BAND,
        reason=f"{said}; {fit.reason}",
        hurst=None,
        roll_off_beyond=None,
        short_cut=None,
    )


def _bend(surface: Surface, fit: BandLimitedFit) -> Bend | None:
    """Return two power laws that describe a spectrum where one does not."""
    sections = spectrum_sections(surface, fit)
    if len(sections) != 1 or fit.moments is None:
        return None
    one = sections[0]
    inside = (one.wavelength >= fit.moments.shortest) & (
        one.wavelength <= 0.5 * fit.moments.longest
    )
    if np.count_nonzero(inside) < _FEWEST:
        return None
    place = -np.log(one.wavelength[inside])
    count, power = one.count[inside], one.measured[inside]
    line = np.stack([np.ones_like(place), place - place.mean()])
    # Both laws must beat the fitted surface as well, roll-off and short cut included.
    other = _left(line, power, count)[0]
    if one.fitted is not None:
        other = min(other, _deviance(power / one.fitted[inside], count))
    usual = expected_deviance(count)[0]
    best, found = _LEAST_GAIN, None
    edge = np.log(_SIDE)
    extra = 2.0 if fit.mapped else 1.0
    low, high = place.min() + edge, place.max() - edge
    for knot in np.arange(low, high, _KNOTS):
        hinge = _WIDTH * np.logaddexp(0.0, (place - knot) / _WIDTH)
        left, at = _left(np.vstack([line, hinge]), power, count)
        slopes = -at[1], -(at[1] + at[2])
        # A level spectrum at long waves is a roll-off, a falling slope a short cut.
        possible = min(slopes) > _FLATTEST + extra - 1 and max(slopes) < extra + 2.2
        gain = (other - left) / max(1.0, left / usual)
        if possible and abs(at[2]) > _LEAST_BEND and gain > best:
            best = gain
            short, long = (0.5 * (s - extra) for s in (slopes[1], slopes[0]))
            found = Bend(float(np.exp(-knot)), float(short), float(long))
    return found


def _left(
    design: FloatArray, power: FloatArray, count: FloatArray
) -> tuple[float, FloatArray]:
    """Return the gamma deviance of the likeliest ln density, and its coefficients.

    Args:
        design: of ln density, shape (n_coefficients, n_bins).
        power: mean of the ordinates in each bin, shape (n_bins,).
        count: independent ordinates in each, same shape.

    Source:
        Method of scoring for gamma variables with a logarithmic link: McCullagh and
        Nelder, Generalized Linear Models (1989), 2.5 and 8.3.
    """
    weighted = design * count
    information = weighted @ design.T
    solved = np.linalg.solve(information, weighted @ np.log(power))
    at = np.asarray(solved, dtype=np.float64)
    for _ in range(_STEPS):
        step = np.linalg.solve(
            information, weighted @ (power / np.exp(at @ design) - 1)
        )
        at += np.clip(step, -_LONGEST, _LONGEST)
        if np.abs(step).max() < _SETTLED:
            break
    return _deviance(power / np.exp(at @ design), count), at


def _deviance(share: FloatArray, count: FloatArray) -> float:
    """Return the gamma deviance of ordinates over their expectation."""
    return float(np.sum(2 * count * (share - 1 - np.log(share))))


def _skewness(surface: Surface) -> tuple[float, bool]:
    """Return the skewness of levelled heights and whether it is that of two processes.

    As many heights are independent as lines cross their mean, of a map in both
    directions.
    """
    flat = level(surface)
    heights = flat.heights[flat.valid]
    sd = float(np.std(heights))
    if sd == 0:
        return 0.0, False
    skewness = float(np.mean(((heights - heights.mean()) / sd) ** 3))
    above = np.atleast_2d(flat.heights > 0)
    number = 1.0
    for lines in (above, above.T) if isinstance(surface, Areal) else (above,):
        number *= max(1.0, np.count_nonzero(np.diff(lines, axis=1)) / len(lines))
    scatter = float(np.sqrt(_OF_SKEWNESS / number))
    return skewness, abs(skewness) > max(_SKEWED, _CLEAR * scatter)


def _two_directions(areal: Areal) -> tuple[float, ...]:
    """Return two directions in which scratches run, none for one lay or none.

    They are looked for at all wavelengths together and in each octave and a half:
    scratches of some widths may cross where others of one direction hide it.
    """
    sample = map_sample(areal)
    if sample is None:
        return ()
    # Finer directions than the sample's sectors would leave every third one empty.
    turns = min(_TURNS, sectors_of(sample.shape))
    turn = np.arctan2(sample.down, sample.along) + np.pi / 2
    label = np.minimum((turn / np.pi * turns).astype(np.int64), turns - 1)
    ring = np.floor(np.log(np.hypot(sample.along, sample.down)) / _RING).astype(int)
    ring -= ring.min()
    # Power over the mean of its ring: each wavelength has one vote per ordinate.
    weight = sample.count
    mean = np.bincount(ring, weight * sample.power) / np.maximum(
        np.bincount(ring, weight), 1e-9
    )
    share = sample.power / mean[ring]
    starts = range(int(ring.max()) + 2 - _RINGS)
    parts = [ring >= 0, *((ring >= k) & (ring < k + _RINGS) for k in starts)]
    for part in parts:
        counted = np.bincount(label[part], weight[part], minlength=turns)
        number = np.asarray(counted, dtype=np.float64)
        total = np.bincount(label[part], (weight * share)[part], minlength=turns)
        if not number.all():
            continue
        found = _two_peaks(_smoothed(total / number), number)
        if found:
            return found
    return ()


def _smoothed(profile: FloatArray) -> FloatArray:
    smooth: FloatArray = (np.roll(profile, 1) + 2 * profile + np.roll(profile, -1)) / 4
    return smooth


def _two_peaks(profile: FloatArray, number: FloatArray) -> tuple[float, ...]:
    """Return the directions of two peaks with a valley between on both sides.

    Args:
        profile: mean power in each direction over that of all, shape (n_directions,).
        number: independent ordinates in each direction, same shape.
    """
    peaks = np.flatnonzero(
        (profile >= np.roll(profile, 1)) & (profile > np.roll(profile, -1))
    )
    order = peaks[np.argsort(-profile[peaks])]
    if order.size < 2:
        return ()
    first, second = int(order[0]), int(order[1])
    low, high = sorted((first, second))
    valleys = [
        profile[low : high + 1].min(),
        min(profile[high:].min(), profile[: low + 1].min()),
    ]
    rise = profile[second] - max(valleys)
    if rise < _SECOND * (profile[first] - max(valleys)) or profile[first] < _UNEVEN:
        return ()
    if rise < _NO_CHANCE * _SMOOTHED * profile[second] / np.sqrt(number[second]):
        return ()
    # Power is across a lay; sectors begin at -90 degrees.
    found = [(np.pi * (k + 0.5) / profile.size) for k in (low, high)]
    return tuple(sorted(float((a + np.pi / 2) % np.pi - np.pi / 2) for a in found))
