# SPDX-License-Identifier: MIT
"""Marks that repeat, taken out of a profile as the mean of one period."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.periodic_marks import periodic_marks

_MOST_TEETH = 5
_FEWEST_WAVES = 5.0
_STAGES = ((0.3, 6), (0.05, 12), (0.008, 30), (0.001, 80), (0.0002, 80))
"""Half width of a search over waves per line [-], and harmonics in it: many fix the
wavelength precisely, few find it."""
_TRIALS = 9
_GAIN = 0.01
"""Least share of the power by which more teeth must explain more [-]."""

_ALIASES, _MOST_TAKEN = 6.0, 0.15
"""Times half the sampling up to which harmonics are fitted, and largest share of all
waves that they take [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class RepeatedMarks:
    """What repeats along a profile, and the profile without it.

    Attributes:
        rest: the surface without the marks, levelled.
        wavelength: of the longest period [samples].
        waves: harmonics that were fitted [-].
        power: mean square of the marks [m^2].
        chance: mean square that as many harmonics have on the rest alone [m^2].
    """

    rest: Surface
    wavelength: float
    waves: int
    power: float
    chance: float


def repeated_marks(surface: Surface) -> RepeatedMarks | None:
    """Return the marks of a profile without gaps; None without any.

    Args:
        surface: as read.
    """
    if not isinstance(surface, Profile) or not surface.valid.all():
        return None
    found = periodic_marks(surface)
    if found is None:
        return None
    heights = level(surface).heights
    points = heights.size
    first = points * surface.spacing / found.wavelength
    # The strongest wave may be a harmonic of a cutter with several teeth.
    waves = [first / teeth for teeth in range(1, _MOST_TEETH + 1)]
    tried = [_refined(heights, one) for one in waves if one >= _FEWEST_WAVES]
    if not tried:
        return None
    wave, most = tried[0], _gain(heights, tried[0])
    for one in tried[1:]:
        gain = _gain(heights, one)
        if gain > (1 + _GAIN) * most:
            wave, most = one, gain
    # Sharp edges have harmonics beyond half the sampling, which alias.
    zones = min(_ALIASES, _MOST_TAKEN * wave)
    count = max(1, int(0.5 * zones * points / wave))
    marks = _harmonics(heights, wave, count)
    rest = heights - marks
    return RepeatedMarks(
        replace(surface, heights=rest),
        points / wave,
        count,
        float(np.mean(marks**2)),
        _neighbours(rest, wave, count),
    )


def _refined(heights: FloatArray, wave: float) -> float:
    """Return the waves per line at which harmonics explain most."""
    for reach, count in _STAGES:
        count = max(1, min(count, int(0.5 * heights.size / wave)))
        places = wave + np.linspace(-reach, reach, _TRIALS)
        power = [np.mean(_harmonics(heights, p, count) ** 2) for p in places]
        wave = float(places[int(np.argmax(power))])
    return wave


def _gain(heights: FloatArray, wave: float) -> float:
    """Return the power of marks beyond what as many harmonics have by chance."""
    count = max(1, min(_STAGES[-1][1], int(0.5 * heights.size / wave)))
    marks = _harmonics(heights, wave, count)
    chance = _neighbours(heights - marks, wave, count)
    return float(np.mean(marks**2)) - chance


def _harmonics(heights: FloatArray, wave: float, count: int) -> FloatArray:
    """Return the waves of a base wavenumber and its harmonics in a line.

    A window keeps the long waves of the surface out of them.
    """
    points = heights.size
    turn = np.exp(2j * np.pi * wave * np.arange(points) / points)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(points) + 0.5) / points)
    weight = 2 * window / window.sum()
    rest, carrier = heights.copy(), np.ones_like(turn)
    for _ in range(count):
        carrier = carrier * turn
        # One by one: aliases of high harmonics lie beside low ones.
        rest -= (np.vdot(carrier, weight * rest) * carrier).real
    return heights - rest


def _neighbours(rest: FloatArray, wave: float, count: int) -> float:
    """Return the power that as many harmonics between the marks have."""
    found = [
        float(np.mean(_harmonics(rest, wave * (1 + part / wave), count) ** 2))
        for part in (-2.5, -1.5, 1.5, 2.5)
    ]
    return float(np.mean(found))
