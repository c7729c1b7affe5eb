# SPDX-License-Identifier: MIT
"""Predict the stiffness of a rough joint from its surface, material and preload."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.asperity_laws import REGIMES, Regime
from jointbench.analysis.contact.contact_case import ContactCase
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.damping import damping_coefficient, loss_factor
from jointbench.analysis.contact.inverse import approach_stiffness
from jointbench.analysis.contact.joint_sums import JointSums
from jointbench.analysis.contact.models import Mode
from jointbench.analysis.contact.printed_formulas import (
    printed_stiffness_parts,
    printed_warnings,
)
from jointbench.analysis.contact.tangential import tangential_stiffness

DAMPING_REASON = (
    "no damping: give the mass or the frequency on the joint for the loss of a "
    "first loading as N s/m; a small vibration loses less, identify it"
)

# Above this ratio to the largest contact, the real area consists of contacts far
# smaller than any measured scale of the surface.
_MANY_CONTACTS = 100.0
# ln of the largest area written as a plain number [ln m^2].
_LARGEST_LOG_SHOWN = 30 * math.log(10)


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
        mode: corrected, or with the choices and sums of its paper.
        preload: [N].
        normal_stiffness: sum of the stiffnesses of all contacts at their present
            sizes [N/m]; as in the papers, not the derivative of the load by the
            approach of the bodies.
        approach_stiffness: derivative of the load by the interference of the largest
            contact, the approach of the bodies while it grows [N/m].
        tangential_stiffness: of the elastic contacts only [N/m].
        loss_factor: of a first loading, in the requested convention [-], or None.
        damping: [N s/m]; None where no mass or frequency is given, `DAMPING_REASON`.
        largest_area: area of the largest contact a_l [m^2].
        critical_area: area below which asperities yield a_c [m^2]; inf where a double
            overflows, as near the lower end of the dimension.
        real_area: sum of all contact areas [m^2].
        load_parts: load carried by each regime [N].
        stiffness_parts: stiffness of each regime [N/m].
        verdict: whether to use it.
        reasons: one line for each basis of the verdict, or caution.
    """

    model: str
    mode: Mode
    preload: float
    normal_stiffness: float
    approach_stiffness: float
    tangential_stiffness: float
    loss_factor: float | None
    damping: float | None
    largest_area: float
    critical_area: float
    real_area: float
    load_parts: Mapping[Regime, float]
    stiffness_parts: Mapping[Regime, float]
    verdict: ContactVerdict
    reasons: tuple[str, ...]


def predict_contact(case: ContactCase) -> ContactState:
    """Predict one joint.

    Args:
        case: model, surface, preload and conditions; their uncertainties are not used.

    Returns:
        Stiffness, areas, parts by regime, verdict with reasons. As printed, the largest
        area is from the correct sums of the paper's laws, because the printed loads of
        2023 can be negative; stiffness is exactly as printed.

    Raises:
        BadData: a number outside the model's range.

    Source:
        `sums.joint_sums`; tangential: Mindlin 1949.
    """
    conditions, preload = case.conditions, case.preload.value
    sums = contact_curve(
        case.model,
        dimension=case.dimension,
        roughness=case.surface.roughness,
        material=case.material,
        preload=preload,
        gamma=case.gamma,
    )
    nominal_area = conditions.nominal_area
    if nominal_area is not None and not 0 < nominal_area < math.inf:
        raise BadData(
            f"nominal area is {nominal_area:g} m^2, it must be finite and positive; "
            "give e.g. 0.01"
        )
    tangential = tangential_stiffness(
        case.model,
        sums,
        case.material,
        tangential_load=conditions.tangential_load,
        friction=conditions.friction,
    )
    verdict, reasons = _judge(sums, nominal_area)
    slides = float(tangential) == 0 < float(sums.stiffness[-1])
    if conditions.tangential_load and slides:
        reasons.append("the tangential load exceeds friction times preload: it slides")
    state = _state(case, sums, tangential=float(tangential))
    state = replace(state, verdict=verdict, reasons=tuple(reasons))
    if case.model.mode is Mode.AS_PRINTED:
        state = _to_the_letter(state, case)
    return _with_damping(state, case)


def _state(case: ContactCase, sums: JointSums, *, tangential: float) -> ContactState:
    """Return the sums of one joint as a state, not judged, without damping."""
    approach = approach_stiffness(case.model, case.fractal, case.material, sums)
    return ContactState(
        model=case.model.name,
        mode=case.model.mode,
        preload=float(case.preload.value),
        normal_stiffness=float(sums.stiffness.sum()),
        approach_stiffness=float(approach),
        tangential_stiffness=tangential,
        loss_factor=None,
        damping=None,
        largest_area=float(sums.largest_area),
        critical_area=float(sums.critical_area),
        real_area=float(sums.real_area),
        load_parts=dict(zip(REGIMES, map(float, sums.load), strict=True)),
        stiffness_parts=dict(zip(REGIMES, map(float, sums.stiffness), strict=True)),
        verdict=ContactVerdict.USABLE,
        reasons=(),
    )


def _to_the_letter(state: ContactState, case: ContactCase) -> ContactState:
    """Replace the corrected sums by the printed ones, and report the errors."""
    surface = {
        "dimension": case.dimension,
        "roughness": case.surface.roughness,
        "gamma": case.gamma,
    }
    warnings = printed_warnings(
        state.model, material=case.material, preload=state.preload, **surface
    )
    state = replace(state, reasons=state.reasons + warnings)
    literal = printed_stiffness_parts(
        state.model, material=case.material, largest_area=state.largest_area, **surface
    )
    if literal is None:
        return state
    critical, parts = literal
    return replace(
        state,
        critical_area=critical,
        stiffness_parts=parts,
        normal_stiffness=sum(parts.values()),
    )


def _with_damping(state: ContactState, case: ContactCase) -> ContactState:
    """Add loss factor and damping, where requested."""
    choice = case.conditions.damping
    if choice is None:
        return state
    factor = loss_factor(
        case.model,
        case.fractal,
        case.material,
        np.log(state.largest_area),
        form=choice.form,
        convention=choice.convention,
    )
    if not np.isfinite(factor):
        line = "nothing is stored elastically, so a loss factor has no value"
        return replace(state, reasons=(*state.reasons, line))
    value = damping_coefficient(factor, np.array(state.normal_stiffness), choice)
    return replace(state, loss_factor=float(factor), damping=float(value))


def _judge(
    sums: JointSums, nominal_area: float | None
) -> tuple[ContactVerdict, list[str]]:
    """Return the verdict on the stiffness of one joint, with reasons."""
    verdict = ContactVerdict.USABLE
    reasons: list[str] = []
    largest, real = float(sums.largest_area), float(sums.real_area)
    if largest < float(sums.critical_area):
        reasons.append(
            f"the largest contact, {largest:.3g} m^2, is below the critical area, "
            f"{_area(sums.log_critical_area)}: no contact is elastic, interaction "
            "changes nothing, and the tangential stiffness of elastic contacts is 0"
        )
    if real > _MANY_CONTACTS * largest:
        reasons.append(
            f"the real area is {real / largest:.3g} times the largest contact: at this "
            "dimension it consists of contacts smaller than any profile resolves"
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
    return verdict, reasons


def _area(log_area: FloatArray) -> str:
    """Format an area given by its logarithm, also beyond the largest double."""
    if log_area < _LARGEST_LOG_SHOWN:
        return f"{float(np.exp(log_area)):.3g} m^2"
    return f"10^{float(log_area) / math.log(10):.0f} m^2"
