# SPDX-License-Identifier: MIT
"""One fitted parameter of an effect, and its reported form."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np


class Transform(StrEnum):
    """Conversion of a fitted coordinate u to a value, given the scale of the bench.

    ``LINEAR`` is value = scale u; ``LOG`` is value = scale exp(u).
    """

    LINEAR = "linear"
    LOG = "log"


@dataclass(frozen=True, slots=True)
class Parameter:
    """One fitted parameter of an effect.

    The first parameter of an effect is its amplitude: the effect vanishes at 0.
    Bounds, starts and prior are multiples of a scale that the bench supplies, so
    that one catalogue fits structures of any size.

    Attributes:
        name: as reported, for example ``"k3"``.
        unit: of the value, for example ``"N/m^3"``.
        scale: word of the bench's scale, for example ``"stiffness/travel^2"``.
        lower: smallest value [scale].
        upper: largest value [scale].
        starts: start grid [scale]; may be empty for an amplitude, whose start then
            comes from the score test.
        transform: from coordinate to value.
        prior: (median [scale], relative sd) of a lognormal prior, or None.
        off: value at which the effect vanishes; None for a shape parameter.
        far: further start amplitudes [scale] of a strong effect, whose directed test
            may have the wrong size or sign.
    """

    name: str
    unit: str
    scale: str = "one"
    lower: float = -np.inf
    upper: float = np.inf
    starts: tuple[float, ...] = ()
    transform: Transform = Transform.LINEAR
    prior: tuple[float, float] | None = None
    off: float | None = None
    far: tuple[float, ...] = ()

    def encode(self, multiple: float) -> float:
        """Return the fitted coordinate of a value given in multiples of the scale."""
        return float(np.log(multiple)) if self.transform is Transform.LOG else multiple

    def decode(self, coordinate: float) -> float:
        """Return the value in multiples of the scale."""
        if self.transform is Transform.LOG:
            return float(np.exp(coordinate))
        return float(coordinate)

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds of the fitted coordinate."""
        if self.transform is Transform.LOG:
            return float(np.log(self.lower)), float(np.log(self.upper))
        return self.lower, self.upper


@dataclass(frozen=True, slots=True)
class Reported:
    """One parameter as reported.

    Attributes:
        name: for example ``"Fs"``.
        unit: for example ``"N"``.
        value: [unit].
    """

    name: str
    unit: str
    value: float
