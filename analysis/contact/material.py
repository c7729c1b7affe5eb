# SPDX-License-Identifier: MIT
"""Materials of the two bodies of a joint, and the yield criterion of asperities."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError

# From far below the softest gel to ten times the modulus of diamond [Pa]; values
# outside are in the wrong unit.
PRESSURE_RANGE = (1e3, 1e13)


@dataclass(frozen=True, slots=True)
class ContactMaterial:
    """The two bodies of a joint, as one composite material.

    Attributes:
        effective_modulus: composite modulus E* [Pa].
        hardness: of the softer body [Pa].
        poisson: Poisson ratio of the bodies [-].
        yield_strength: of the softer body [Pa]; None means hardness / 2.8.
        friction_factor: correction of the yield pressure for friction [-].
    """

    effective_modulus: float
    hardness: float
    poisson: float = 0.3
    yield_strength: float | None = None
    friction_factor: float = 1.0

    def __post_init__(self) -> None:
        """Check that every number is possible for a solid."""
        require_positive("effective_modulus", self.effective_modulus)
        require_positive("hardness", self.hardness)
        require_positive("friction_factor", self.friction_factor)
        if self.yield_strength is not None:
            require_positive("yield_strength", self.yield_strength)
        low, high = PRESSURE_RANGE
        for name in ("effective_modulus", "hardness", "yield_strength"):
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                raise BadData(
                    f"{name} is {value:g} Pa, a solid has {low:g} to {high:g} Pa; "
                    "give it in Pa, e.g. 2.3e9"
                )
        if not 0.0 <= self.poisson <= 0.5:
            raise UsageError(
                f"poisson is {self.poisson:g}, a solid has 0 to 0.5; give e.g. 0.28"
            )


def effective_modulus(
    modulus_a: float, poisson_a: float, modulus_b: float, poisson_b: float
) -> float:
    """Return the composite modulus E* of two bodies in contact [Pa].

    Args:
        modulus_a: Young's modulus of one body [Pa].
        poisson_a: its Poisson ratio [-].
        modulus_b: Young's modulus of the other body [Pa].
        poisson_b: its Poisson ratio [-].

    Returns:
        E* with 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b [Pa].

    Source:
        Johnson, Contact Mechanics (1985), sec. 4.2. Appl. Sci. 2023, 13, 11680,
        eq. (10) prints the right-hand side as E itself.
    """
    return 1.0 / ((1 - poisson_a**2) / modulus_a + (1 - poisson_b**2) / modulus_b)


class YieldCriterion(StrEnum):
    """Which property sets kappa, the root of critical interference over radius."""

    HARDNESS = "hardness"
    MEAN_CONTACT_PRESSURE = "mean_contact_pressure"
    FRICTION = "friction"


def yield_ratio(
    criterion: YieldCriterion, material: ContactMaterial, hardness: FloatArray
) -> FloatArray:
    """Return kappa, with delta_c = kappa^2 R [-].

    Args:
        criterion: the choice of the model.
        material: modulus, Poisson ratio, friction factor, yield strength.
        hardness: [Pa], any shape; replaces that of the material.

    Returns:
        kappa [-], shape of `hardness`.

    Source:
        HARDNESS: Appl. Sci. 2023, 13, 11680, eqs. (7)-(9); FRICTION: its eq. (40);
        MEAN_CONTACT_PRESSURE: Chang, Etsion and Bogy 1987, as Appl. Sci. 2025, 15,
        9040, eq. (8) uses it.
    """
    modulus = material.effective_modulus
    if criterion is YieldCriterion.HARDNESS:
        return math.pi * hardness / (2 * modulus)
    if criterion is YieldCriterion.MEAN_CONTACT_PRESSURE:
        factor = 0.454 + 0.41 * material.poisson
        return math.pi * factor * hardness / (2 * modulus)
    strength = material.yield_strength
    limit = hardness / 2.8 if strength is None else np.full_like(hardness, strength)
    return 33 * math.pi / 40 * material.friction_factor * limit / modulus
