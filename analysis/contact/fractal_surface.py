# SPDX-License-Identifier: MIT
"""Parameters of a fractal surface with asperities."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.material import (
    ContactMaterial,
    YieldCriterion,
    yield_ratio,
)
from jointbench.analysis.contact.models import ContactModel


@dataclass(frozen=True, slots=True, eq=False)
class FractalSurface:
    """Parameters of one or many fractal surfaces, broadcast against each other.

    Attributes:
        dimension: fractal dimension as the model's topography defines it [-].
        roughness: fractal roughness G [m].
        hardness: [Pa].
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].
        friction: replaces the material's friction factor [-], or None.
    """

    dimension: FloatArray
    roughness: FloatArray
    hardness: FloatArray
    gamma: float = 1.5
    friction: FloatArray | None = None


def surface_yield_ratio(
    model: ContactModel, surface: FractalSurface, material: ContactMaterial
) -> FloatArray:
    """Return kappa of the model, delta_c = kappa^2 R [-], on each surface."""
    kappa = yield_ratio(model.yielding, material, surface.hardness)
    if surface.friction is None or model.yielding is not YieldCriterion.FRICTION:
        return kappa
    return np.asarray(kappa * surface.friction / material.friction_factor)


def excess(model: ContactModel, surface: FractalSurface) -> FloatArray:
    """Return e = D - lowest dimension of the topography [-], 0 < e < 1."""
    return np.asarray(surface.dimension - model.topography.lowest_dimension)
