# SPDX-License-Identifier: MIT
"""Load of one asperity by regime of deformation: power laws and full plasticity."""

import math
from dataclasses import dataclass
from enum import StrEnum


class Regime(StrEnum):
    """Regime of deformation, from the smallest contacts to the largest."""

    PLASTIC = "plastic"
    ELASTIC_PLASTIC_2 = "elastic_plastic_2"
    ELASTIC_PLASTIC_1 = "elastic_plastic_1"
    ELASTIC = "elastic"


REGIMES = tuple(Regime)
# Interference over critical interference at which one regime changes to the next:
# plastic above 110, second elastic-plastic stage above 6, first above 1.
REGIME_BOUNDS = (math.inf, 110.0, 6.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """Load of an asperity as P = coefficient * P_c * (delta / delta_c)^exponent.

    Attributes:
        coefficient: of the load [-].
        exponent: of the interference ratio [-].
        printed_slope: of the stiffness in P_c / delta_c [-], where a paper prints one
            that is not the derivative of its load.
    """

    coefficient: float
    exponent: float
    printed_slope: float | None = None

    @property
    def slope(self) -> float:
        """Coefficient of dP/d(delta) = slope * P_c / delta_c * s^(exponent - 1) [-]."""
        if self.printed_slope is not None:
            return self.printed_slope
        return self.coefficient * self.exponent


@dataclass(frozen=True, slots=True)
class FullyPlastic:
    """Load of an asperity as P = pressure_factor * hardness * a; 0 for no load."""

    pressure_factor: float


AsperityLaw = PowerLaw | FullyPlastic
# Contacts of a regime that was removed from a model.
ABSENT = FullyPlastic(0.0)


def bears_nothing(law: AsperityLaw) -> bool:
    """Return whether contacts of this law carry no load."""
    factor = law.coefficient if isinstance(law, PowerLaw) else law.pressure_factor
    return factor == 0.0
