# SPDX-License-Identifier: MIT
"""Search the spectrum for a bend between two power laws."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.instrument_blur import tip_fall
from jointbench.signal.fractal.self_affine import SeenSurface
from jointbench.signal.surface.structure_constant import spectral_integral

_CLEAR_GAIN = 14.0
"""Gain of chi2 by a significant bend, the largest of all tried [-]; one clean profile
in 100 to 200 has it by chance."""
_SMALLEST_BEND = 0.25
"""Least change of slope of a bend [-]: a change of D by an eighth."""
_LONGEST_SHARE = 0.25
"""Longest lag of a bend over the longest of the fit [-]: beyond it the other law would
rest on a few ordinates."""
_KNOTS = 24
"""Frequencies tried [-]."""
_SHARPEST_BLUR = 1.0
"""Frequency times point spread above which the surface is not resolved [rad]."""
_HIGHEST = 0.5 * np.pi
"""Highest frequency of the test [rad/sample]: instruments dominate above it."""
_ALIASES = 20
"""Aliases of the spectrum on each side that are included [-]."""
_FEWEST_BINS = 12


@dataclass(frozen=True, slots=True)
class Kink:
    """A bend of the spectrum.

    Attributes:
        lag: at which S shows it, approximate [samples].
        slope_below: slope of ln S at shorter lags, approximate [-].
        slope_above: at longer lags, approximate [-].
        gain: of chi2 by it [-].
    """

    lag: float
    slope_below: float
    slope_above: float
    gain: float


def find_kink(
    problem: FractalProblem, seen: SeenSurface, clear: float = _CLEAR_GAIN
) -> Kink | None:
    """Return the most significant bend of a spectrum relative to a fit, if any.

    Args:
        problem: with a spectrum in its structure function; None is returned without
            one.
        seen: the fitted surface with one power law, and its instrument.
        clear: least gain of chi2 by a bend [-].

    Source:
        Whittle, Ark. Mat. 2 (1953) 423: ordinates over their expectation are
        independent and exponential. Their means enter by cube roots, see Wilson and
        Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684.
    """
    spectrum = problem.estimate.spectrum
    if spectrum is None or problem.lag.size == 0:
        return None
    keep = (spectrum.omega < _HIGHEST) & (
        spectrum.omega * seen.psf_width < _SHARPEST_BLUR
    )
    if np.count_nonzero(keep) < _FEWEST_BINS:
        return None
    omega, count = spectrum.omega[keep], spectrum.count[keep]
    share = spectrum.power[keep] / expected_spectrum(omega, seen)
    size = np.sqrt(count)
    gap = size * (3 * (np.cbrt(share) - 1) + 1 / (3 * count))
    line = np.stack([size, size * np.log(omega)], axis=1)
    best, found = clear, None
    straight = _left(line, gap)[0]
    for knot in _knots(problem, omega):
        hinge = size * np.maximum(0.0, np.log(omega / knot))
        left, bend = _left(np.column_stack([line, hinge]), gap)
        if straight - left > best and abs(bend[2]) > _SMALLEST_BEND:
            best = straight - left
            below = seen.exponent - float(bend[1] + bend[2])
            above = seen.exponent - float(bend[1])
            found = Kink(1 / knot, below, above, best)
    return found


def expected_spectrum(omega: FloatArray, seen: SeenSurface) -> FloatArray:
    """Return the spectrum of height differences of a measured surface.

    Args:
        omega: [rad/sample], between 0 and pi.
        seen: surface without corner, and instrument.
    """
    images = 0 if seen.band_limited else _ALIASES
    waves = omega[:, None] + 2 * np.pi * np.arange(-images, images + 1)
    power = np.abs(waves) ** (-1 - seen.exponent)
    if seen.psf_width > 0 and seen.traced:
        fall = tip_fall(seen.exponent)
        power *= (1 + (waves * seen.psf_width) ** 2 / fall) ** -fall
    elif seen.psf_width > 0:
        power *= np.exp(-((waves * seen.psf_width) ** 2))
    total = power.sum(axis=1)
    if images and seen.psf_width == 0:  # further aliases, as an integral
        rest = (2 * np.pi) ** (-1 - seen.exponent) * (images + 0.5) ** -seen.exponent
        total += 2 * rest / seen.exponent
    level = seen.amplitude / (4 * spectral_integral(seen.exponent))
    white = (seen.noise + seen.quantum**2 / 12) / (2 * np.pi)
    heights = level * total + white
    differences: FloatArray = 4 * np.sin(omega / 2) ** 2 * heights
    return differences


def _knots(problem: FractalProblem, omega: FloatArray) -> FloatArray:
    """Return the frequencies at which a bend is tried, inside the fit's lags."""
    low = max(1 / (_LONGEST_SHARE * float(problem.lag[-1])), float(omega[3]))
    return np.geomspace(low, float(omega[-4]), _KNOTS)


def _left(design: FloatArray, gap: FloatArray) -> tuple[float, FloatArray]:
    """Return the residual sum of squares of a linear fit, and its coefficients."""
    found: FloatArray = np.asarray(np.linalg.lstsq(design, gap, rcond=None)[0], float)
    rest = gap - design @ found
    return float(rest @ rest), found
