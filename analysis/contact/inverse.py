# SPDX-License-Identifier: MIT
"""Inverse problem: largest contact from real area or stiffness, preload from both."""

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.asperity import (
    asperity_load,
    interference,
    log_critical_area,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface, excess
from jointbench.analysis.contact.joint_sums import JointSums, joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel

# ln of areas from far below an atom's to far above a planet's [m^2].
_LOG_AREAS = (-690.0, 690.0)
_BISECTIONS = 120


def largest_area_of_real_area(
    model: ContactModel, surface: FractalSurface, real_area: ArrayLike
) -> FloatArray:
    """Return the largest contact area of a given real area [m^2].

    Args:
        model: its topography and population are used.
        surface: dimension of one or many surfaces.
        real_area: sum of all contact areas [m^2].

    Returns:
        a_l = A_r (1 - q)/(f q) with q = (1 + e)/2.

    Source:
        Appl. Sci. 2025, 15, 9040, eq. (7). Note: its lower limit a_c must be 0, and
        its n(a), f = 1/2, is not normalised; f is `model.population` here.
    """
    e = excess(model, surface)
    area = np.asarray(real_area, dtype=float)
    return np.asarray(area * (1 - e) / (model.population * (1 + e)))


def log_largest_of_stiffness(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    stiffness: ArrayLike,
) -> FloatArray:
    """Return ln(a_l / m^2) at which the joint has a given stiffness; it is unique.

    Args:
        model: its terms.
        surface: dimension, roughness and hardness.
        material: effective modulus and yield properties.
        stiffness: normal stiffness [N/m], broadcast with the surfaces, positive.

    Returns:
        ln of the largest contact area, to rounding.

    Raises:
        BadData: the stiffness is not positive, or no contact area gives it.
    """
    wanted = np.asarray(stiffness, dtype=float)
    if not np.all((wanted > 0) & np.isfinite(wanted)):
        raise BadData("stiffness must be finite and positive; give e.g. '3e7 N/m'")
    shape = np.broadcast(wanted, surface.dimension, surface.roughness, surface.hardness)
    # Stiffness is zero below the fully plastic bound, and large far above the critical
    # area.
    critical = log_critical_area(model, surface, material)
    low = np.full(shape.shape, _LOG_AREAS[0]) + np.minimum(critical, 0.0)
    high = np.full(shape.shape, _LOG_AREAS[1])
    with np.errstate(all="ignore"):
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            sums = joint_sums(model, surface, material, middle)
            soft = sums.stiffness.sum(axis=0) < wanted
            low, high = np.where(soft, middle, low), np.where(soft, high, middle)
    if np.any(high > _LOG_AREAS[1] - 1.0):
        raise BadData(
            f"no contact area gives model {model.name!r} this stiffness: all contacts "
            "stay fully plastic; check dimension, roughness (in metres) and hardness"
        )
    return np.asarray(0.5 * (low + high))


def preload_of(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    *,
    real_area: ArrayLike | None = None,
    stiffness: ArrayLike | None = None,
) -> FloatArray:
    """Return the preload at which a joint has a given real area or stiffness [N].

    Args:
        model: its terms.
        surface: dimension, roughness and hardness.
        material: effective modulus and yield properties.
        real_area: sum of all contact areas [m^2], or
        stiffness: normal stiffness [N/m]; one of the two.

    Returns:
        Preload of the broadcast shape.

    Raises:
        BadData: not one of the two is given, or it cannot be reached.
    """
    if (real_area is None) == (stiffness is None):
        raise BadData("give the real area or the stiffness, one of them")
    if stiffness is not None:
        log_largest = log_largest_of_stiffness(model, surface, material, stiffness)
    else:
        area = np.asarray(real_area, dtype=float)
        if not np.all((area > 0) & np.isfinite(area)):
            raise BadData("real area must be finite and positive; give e.g. 1e-6")
        log_largest = np.log(largest_area_of_real_area(model, surface, area))
    return np.asarray(joint_sums(model, surface, material, log_largest).load.sum(0))


def approach_stiffness(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    sums: JointSums,
) -> FloatArray:
    """Return dP'/d(approach) of a joint [N/m].

    Args:
        model: its terms.
        surface: dimension, roughness and hardness.
        material: effective modulus and yield properties.
        sums: of that model.

    Returns:
        Derivative of the total load by the interference of the largest contact: it
        grows as the bodies approach, and the distribution of contacts with it.
    """
    e = excess(model, surface)
    total = sums.load.sum(axis=0)
    largest = asperity_load(model, surface, material, np.log(sums.largest_area))
    by_log_area = (1 + e) / 2 * (total + model.population * largest)
    depth = interference(model, surface, sums.largest_area)
    return np.asarray(by_log_area / ((1 - e) / 2 * depth))
