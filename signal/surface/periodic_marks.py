# SPDX-License-Identifier: MIT
"""Marks that repeat along a line: feed marks of turning, steps of a milling cutter."""

from dataclasses import dataclass

import numpy as np
import scipy.fft
from scipy.special import gammaincinv

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.surface.complete_lines import complete_lines
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import fade, without_line

_CHANCE = 1e-3
"""Probability that any ordinate of a surface without marks is called one [-]."""
_FEWEST_WAVES = 6
"""Least repetitions along a line [-]: fewer are waviness."""
_NEIGHBOURS = 12
"""Ordinates to each side that give the spectrum without the mark [-]."""
_UNSURE = 1.6
"""Factor on the limit for the scatter of a median of so many ordinates [-]."""
_LEAST_SHARE = 0.02
"""Least share of the variance of a line in a mark [-]."""
_MOST_LINES = 512
"""Lines of a map that are searched [-]; marks are on all of them."""
_OWN = 2
"""Ordinates to each side that the window fills with a mark [-]."""


@dataclass(frozen=True, slots=True)
class PeriodicMarks:
    """The strongest mark that repeats.

    Attributes:
        wavelength: [m].
        share: of the variance of the levelled heights, its harmonics included [-].
        along: ``"rows"`` or ``"columns"`` of a map, ``""`` of a profile.
    """

    wavelength: float
    share: float
    along: str


def periodic_marks(surface: Surface) -> PeriodicMarks | None:
    """Return the strongest mark that repeats along lines, None without one.

    Args:
        surface: a profile, or a map, searched along its rows and its columns.

    Source:
        Fisher, Proc. R. Soc. Lond. A 125 (1929) 54: the largest of many ordinates;
        here over the median of its neighbours, so that the spectrum may slope.
    """
    flat = level(surface)
    spacing = flat.spacing
    if isinstance(spacing, float):
        return _along(flat.heights[None, :], flat.valid[None, :], spacing, "")
    found = [
        _along(flat.heights, flat.valid, spacing[1], "rows"),
        _along(flat.heights.T, flat.valid.T, spacing[0], "columns"),
    ]
    known = [one for one in found if one is not None]
    return max(known, key=lambda one: one.share, default=None)


def _along(
    heights: FloatArray, valid: BoolArray, pitch: float, name: str
) -> PeriodicMarks | None:
    step = -(-heights.shape[0] // _MOST_LINES)
    lines, _ = complete_lines(heights[::step], valid[::step])
    if lines.size == 0:
        return None
    points = lines.shape[1]
    window = fade(points, 0.5)
    waves = scipy.fft.rfft(without_line(lines) * window, axis=1)
    power = np.mean(np.abs(waves) ** 2, axis=0)
    index = np.arange(_FEWEST_WAVES, power.size - _NEIGHBOURS)
    if index.size < 4 * _NEIGHBOURS:
        return None
    # Whitened: a median over a slope is no middle of it.
    flat = power * np.arange(power.size) ** 2.0
    around = [k for k in range(-_NEIGHBOURS, _NEIGHBOURS + 1) if abs(k) > _OWN]
    places = np.abs(index[:, None] + np.array(around))
    middle = np.median(flat[np.maximum(places, 1)], axis=1) / np.log(2)
    excess = flat[index] / np.maximum(middle, np.finfo(np.float64).tiny)
    # Rows of a map are not independent: one line is the safe number.
    limit = _UNSURE * float(gammaincinv(1.0, 1 - _CHANCE / index.size))
    clear = index[excess > limit]
    if clear.size == 0:
        return None
    total = float(power[1:].sum())
    first = int(clear[np.argmax(power[clear])])
    share = _share_of(power, first) / total
    if share < _LEAST_SHARE:
        return None
    return PeriodicMarks(points * pitch / _refined(power, first), share, name)


def _share_of(power: FloatArray, first: int) -> float:
    """Return the power of a mark and its harmonics."""
    found = 0.0
    for place in range(first, power.size - _OWN, first):
        found += float(power[place - _OWN : place + _OWN + 1].sum())
    return found


def _refined(power: FloatArray, first: int) -> float:
    """Return the place of a peak between ordinates by the logarithms of three."""
    low, middle, high = np.log(power[first - 1 : first + 2])
    bend = low - 2 * middle + high
    return float(first + (0.5 * (low - high) / bend if bend < 0 else 0.0))
