# SPDX-License-Identifier: MIT
"""White noise of measured heights, from the end of their spectrum."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.surface.complete_lines import complete_lines
from jointbench.signal.surface.levelling import level

FIRST_SHARE = 0.6
"""Share of the highest frequency from which the spectrum may be noise alone [-]."""
_BANDS = 4
_FEWEST_ORDINATES = 50
"""Least ordinates in a band, so that the least of four is not low by chance [-]."""
_MOST_LINES = 64


def height_noise(surface: Surface) -> float | None:
    """Return the standard deviation of white noise in the heights [m].

    It is the least density in four bands at the end of the spectrum along the lines:
    an upper limit where the surface itself has waves of two to three samples.

    Args:
        surface: as measured, before any filter.

    Returns:
        None where the file states an S-filter (which removes these frequencies), or
        where no line is long enough for a spectrum.
    """
    if surface.instrument.cutoff_short is not None:
        return None
    flat = level(surface)
    heights, valid = flat.heights, flat.valid
    if isinstance(flat, Profile):
        heights, valid = heights[None, :], valid[None, :]
    every = max(1, heights.shape[0] // _MOST_LINES)
    lines, _ = complete_lines(heights[::every], valid[::every])
    if not lines.size:
        return None
    return float(np.sqrt(_least_variance(lines)))


def _least_variance(lines: FloatArray) -> float:
    """Return the least density of four bands as variance of a white sequence [m^2]."""
    points = lines.shape[1]
    taper = np.hanning(points + 2)[1:-1]
    spectrum = np.fft.rfft(lines * taper, axis=1)
    power = (np.abs(spectrum) ** 2).mean(axis=0) / float(np.sum(taper**2))
    end = power[int(FIRST_SHARE * power.size) : -1]
    count = min(_BANDS, max(1, end.size * lines.shape[0] // _FEWEST_ORDINATES))
    return min(float(band.mean()) for band in np.array_split(end, count))
