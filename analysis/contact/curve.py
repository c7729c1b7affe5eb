# SPDX-License-Identifier: MIT
"""Predict many rough joints at once, and refuse impossible input."""

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import JointSums, joint_sums
from jointbench.analysis.contact.material import PRESSURE_RANGE, ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import ContactModel
from jointbench.analysis.contact.solve import solve_largest_area

# From the force of a single atom to the weight of a mountain [N].
_LOAD_RANGE = (1e-9, 1e12)
# G is no length on the surface: height scales as G^(D - lowest), so smooth surfaces of
# low dimension have G far below an atom's size; only the upper limit is a length [m].
_ROUGHNESS_RANGE = (1e-60, 1.0)
# Real surfaces are described with 1.5; it is sparse at far smaller values [-].
_LARGEST_GAMMA = 1e3


def contact_curve(
    model: str | ContactModel,
    *,
    dimension: ArrayLike,
    roughness: ArrayLike,
    material: ContactMaterial,
    preload: ArrayLike,
    hardness: ArrayLike | None = None,
    friction: ArrayLike | None = None,
    gamma: float = 1.5,
) -> JointSums:
    """Predict many joints at once; the arguments broadcast against each other.

    Args:
        model: name or record; see `CONTACT_MODELS`.
        dimension: fractal dimension as the model's topography defines it [-].
        roughness: fractal roughness G [m].
        material: composite modulus, hardness and so on.
        preload: [N].
        hardness: replaces that of the material [Pa].
        friction: replaces the material's friction factor [-].
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].

    Returns:
        Areas, and load and stiffness by regime, of the broadcast shape.

    Raises:
        BadData: a number outside the model's range, or impossible for a solid joint, or
            numbers that together overflow.
    """
    model = contact_model(model) if isinstance(model, str) else model
    hard = np.asarray(material.hardness if hardness is None else hardness, dtype=float)
    force = np.asarray(preload, dtype=float)
    surface = FractalSurface(
        np.asarray(dimension, dtype=float),
        np.asarray(roughness, dtype=float),
        hard,
        gamma,
        None if friction is None else np.asarray(friction, dtype=float),
    )
    require_surface(model, surface)
    _require_within("preload", force, _LOAD_RANGE, "N", "4000")
    with np.errstate(all="ignore"):  # overflow is refused below
        log_largest = solve_largest_area(model, surface, material, force)
        sums = joint_sums(model, surface, material, log_largest)
    _require_finite(model, sums)
    return sums


def require_surface(model: ContactModel, surface: FractalSurface) -> None:
    """Raise unless the surface is one that the model's topography can describe.

    Args:
        model: its topography sets the range of dimensions.
        surface: of one or many joints.

    Raises:
        BadData: dimension, roughness, hardness or gamma is impossible for a real
            surface.
    """
    low = model.topography.lowest_dimension
    value = surface.dimension
    bad = ~((value > low) & (value < low + 1))
    if np.any(bad):
        first = float(value[bad].flat[0])
        shifted = first + (1 if first < low else -1)
        way_out = (
            f"profile and surface dimensions differ by 1: did you mean {shifted:g}?"
            if low < shifted < low + 1
            else "look at the local slope of the structure function before using it"
        )
        raise BadData(
            f"fractal dimension {first:g} is not between {low:g} and {low + 1:g}, as "
            f"model {model.name!r} ({model.topography.name}) needs; {way_out}"
        )
    _require_within("roughness", surface.roughness, _ROUGHNESS_RANGE, "m", "1e-9")
    _require_within("hardness", surface.hardness, PRESSURE_RANGE, "Pa", "2.3e9")
    if not 1 < surface.gamma <= _LARGEST_GAMMA:
        raise BadData(
            f"gamma is {surface.gamma:g}, it must exceed 1 and be at most "
            f"{_LARGEST_GAMMA:g}; usual is 1.5"
        )


def _require_finite(model: ContactModel, sums: JointSums) -> None:
    """Raise unless every area, load and stiffness is a number."""
    numbers = ("largest_area", "log_critical_area", "real_area", "load", "stiffness")
    for name in numbers:
        if not np.all(np.isfinite(getattr(sums, name))):
            raise BadData(
                f"{name.replace('_', ' ')} of model {model.name!r} is not finite with "
                "these numbers; check dimension, roughness (in metres) and preload"
            )


def _require_within(
    name: str,
    values: FloatArray,
    limits: tuple[float, float],
    unit: str,
    example: str,
) -> None:
    """Raise unless all `values` are finite, positive and physically possible."""
    low, high = limits
    bad = ~((values >= low) & (values <= high))
    if np.any(bad):
        raise BadData(
            f"{name} is {values[bad].flat[0]:g} {unit}, it must be finite and "
            f"positive, {low:g} to {high:g} {unit}; give e.g. {example}"
        )
