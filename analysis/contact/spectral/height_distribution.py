# SPDX-License-Identifier: MIT
"""Whether measured heights are those of a random normal surface."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.analysis.contact.spectral.law_limits import LIMITS
from jointbench.signal.fractal.verdict_records import NORMAL_97_5
from jointbench.signal.surface.levelling import level


@dataclass(frozen=True, slots=True)
class HeightFacts:
    """Shape of the distribution of heights, hills upwards.

    Attributes:
        skewness: [-].
        kurtosis: excess over the normal distribution [-].
        hills: that the measurement has, by length or area over mean wavelength [-].
        height: root mean square [m].
    """

    skewness: float
    kurtosis: float
    hills: float
    height: float

    @property
    def deviation(self) -> str | None:
        """Why the heights are not normal; None where they may be."""
        # Each hill gives about two independent heights: a summit and a valley.
        reach = NORMAL_97_5 / np.sqrt(2 * max(self.hills, 0.5))
        for name, value, limit, unit in (
            ("skewness", self.skewness, LIMITS.skewed, 6),
            ("excess kurtosis", self.kurtosis, LIMITS.peaked, 24),
        ):
            if abs(value) > limit and abs(value) > reach * np.sqrt(unit):
                return f"heights have a {name} of {value:.2g}, normal ones 0"
        return None


def height_facts(surface: Surface, mean_wave: float) -> HeightFacts:
    """Return the facts of levelled heights.

    Args:
        surface: a profile or a map.
        mean_wave: mean wavelength by variance [m].
    """
    flat = level(surface)
    z = flat.heights[flat.valid]
    z = z - z.mean()
    sd = float(z.std())
    if isinstance(flat, Profile):
        hills = flat.spacing * flat.heights.size / mean_wave
    else:
        hills = float(np.prod(np.array(flat.heights.shape) * flat.spacing))
        hills /= mean_wave**2
    shape = z / sd
    return HeightFacts(
        float((shape**3).mean()), float((shape**4).mean() - 3), hills, sd
    )


def facts_of_both(facts: Sequence[HeightFacts]) -> HeightFacts:
    """Return the facts of the sum of independent heights.

    Cumulants of independent variables add.
    """
    variance = np.array([one.height**2 for one in facts])
    share = variance / variance.sum()
    return HeightFacts(
        float(sum(s**1.5 * f.skewness for s, f in zip(share, facts, strict=True))),
        float(sum(s**2 * f.kurtosis for s, f in zip(share, facts, strict=True))),
        min(one.hills for one in facts),
        float(np.sqrt(variance.sum())),
    )
