# SPDX-License-Identifier: MIT
"""Spatial parameters of maps: autocorrelation length, aspect ratio, lay."""

from dataclasses import dataclass

import numpy as np
import scipy.fft
import scipy.ndimage

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray

DECAY = 0.2
"""Value to which the autocorrelation decays [-] (ISO 25178-3:2012, 4.3)."""
_FIRST_LAG = 0.125
"""Share of each side up to which lags are looked at first [-]."""
_MOST_LAG = 0.5
_LEAST_OVERLAP = 0.1
"""Share of pairs of points below which a lag has no autocorrelation [-]."""
_ANGLES = 360
_FINE_ANGLES = 41
"""Rays in half a turn, and between the neighbours of the extreme one."""
_MARGIN = 4
"""Points around the central lobe that its interpolation takes."""
_RADIAL_STEPS = 4
"""Steps along a ray for each sample."""
_DIRECTION_BINS = 360
_LOBE = 2.5
"""Half width of a line of the tapered spectrum, over the distance of its lines [-]."""


@dataclass(frozen=True, slots=True)
class DecayLengths:
    """Where the autocorrelation decays to 0.2.

    Attributes:
        shortest: Sal [m]; None where it decays in no direction.
        longest: [m]; None where it does not decay in some direction.
    """

    shortest: float | None
    longest: float | None

    @property
    def aspect_ratio(self) -> float | None:
        """Str [-]; None where one length is not known."""
        if self.shortest is None or self.longest is None:
            return None
        return self.shortest / self.longest


def decay_lengths(
    heights: FloatArray, valid: BoolArray, spacing: tuple[float, float]
) -> DecayLengths:
    """Return the shortest and longest decay of the autocorrelation.

    Args:
        heights: about the reference plane, 0 where missing [m], (rows, columns).
        valid: False where a point is missing, same shape.
        spacing: along (rows, columns) [m].

    Source:
        ISO 25178-2:2021, 4.4: each lag is normalised by the pairs of measured points.
    """
    found = DecayLengths(None, None)
    if not heights.any():
        return found
    for share in (_FIRST_LAG, _MOST_LAG):
        most = [max(2, int(share * n)) for n in heights.shape]
        found = _decay(autocorrelation(heights, valid, (most[0], most[1])), spacing)
        if found.longest is not None:
            break
    return found


def autocorrelation(
    heights: FloatArray, valid: BoolArray, most: tuple[int, int]
) -> FloatArray:
    """Return the autocorrelation at lags up to `most` samples, (2 a + 1, 2 b + 1)."""
    shape = tuple(
        scipy.fft.next_fast_len(n + m, real=True)
        for n, m in zip(heights.shape, most, strict=True)
    )
    sums = _correlation(np.where(valid, heights, 0.0), shape, most)
    if valid.all():
        pairs = np.multiply.outer(
            *(
                n - np.abs(np.arange(-m, m + 1))
                for n, m in zip(heights.shape, most, strict=True)
            )
        ).astype(np.float64)
    else:
        pairs = np.round(_correlation(valid.astype(np.float64), shape, most))
    enough = pairs > _LEAST_OVERLAP * heights.size
    found = np.where(enough, sums / np.maximum(pairs, 1.0), np.nan)
    normalised: FloatArray = found / found[most[0], most[1]]
    return normalised


def _correlation(
    values: FloatArray, shape: tuple[int, ...], most: tuple[int, int]
) -> FloatArray:
    spectrum = scipy.fft.rfft2(values, shape)
    power = spectrum.real**2 + spectrum.imag**2
    whole = scipy.fft.irfft2(power, shape)
    rows, columns = (np.arange(-m, m + 1) for m in most)
    lags: FloatArray = whole[np.ix_(rows, columns)]
    return lags


def _decay(found: FloatArray, spacing: tuple[float, float]) -> DecayLengths:
    """Return decay lengths from rays through the central lobe."""
    lobe, inside = _central_lobe(found)
    if lobe is None:
        return DecayLengths(None, None)
    coefficients = scipy.ndimage.spline_filter(lobe, order=3)
    angles = np.pi * np.arange(_ANGLES) / _ANGLES
    lengths = _ray_lengths(coefficients, spacing, angles)
    if np.isnan(lengths).all():
        return DecayLengths(None, None)
    finer = np.linspace(-1, 1, _FINE_ANGLES) * (np.pi / _ANGLES)
    near = angles[int(np.nanargmin(lengths))] + finer
    shortest = float(np.nanmin(_ray_lengths(coefficients, spacing, near)))
    if not inside or np.isnan(lengths).any():
        return DecayLengths(shortest, None)
    far = angles[int(np.argmax(lengths))] + finer
    return DecayLengths(
        shortest, float(np.nanmax(_ray_lengths(coefficients, spacing, far)))
    )


def _central_lobe(found: FloatArray) -> tuple[FloatArray | None, bool]:
    """Return the surroundings of the zero lag, and whether they hold all its lobe."""
    filled = np.nan_to_num(found, nan=1.0)
    labels, _ = scipy.ndimage.label(filled > DECAY)
    rows, columns = (n // 2 for n in found.shape)
    lobe = labels == labels[rows, columns]
    if lobe.all():
        return None, False
    reach = [
        int(np.abs(np.flatnonzero(lobe.any(axis=k)) - m).max())
        for k, m in ((1, rows), (0, columns))
    ]
    inside = reach[0] < rows and reach[1] < columns
    down, along = (
        min(r + _MARGIN, m) for r, m in zip(reach, (rows, columns), strict=True)
    )
    box = filled[rows - down : rows + down + 1, columns - along : columns + along + 1]
    return box, inside


def _ray_lengths(
    coefficients: FloatArray, spacing: tuple[float, float], angles: FloatArray
) -> FloatArray:
    """Return the first length at which each ray meets 0.2; NaN where none does [m]."""
    middle = [n // 2 for n in coefficients.shape]
    step = min(spacing) / _RADIAL_STEPS
    most = max(m * d for m, d in zip(middle, spacing, strict=True))
    length = step * np.arange(int(np.hypot(most, most) / step) + 1)
    rows = middle[0] + np.outer(np.sin(angles), length) / spacing[0]
    columns = middle[1] + np.outer(np.cos(angles), length) / spacing[1]
    values = scipy.ndimage.map_coordinates(
        coefficients, [rows, columns], order=3, prefilter=False, cval=1.0
    )
    below = values < DECAY
    first = below.argmax(axis=1)
    ray = np.arange(angles.size)
    before, after = values[ray, first - 1], values[ray, first]
    part = (before - DECAY) / np.where(before > after, before - after, 1.0)
    met: FloatArray = np.where(
        below.any(axis=1), length[first] - step * (1 - part), np.nan
    )
    return met


def lay_direction(
    heights: FloatArray, valid: BoolArray, spacing: tuple[float, float]
) -> float | None:
    """Return the direction of the lay, from the rows towards the columns [rad].

    The angular spectrum (amplitude summed along each direction) is largest across the
    lay; the direction of the lay is at right angles to it, in 0 to pi.

    Args:
        heights: about the reference plane, 0 where missing [m], (rows, columns).
        valid: False where a point is missing, same shape.
        spacing: along (rows, columns) [m].

    Returns:
        Std; None for a plane.

    Source:
        ISO 25178-2:2021, 4.7 (angular spectrum, texture direction).
    """
    taper = np.multiply.outer(*(np.hanning(n + 2)[1:-1] for n in heights.shape))
    spectrum = scipy.fft.rfft2(np.where(valid, heights, 0.0) * taper)
    power = spectrum.real**2 + spectrum.imag**2
    rows = np.asarray(np.fft.fftfreq(heights.shape[0], spacing[0]), np.float64)[:, None]
    columns = np.asarray(np.fft.rfftfreq(heights.shape[1], spacing[1]), np.float64)[
        None, :
    ]
    far = np.hypot(rows, columns)
    # The taper spreads the mean over two lines; directions are coarse there as well.
    line = 1 / min(n * d for n, d in zip(heights.shape, spacing, strict=True))
    low = 3 * line
    high = 0.5 / max(spacing)
    power[(far < low) | (far > high)] = 0.0
    if not power.any():
        return None
    power /= power.max()
    return _densest_direction(rows, columns, power, line)


def _densest_direction(
    rows: FloatArray, columns: FloatArray, power: FloatArray, line: float
) -> float:
    """Return the lay from the direction with the most power along it.

    The direction is the mean over the width of a line of the spectrum.
    """
    far = np.hypot(rows, columns)
    used = power > 0
    angle = np.arctan2(*np.broadcast_arrays(rows, columns))[used] % np.pi
    weight = (power * far)[used]
    bins = (angle * (_DIRECTION_BINS / np.pi)).astype(int) % _DIRECTION_BINS
    along = np.bincount(bins, weight, _DIRECTION_BINS)
    around = scipy.ndimage.uniform_filter1d(along, 3, mode="wrap")
    centre = (int(np.argmax(around)) + 0.5) * np.pi / _DIRECTION_BINS
    apart = (angle - centre + np.pi / 2) % np.pi - np.pi / 2
    # The three bins of the mean: the middle one may be empty.
    half = 1.5 * np.pi / _DIRECTION_BINS * (1 + 1e-9)
    top = np.abs(apart) <= half
    if not weight[top].any():  # one single spike: equal power in all directions
        return float((centre + np.pi / 2) % np.pi)
    radius = float(np.average(far[used][top], weights=weight[top]))
    near = np.abs(apart) <= max(half, _LOBE * line / radius)
    wave = centre + float(np.average(apart[near], weights=weight[near]))
    return float((wave + np.pi / 2) % np.pi)
