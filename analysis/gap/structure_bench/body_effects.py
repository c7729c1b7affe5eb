# SPDX-License-Identifier: MIT
"""Linear effects of bodies and of what stands beside them."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.structure_bench.place_sites import (
    each_body,
    each_direction,
    each_foot,
    each_meshed_body,
    each_place,
    place_and_direction,
    place_of,
)
from jointbench.analysis.gap.structure_bench.structure_effects import (
    StructureEffect,
    far_starts,
    one_parameter,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import Attached, JointState


def _stiffen_body(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    modulus = state.modulus.copy()
    modulus[campaign.bodies.bodies.index(site.name)] *= 1.0 + values[0]
    return replace(state, modulus=modulus)


def _thicken_body(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    bodies = campaign.bodies.thickness[site.name](1.0 + float(values[0]))
    return replace(state, bodies=bodies, tuned=None)


def _hold_foot(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    factor = state.foot_factor.copy()
    factor[int(site.name)] *= np.exp(values[0])
    return replace(state, foot_factor=factor)


def _attach(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    place, normal = place_of(campaign, site)
    if values.size == 1:
        new = Attached(place, float(values[0]), normal=normal)
    else:
        m, frequency, damping = (float(v) for v in values)
        new = Attached(place, m, frequency, damping, normal=normal)
    return replace(state, attached=(*state.attached, new))


def _hold(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    place, normal = place_of(campaign, site)
    new = Attached(place, 0.0, stiffness=float(values[0]), normal=normal)
    return replace(state, attached=(*state.attached, new))


def _foot_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(np.exp(values[0]))),)


def _body_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(1.0 + values[0])),)


BODY_EFFECTS: tuple[StructureEffect, ...] = (
    one_parameter(
        "added_mass",
        "mass",
        Parameter(
            "m",
            "kg",
            "mass",
            lower=0.0,
            upper=0.5,
            off=0.0,
            far=far_starts(0.02, 0.45),
        ),
        "Ewins 2000, Modal Testing, sec. 3.9",
        each_place,
        _attach,
    ),
    one_parameter(
        "added_stiffness",
        "stiffness",
        Parameter(
            "k",
            "N/m",
            "stiffness",
            lower=0.0,
            upper=100.0,
            off=0.0,
            far=far_starts(0.05, 50.0),
        ),
        "Ewins 2000, Modal Testing, sec. 3.2",
        each_direction,
        _hold,
    ),
    StructureEffect(
        Effect(
            "hidden_mode",
            "mode",
            (
                Parameter(
                    "m",
                    "kg",
                    "mass",
                    lower=0.0,
                    upper=0.5,
                    off=0.0,
                    far=(0.01, 0.03, 0.1, 0.3),
                ),
                Parameter(
                    "f",
                    "Hz",
                    "band",
                    lower=0.02,
                    upper=1.2,
                    starts=(0.08, 0.12, 0.18, 0.27, 0.4, 0.6, 0.9, 1.12),
                    transform=Transform.LOG,
                ),
                Parameter(
                    "zeta",
                    "-",
                    lower=1e-3,
                    upper=0.3,
                    starts=(0.02,),
                    transform=Transform.LOG,
                ),
            ),
            "Den Hartog 1956, Mechanical Vibrations, sec. 3.2",
        ),
        place_and_direction,
        _attach,
    ),
    StructureEffect(
        Effect(
            "modulus",
            "stiffness",
            (
                Parameter(
                    "change",
                    "-",
                    lower=-0.6,
                    upper=1.5,
                    off=0.0,
                    far=(-0.3, -0.2, -0.1, 0.1, 0.2, 0.35),
                ),
            ),
            "Ewins 2000, Modal Testing, sec. 6.3",
            report=_body_factor,
            by_prior=True,
        ),
        each_body,
        _stiffen_body,
        always=True,
    ),
    StructureEffect(
        Effect(
            "thickness",
            "stiffness",
            (
                Parameter(
                    "change", "-", lower=-0.25, upper=0.3, off=0.0, far=(-0.1, 0.1)
                ),
            ),
            "Leissa 1969, NASA SP-160, ch. 1: bending by t^3, stretching and mass by t",
            separates={
                "modulus": "weigh the body: its mass grows with its thickness, and "
                "modes in its plane keep their frequencies"
            },
            report=_body_factor,
        ),
        each_meshed_body,
        _thicken_body,
        # Modulus and mass of the base take most of it over.
        always=True,
        alone=True,
    ),
    StructureEffect(
        Effect(
            "support",
            "stiffness",
            (
                Parameter(
                    "rise",
                    "-",
                    lower=-4.0,
                    upper=8.0,
                    off=0.0,
                    far=(-2.0, -1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0),
                ),
            ),
            "ISO 7626-5:2019, 6.2",
            report=_foot_factor,
        ),
        each_foot,
        _hold_foot,
        always=True,
    ),
)
"""Linear effects of bodies and of what stands beside them."""
