# SPDX-License-Identifier: MIT
"""From the table [law] of a joint file to the contact law of its diagnosis."""

from jointbench.analysis.contact.material import ContactMaterial, effective_modulus
from jointbench.analysis.gap.contact_bench.joint_states import JointFacts
from jointbench.analysis.gap.contact_bench.preload_law import LawParameter, PreloadLaw
from jointbench.analysis.gap.contact_bench.preload_laws import (
    AsperityPreloadLaw,
    FractalPreloadLaw,
    LinearPreloadLaw,
    PowerPreloadLaw,
    asperity_parameters,
    fractal_parameters,
)
from jointbench.station.schemas.joint_states_model import BodiesTable, LawTable

_HARDNESS = 2.3e9
"""Hardness of the papers' cast iron [Pa], where none is given."""


def contact_law(law: LawTable, bodies: BodiesTable, facts: JointFacts) -> PreloadLaw:
    """Return the contact law of a joint file.

    Args:
        law: its table, complete for its family.
        bodies: materials.
        facts: of the joint.
    """
    if law.family == "asperities":
        return AsperityPreloadLaw(
            asperity_parameters(
                (law.rms_height or 0.0, law.rms_height_sd),
                (law.rms_slope or 0.0, law.rms_slope_sd),
                (law.rms_curvature or 0.0, law.rms_curvature_sd),
                (facts.modulus, bodies.modulus_sd),
                law.hurst,
            ),
            facts.area,
            facts.poisson,
        )
    if law.family == "linear":
        return LinearPreloadLaw(
            (
                LawParameter(
                    "rms_height", "m", law.rms_height or 0.0, law.rms_height_sd
                ),
                LawParameter("share", "-", law.share, law.share_sd),
            ),
            facts.poisson,
        )
    if law.family == "power":
        return PowerPreloadLaw(
            (
                LawParameter(
                    "stiffness", "N/m", law.stiffness or 0.0, law.stiffness_sd
                ),
                LawParameter("exponent", "-", law.exponent or 0.0, law.exponent_sd),
            ),
            law.preload or 0.0,
            facts.poisson,
        )
    return _fractal(law, bodies, facts)


def _fractal(law: LawTable, bodies: BodiesTable, facts: JointFacts) -> PreloadLaw:
    hardness = bodies.hardness or _HARDNESS
    dimension = law.dimension or 0.0
    material = ContactMaterial(facts.modulus, hardness, bodies.poisson)
    return FractalPreloadLaw(
        fractal_parameters(
            (dimension, law.dimension_sd / dimension),
            (law.roughness or 0.0, law.roughness_sd),
            (hardness, bodies.hardness_sd),
        ),
        law.model,
        material,
        name=law.model,
    )


def modulus_of(bodies: BodiesTable) -> float:
    """Return the composite modulus E* of two bodies [Pa]."""
    other = bodies.modulus if bodies.modulus_b is None else bodies.modulus_b
    ratio = bodies.poisson if bodies.poisson_b is None else bodies.poisson_b
    return effective_modulus(bodies.modulus, bodies.poisson, other, ratio)
