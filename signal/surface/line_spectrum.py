# SPDX-License-Identifier: MIT
"""Power spectral density of heights along a line, in narrow bins of frequency."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.surface.complete_lines import WHOLE_TAPER, complete_lines

BIN_RATIO = 1.05
"""Ratio of the edges of a bin [-]."""
FIRST_ORDINATE = 2
"""Lowest ordinate; levelling takes most of the first."""


@dataclass(frozen=True, slots=True, eq=False)
class LineSpectrum:
    """Mean periodogram of the heights of one or many lines of equal length.

    Attributes:
        frequency: 1 over the wavelength [1/m], shape (n_bins,), ascending.
        density: one-sided; its integral over frequency is the variance [m^3], same
            shape.
        count: independent ordinates in each mean [-], same shape.
    """

    frequency: FloatArray
    density: FloatArray
    count: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("density", self.density, self.frequency.shape)
        require_shape("count", self.count, self.frequency.shape)
        freeze(self, "frequency", "density", "count")


def line_spectrum(surface: Surface) -> LineSpectrum | None:
    """Return the spectrum along a profile, or along the rows of a map.

    Args:
        surface: a profile or a map. Gaps of up to three points are interpolated where
            they are no more than 2 % of a line; otherwise the longest runs count.

    Returns:
        The spectrum, or None where no run without a gap has 64 points.
    """
    heights = np.atleast_2d(surface.heights)
    valid = np.atleast_2d(surface.valid)
    spacing = surface.spacing
    pitch = spacing if isinstance(spacing, float) else spacing[1]
    lines, taper = complete_lines(heights, valid)
    if lines.shape[0] == 0:
        return None
    related = taper == WHOLE_TAPER and lines.shape[0] == heights.shape[0]
    return spectrum_of_lines(lines, pitch, taper=taper, related=related)


def spectrum_of_lines(
    lines: FloatArray, pitch: float, *, taper: float, related: bool
) -> LineSpectrum:
    """Return the mean spectrum of complete lines.

    Args:
        lines: heights [m], shape (n_lines, n_points).
        pitch: spacing of the points [m].
        taper: share that is tapered at each end [-].
        related: lines are neighbours on a map, so that their coherence lowers the
            number of independent ordinates.
    """
    points = lines.shape[1]
    window = fade(points, taper)
    squares = window**2
    waves = scipy.fft.rfft(without_line(lines) * window, axis=1)
    waves = waves[:, FIRST_ORDINATE : (points - 1) // 2 + 1]
    index = np.arange(FIRST_ORDINATE, FIRST_ORDINATE + waves.shape[1])
    starts, sizes = bins_of(index)
    power = np.mean(np.abs(waves) ** 2, axis=0) * 2 * pitch / squares.sum()
    # The taper correlates neighbouring ordinates.
    independent = squares.sum() ** 2 / (squares.size * np.sum(squares**2))
    number = _independent_lines(waves, starts) if related else float(lines.shape[0])
    middle = np.exp(np.add.reduceat(np.log(index), starts) / sizes)
    return LineSpectrum(
        frequency=middle / (points * pitch),
        density=np.add.reduceat(power, starts) / sizes,
        count=np.maximum(1.0, sizes * independent) * number,
    )


def bins_of(index: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the first ordinate of each bin, and how many each has."""
    label = np.floor(np.log(index) / np.log(BIN_RATIO)).astype(np.int64)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(label)) + 1])
    return starts, np.diff(np.append(starts, index.size)).astype(np.float64)


def without_line(lines: FloatArray) -> FloatArray:
    """Return lines of heights without the least-squares line of each."""
    place = np.linspace(-1, 1, lines.shape[1])
    slope = lines @ place / (place @ place)
    level: FloatArray = lines - lines.mean(axis=1)[:, None] - np.outer(slope, place)
    return level


def fade(points: int, share: float) -> FloatArray:
    """Return a window of 1 with a raised cosine over a share at each end."""
    window = np.ones(points)
    edge = int(share * points)
    rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
    window[:edge] = rise
    window[points - edge :] = rise[::-1]
    return window


def _independent_lines(waves: ComplexArray, starts: IntArray) -> FloatArray:
    """Return how many independent lines a map has in each bin.

    The variance of a mean over related lines is larger by 1 + 2 sum (1 - r/n) c_r^2,
    with c_r the coherence of lines r apart, taken here at distances that widen.
    """
    lines = waves.shape[0]
    power = np.add.reduceat(np.mean(np.abs(waves) ** 2, axis=0), starts)
    power = np.maximum(power, np.finfo(np.float64).tiny)  # of a flat map
    widths = np.diff(np.append(starts, waves.shape[1]))
    total = np.zeros(starts.size)
    apart = np.unique(np.geomspace(1, max(1, lines - 1), 16).astype(np.int64))
    apart = apart[apart < lines]
    edges = np.append(apart, lines)
    for k, distance in enumerate(apart):
        cross = np.mean(waves[distance:] * np.conj(waves[:-distance]), axis=0)
        square = (np.abs(np.add.reduceat(cross, starts)) / power) ** 2
        chance = 1 / ((lines - distance) * widths)
        distances = np.arange(edges[k], edges[k + 1])
        total += (square - chance) * np.sum(1 - distances / lines)
    independent: FloatArray = lines / (1 + 2 * np.maximum(total, 0))
    return np.maximum(independent, 1.0)
