# SPDX-License-Identifier: MIT
"""Predict the stiffness of a rough joint from its surface, material and preload."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData
from jointbench.analysis.contact.asperity import FractalSurface
from jointbench.analysis.contact.material import PRESSURE_RANGE, ContactMaterial
from jointbench.analysis.contact.models import (
    REGIMES,
    ContactModel,
    PowerLaw,
    Regime,
    contact_model,
    regime_laws,
)
from jointbench.analysis.contact.sums import JointSums, joint_sums, solve_largest_area

DAMPING_REASON = (
    "no damping law is given: the published loss of first plastic loading is not what "
    "a small vibration about the preload loses in a cycle; identify it from hits"
)

# Above this many times the largest contact, the real area is made of contacts far
# smaller than any the model's surface was measured at.
_MANY_CONTACTS = 100.0
# From a single atom's grip to a mountain's weight [N].
_LOAD_RANGE = (1e-9, 1e12)
# G is no length on the surface: height goes as G^(D - lowest), so smooth surfaces of
# low dimension have G far below an atom, and only the upper end is a size [m].
_ROUGHNESS_RANGE = (1e-60, 1.0)
# Real surfaces are described with 1.5; the function is sparse far below this [-].
_LARGEST_GAMMA = 1e3


class ContactVerdict(StrEnum):
    """Whether a predicted stiffness can be used."""

    USABLE = "usable"
    FULLY_PLASTIC = "fully plastic"
    OVER_NOMINAL = "real area above nominal area"


@dataclass(frozen=True, slots=True)
class ContactState:
    """A rough joint under preload, as one model predicts it.

    Attributes:
        model: name of the model.
        preload: [N].
        normal_stiffness: sum of the stiffnesses of all contacts at their present
            sizes [N/m]; as in the papers, not the derivative of the load by the
            approach of the bodies.
        tangential_stiffness: no slip, elastic contacts only [N/m].
        damping: [N s/m]; None, for the reason in `DAMPING_REASON`.
        largest_area: area of the largest contact a_l [m^2].
        critical_area: area below which asperities yield a_c [m^2].
        real_area: sum of all contact areas [m^2].
        load_parts: load carried by each regime [N].
        stiffness_parts: stiffness of each regime [N/m].
        verdict: whether to use it.
        reasons: one line for each thing the verdict rests on, or to keep in mind.
    """

    model: str
    preload: float
    normal_stiffness: float
    tangential_stiffness: float
    damping: float | None
    largest_area: float
    critical_area: float
    real_area: float
    load_parts: Mapping[Regime, float]
    stiffness_parts: Mapping[Regime, float]
    verdict: ContactVerdict
    reasons: tuple[str, ...]


def predict_contact(
    model: str | ContactModel,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    gamma: float = 1.5,
    nominal_area: float | None = None,
) -> ContactState:
    """Predict one joint.

    Args:
        model: name or record; see `CONTACT_MODELS`.
        dimension: fractal dimension, between 1 and 2 for a profile model (2D),
            between 2 and 3 for a surface model (3D) [-].
        roughness: fractal roughness G of the equivalent surface [m].
        material: composite modulus, hardness and so on.
        preload: normal force on the joint [N].
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].
        nominal_area: apparent area of the joint [m^2]; only guards the real one.

    Returns:
        Stiffness, areas, parts by regime, verdict with reasons.

    Raises:
        BadData: a number outside the model's range.

    Source:
        `sums.joint_sums`; tangential: Mindlin 1949.
    """
    model = contact_model(model) if isinstance(model, str) else model
    sums = contact_curve(
        model,
        dimension=dimension,
        roughness=roughness,
        material=material,
        preload=preload,
        gamma=gamma,
    )
    if nominal_area is not None and not 0 < nominal_area < math.inf:
        raise BadData(
            f"nominal area is {nominal_area:g} m^2, it must be finite and positive; "
            "give e.g. 0.01"
        )
    verdict, reasons = _judge(sums, nominal_area)
    return ContactState(
        model=model.name,
        preload=float(preload),
        normal_stiffness=float(sums.stiffness.sum()),
        tangential_stiffness=float(tangential_stiffness(model, sums, material)),
        damping=None,
        largest_area=float(sums.largest_area),
        critical_area=float(sums.critical_area),
        real_area=float(sums.real_area),
        load_parts=dict(zip(REGIMES, map(float, sums.load), strict=True)),
        stiffness_parts=dict(zip(REGIMES, map(float, sums.stiffness), strict=True)),
        verdict=verdict,
        reasons=reasons,
    )


def contact_curve(
    model: str | ContactModel,
    *,
    dimension: ArrayLike,
    roughness: ArrayLike,
    material: ContactMaterial,
    preload: ArrayLike,
    hardness: ArrayLike | None = None,
    gamma: float = 1.5,
) -> JointSums:
    """Predict many joints at once; the arguments broadcast against each other.

    Args:
        model: name or record; see `CONTACT_MODELS`.
        dimension: fractal dimension as the model's topography wants it [-].
        roughness: fractal roughness G [m].
        material: composite modulus, hardness and so on.
        preload: [N].
        hardness: in place of the material's own [Pa].
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].

    Returns:
        Areas, and load and stiffness by regime, of the broadcast shape.

    Raises:
        BadData: a number outside the model's range, or outside what a solid joint can
            have, or numbers that together overflow.
    """
    model = contact_model(model) if isinstance(model, str) else model
    hard = np.asarray(material.hardness if hardness is None else hardness, dtype=float)
    force = np.asarray(preload, dtype=float)
    surface = FractalSurface(
        np.asarray(dimension, dtype=float),
        np.asarray(roughness, dtype=float),
        hard,
        gamma,
    )
    _require_range(model, surface)
    _require_within("preload", force, _LOAD_RANGE, "N", "4000")
    with np.errstate(all="ignore"):  # what overflows is refused just below
        log_largest = solve_largest_area(model, surface, material, force)
        sums = joint_sums(model, surface, material, log_largest)
    _require_finite(model, sums)
    return sums


def tangential_stiffness(
    model: ContactModel, sums: JointSums, material: ContactMaterial
) -> FloatArray:
    """Return the tangential stiffness of the elastic contacts without slip [N/m].

    Args:
        model: its topography and elastic law relate normal stiffness to area.
        sums: of that model.
        material: its Poisson ratio is taken for both bodies.

    Returns:
        Sum of 8 G' r over the elastic contacts, r = sqrt(a/pi), shape (...).

    Source:
        Mindlin 1949; Johnson, Contact Mechanics (1985), sec. 7.2, with
        1/G' = (2 - nu_a)/G_a + (2 - nu_b)/G_b. In Hertz's geometry the ratio to the
        normal stiffness is 2 (1 - nu)/(2 - nu).
    """
    elastic = regime_laws(model)[REGIMES.index(Regime.ELASTIC)]
    if not isinstance(elastic, PowerLaw):
        return np.zeros_like(sums.largest_area)
    hertz = 2 * (1 - material.poisson) / (2 - material.poisson)
    # Normal: coefficient * 2 E sqrt(a/g); tangential: 8 G' sqrt(a/pi).
    per_area = math.sqrt(model.topography.shape / math.pi) / elastic.coefficient
    part = sums.stiffness[REGIMES.index(Regime.ELASTIC)]
    return np.asarray(hertz * per_area * part)


def _judge(
    sums: JointSums, nominal_area: float | None
) -> tuple[ContactVerdict, tuple[str, ...]]:
    """Say whether the stiffness of one joint can be used, and why."""
    verdict, reasons = ContactVerdict.USABLE, []
    largest, critical = float(sums.largest_area), float(sums.critical_area)
    real = float(sums.real_area)
    if largest < critical:
        reasons.append(
            f"the largest contact, {largest:.3g} m^2, is below the critical area, "
            f"{critical:.3g} m^2: no contact is elastic, interaction changes nothing, "
            "and the tangential stiffness of elastic contacts is 0"
        )
    if real > _MANY_CONTACTS * largest:
        reasons.append(
            f"the real area is {real / largest:.3g} times the largest contact: at this "
            "dimension it rests on contacts smaller than any profile resolves"
        )
    if not sums.stiffness.sum() > 0:
        verdict = ContactVerdict.FULLY_PLASTIC
        reasons.append(
            "every contact is fully plastic and has no stiffness in this model; "
            "check dimension, roughness (in metres) and hardness"
        )
    if nominal_area is not None and real > nominal_area:
        verdict = ContactVerdict.OVER_NOMINAL
        reasons.append(
            f"the real area, {real:.3g} m^2, is above the nominal {nominal_area:.3g} "
            "m^2: the preload is beyond what the surface can carry in this model"
        )
    return verdict, tuple(reasons)


def _require_range(model: ContactModel, surface: FractalSurface) -> None:
    """Raise unless the surface is one that the model's topography can describe."""
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
    for name in ("largest_area", "critical_area", "real_area", "load", "stiffness"):
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
