# SPDX-License-Identifier: MIT
"""Spectrum of the height differences of profiles, in narrow bins of frequency.

Ordinates of a spectrum are independent, which values of a structure function are not:
a gradual bend at long waves is detected here much earlier.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.records.surfaces import Profile, Surface

TAPERED = 0.1
"""Share of the profile that is tapered at each end, against leakage [-]."""
FIRST_ORDINATE = 3
"""Lowest ordinate used; levelling changes those below [-]."""
BIN_RATIO = 1.1
"""Ratio of the edges of a bin [-]."""
FEWEST_POINTS = 512
"""Least points of a profile for a spectrum [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class BinnedSpectrum:
    """Mean periodogram of the differences of neighbouring heights.

    Attributes:
        omega: angular frequency [rad/sample], shape (n_bins,), ascending.
        power: two-sided density, whose integral is the variance [m^2], same shape.
        count: independent ordinates in each mean [-], same shape.
    """

    omega: FloatArray
    power: FloatArray
    count: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("power", self.power, self.omega.shape)
        require_shape("count", self.count, self.omega.shape)
        freeze(self, "omega", "power", "count")


def spectrum_of(surface: Surface) -> BinnedSpectrum | None:
    """Return the spectrum of a long profile without gaps, or None for others.

    Rows of a map are not independent, and gaps correlate ordinates.
    """
    if not isinstance(surface, Profile) or not surface.valid.all():
        return None
    return None if surface.heights.size < FEWEST_POINTS else _spectrum(surface.heights)


def _spectrum(heights: FloatArray) -> BinnedSpectrum:
    """Return the spectrum of one profile, its differences tapered at the ends."""
    steps = np.diff(heights)
    fade = _fade(steps.size)
    faded = (steps - steps.mean()) * fade
    squares = fade**2
    ordinates = np.abs(scipy.fft.rfft(faded)[FIRST_ORDINATE:-1]) ** 2
    ordinates /= 2 * np.pi * squares.sum()
    index = np.arange(FIRST_ORDINATE, FIRST_ORDINATE + ordinates.size)
    label = np.floor(np.log(index) / np.log(BIN_RATIO)).astype(np.int64)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(label)) + 1])
    sizes = np.diff(np.append(starts, index.size)).astype(np.float64)
    # The taper correlates neighbouring ordinates.
    independent = squares.sum() ** 2 / (squares.size * np.sum(squares**2))
    middle = np.exp(np.add.reduceat(np.log(index), starts) / sizes)
    return BinnedSpectrum(
        omega=2 * np.pi * middle / steps.size,
        power=np.add.reduceat(ordinates, starts) / sizes,
        count=np.maximum(1.0, sizes * independent),
    )


def pooled_spectrum(parts: list[BinnedSpectrum | None]) -> BinnedSpectrum | None:
    """Average the spectra of profiles of one length; None if one is missing."""
    known = [part for part in parts if part is not None]
    if len(known) < len(parts) or not known:
        return None
    return BinnedSpectrum(
        omega=known[0].omega,
        power=np.mean([part.power for part in known], axis=0),
        count=np.sum([part.count for part in known], axis=0),
    )


def _fade(count: int) -> FloatArray:
    """Return a window that is 1 but for a raised cosine at each end."""
    fade = np.ones(count)
    edge = int(TAPERED * count)
    rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
    fade[:edge] = rise
    fade[count - edge :] = rise[::-1]
    return fade
