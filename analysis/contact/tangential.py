# SPDX-License-Identifier: MIT
"""Tangential stiffness of contacts that stick, slip in part, or slide (Mindlin)."""

import math

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.asperity_laws import REGIMES, PowerLaw, Regime
from jointbench.analysis.contact.joint_sums import JointSums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, regime_laws


def sticking_share(
    tangential_load: ArrayLike, preload: ArrayLike, friction: float
) -> FloatArray:
    """Return the tangential stiffness over that without any slip [-].

    Args:
        tangential_load: T, shared among the contacts as the preload is [N].
        preload: P [N].
        friction: coefficient of friction mu [-].

    Returns:
        (1 - T/(mu P))^(1/3), and 0 where the joint slides, T >= mu P.

    Raises:
        BadData: friction or preload not positive, or a negative tangential load.

    Source:
        Cattaneo 1938, Mindlin 1949; Johnson, Contact Mechanics (1985), sec. 7.2.
    """
    force, normal = np.asarray(tangential_load, float), np.asarray(preload, float)
    if not (math.isfinite(friction) and friction > 0):
        raise BadData(f"friction is {friction:g}, it must be positive; give e.g. 0.3")
    if not np.all(normal > 0):
        raise BadData("preload must be positive for friction to hold; give e.g. 4000")
    if not np.all(force >= 0):
        raise BadData("tangential load must be 0 or more; give its magnitude")
    return np.asarray(np.cbrt(np.clip(1 - force / (friction * normal), 0.0, 1.0)))


def tangential_stiffness(
    model: ContactModel,
    sums: JointSums,
    material: ContactMaterial,
    *,
    tangential_load: float = 0.0,
    friction: float = 0.3,
) -> FloatArray:
    """Return the tangential stiffness of the elastic contacts [N/m].

    Args:
        model: its topography and elastic law relate normal stiffness to area.
        sums: of that model.
        material: its Poisson ratio is used for both bodies.
        tangential_load: applied to the joint [N]; 0 is no slip.
        friction: coefficient of friction [-]; matters under a tangential load only.

    Returns:
        Sum of 8 G' r over the elastic contacts, r = sqrt(a/pi), times the share that
        sticks when all contacts carry the same T/P; shape (...).

    Source:
        Mindlin 1949; Johnson, Contact Mechanics (1985), sec. 7.2, with
        1/G' = (2 - nu_a)/G_a + (2 - nu_b)/G_b. In Hertz's geometry the ratio to the
        normal stiffness is 2 (1 - nu)/(2 - nu).
    """
    elastic = regime_laws(model)[REGIMES.index(Regime.ELASTIC)]
    if not isinstance(elastic, PowerLaw):
        return np.zeros_like(sums.largest_area)
    hertz = 2 * (1 - material.poisson) / (2 - material.poisson)
    # Normal: slope / 1.5 * 2 E sqrt(a/g); tangential: 8 G' sqrt(a/pi).
    per_area = math.sqrt(model.topography.shape / math.pi) * 1.5 / elastic.slope
    part = sums.stiffness[REGIMES.index(Regime.ELASTIC)]
    share: FloatArray | float = 1.0
    if tangential_load:
        share = sticking_share(tangential_load, sums.load.sum(axis=0), friction)
    return np.asarray(hertz * per_area * part * share)


def shear_modulus(effective_modulus: float, poisson: float) -> float:
    """Return G' of two like bodies, 4 G'/E* = 2 (1 - nu)/(2 - nu) [Pa]."""
    return effective_modulus * (1 - poisson) / (2 * (2 - poisson))


def contact_shear(
    displacement: ArrayLike,
    *,
    radius: float,
    shear: float,
    preload: float,
    friction: float,
) -> tuple[FloatArray, FloatArray]:
    """Return force and stiffness of one contact under a first tangential motion.

    Args:
        displacement: tangential, of the bodies far from the contact [m].
        radius: of the contact [m].
        shear: composite shear modulus G' [Pa].
        preload: on this contact [N].
        friction: coefficient of friction [-].

    Returns:
        Force T = mu P [1 - (1 - 16 G' r x/(3 mu P))^(3/2)] [N], at most mu P, and its
        slope 8 G' r (1 - T/(mu P))^(1/3) [N/m].

    Source:
        Johnson, Contact Mechanics (1985), eqs. (7.41)-(7.43).
    """
    limit = friction * preload
    left = 1 - 16 * shear * radius * np.asarray(displacement, float) / (3 * limit)
    left = np.maximum(left, 0.0)
    force = limit * (1 - left**1.5)
    stiffness = 8 * shear * radius * sticking_share(force, preload, friction)
    return np.asarray(force), np.asarray(stiffness)
