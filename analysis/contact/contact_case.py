# SPDX-License-Identifier: MIT
"""The physical case that a contact model predicts: handed on whole, as one record."""

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
        damping: what a damping coefficient is made of, or None for no damping.
        tangential_load: already on the joint [N].
        friction: coefficient of friction [-]; matters under a tangential load only.
        nominal_area: apparent area [m^2], which only guards the real area, or None.
    """

    material: ContactMaterial
    hardness_sd: float = 0.0
    friction_factor_sd: float = 0.0
    damping: DampingChoice | None = None
    tangential_load: float = 0.0
    friction: float = 0.3
    nominal_area: float | None = None


@dataclass(frozen=True, slots=True)
class ContactCase:
    """One rough joint under one preload, in one contact model.

    Attributes:
        model: see `CONTACT_MODELS`.
        surface: the one surface that stands for both faces, with its spread.
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
        """Fractal dimension as the model wants it: of a line (2D) or a surface [-]."""
        return self.surface.dimension_for(self.model)

    @property
    def fractal(self) -> FractalSurface:
        """The surface as the sums over its contacts take it."""
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
        """Return the case with no damping asked for."""
        return replace(self, conditions=replace(self.conditions, damping=None))
