# SPDX-License-Identifier: MIT
"""The physical case of a contact prediction, as one record."""

from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.analysis.contact.damping import DampingChoice
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel
from jointbench.analysis.contact.spread import ContactSpread
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload


@dataclass(frozen=True, slots=True)
class ContactConditions:
    """A joint apart from its surface and preload.

    Attributes:
        material: of both bodies.
        hardness_sd: standard deviation of the hardness [Pa].
        friction_factor_sd: standard deviation of the friction factor k_mu [-].
        damping: definition of the damping coefficient, or None for no damping.
        tangential_load: applied to the joint [N].
        friction: coefficient of friction [-]; matters under a tangential load only.
        nominal_area: apparent area [m^2], to check the real area and as reference of
            the laws of measured surfaces, or None.
        modulus_sd: standard deviation of E* [Pa], for those laws only.
    """

    material: ContactMaterial
    hardness_sd: float = 0.0
    friction_factor_sd: float = 0.0
    damping: DampingChoice | None = None
    tangential_load: float = 0.0
    friction: float = 0.3
    nominal_area: float | None = None
    modulus_sd: float = 0.0


@dataclass(frozen=True, slots=True)
class ContactCase:
    """One rough joint under one preload, in one contact model.

    Attributes:
        model: see `CONTACT_MODELS`.
        surface: the equivalent surface of both contact surfaces, with its spread.
        preload: normal force on the joint, with its standard deviation [N].
        conditions: material, tangential load and so on.
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].
    """

    model: ContactModel
    surface: ContactSurface
    preload: Preload
    conditions: ContactConditions
    gamma: float = field(default=1.5, kw_only=True)

    @property
    def material(self) -> ContactMaterial:
        """Of both bodies."""
        return self.conditions.material

    @property
    def dimension(self) -> float:
        """Fractal dimension as the model defines it: line (2D) or surface [-]."""
        return self.surface.dimension_for(self.model)

    @property
    def fractal(self) -> FractalSurface:
        """The surface as input of the sums over its contacts."""
        return FractalSurface(
            np.array(self.dimension),
            np.array(self.surface.roughness),
            np.array(self.material.hardness),
            self.gamma,
        )

    @property
    def spread(self) -> ContactSpread:
        """Standard deviations of all inputs.

        Raises:
            UsageError: one of them is negative.
        """
        return replace(
            self.surface.spread,
            preload=self.preload.sd,
            hardness=self.conditions.hardness_sd,
            friction=self.conditions.friction_factor_sd,
        )

    def without_damping(self) -> "ContactCase":
        """Return the case without damping."""
        return replace(self, conditions=replace(self.conditions, damping=None))
