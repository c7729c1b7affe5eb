# SPDX-License-Identifier: MIT
"""The band in which a hammer puts power into a structure."""

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.hits.hit_spectra import ForcesOfHits

# Fall of the force spectrum at the upper end of the excited band.
_FORCE_DROP_DB = 20.0
# Anti-alias filters of the usual converters leave this share of the sample rate.
_ALIAS_FREE = 1.0 / 2.56


def excited_band(spectra: ForcesOfHits) -> tuple[float, float]:
    """Return the band of the force spectrum within 20 dB of its low end, unaliased.

    Args:
        spectra: of the accepted hits.

    Returns:
        First line above DC and the last line before the force stays low over a fiftieth
        of the band [Hz].
    """
    power = np.mean(np.abs(spectra.force) ** 2, axis=0)
    return excited_band_of(power, spectra.frequency)


def excited_band_of(power: FloatArray, frequency: FloatArray) -> tuple[float, float]:
    """Return the band in which a force has power; see `excited_band`.

    Args:
        power: of the force, in any unit, shape (n_lines,).
        frequency: of the lines [Hz].
    """
    lines = max(3, power.size // 50)
    smooth = uniform_filter1d(power, lines, mode="nearest")
    strong = smooth > smooth[: power.size // 4 + 1].max() * 10 ** (-_FORCE_DROP_DB / 10)
    first = int(np.argmax(strong))
    fallen = np.flatnonzero(~strong[first:])
    last = first + int(fallen[0]) - 1 if fallen.size else power.size - 1
    highest = min(frequency[last], 2.0 * frequency[-1] * _ALIAS_FREE)
    return float(frequency[max(first, 1)]), float(highest)
