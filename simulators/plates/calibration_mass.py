# SPDX-License-Identifier: MIT
"""A rigid mass on soft slings, to compare hammers and accelerometers."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.mechanics.modal_response import Poles


@dataclass(frozen=True, slots=True)
class CalibrationMass:
    """A mass that is struck on one side, with accelerometers on the other.

    Attributes:
        mass: total moving mass [kg].
        sling_frequency: natural frequency on the slings [Hz].
        sling_damping: damping ratio on the slings [-].
    """

    mass: float = 4.5
    sling_frequency: float = 2.0
    sling_damping: float = 0.02

    def __post_init__(self) -> None:
        """Refuse a mass that is not positive."""
        if not (np.isfinite(self.mass) and self.mass > 0):
            raise UsageError(f"mass is {self.mass!r} kg; give one above zero")


@lru_cache(maxsize=8)
def mass_poles(design: CalibrationMass, *, outputs: int) -> Poles:
    """Return the poles of the mass; every accelerometer moves alike.

    Args:
        design: the mass.
        outputs: number of accelerometers.
    """
    omega, ratio = 2 * np.pi * design.sling_frequency, design.sling_damping
    pole = omega * (-ratio + 1j * np.sqrt(1 - ratio**2))
    # A unit impulse leaves v(0) = 1/m; acceleration is p^2 times the displacement
    # Im(exp(p t)) / (m Im p), of which twice the real part is kept.
    gain = pole**2 / (2j * pole.imag * design.mass)
    return Poles(
        np.array([pole]),
        np.full((1, outputs), gain),
        np.full(outputs, 1 / design.mass),
    )
