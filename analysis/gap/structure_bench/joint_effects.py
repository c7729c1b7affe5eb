# SPDX-License-Identifier: MIT
"""Linear effects of the joint on bolted bodies."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
)
from jointbench.analysis.gap.structure_bench.bolt_sites import (
    each_bolt,
    where_rigid,
    with_torques,
)
from jointbench.analysis.gap.structure_bench.joint_axes import (
    ALONG_BOLTS,
    bolt_arms,
    joint_axes,
)
from jointbench.analysis.gap.structure_bench.structure_effects import (
    Change,
    StructureEffect,
    far_starts,
    one_parameter,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL

_Report = Callable[[FloatArray], tuple[Reported, ...]]


def _compliant(directions: tuple[int, ...]) -> Change:
    def change(
        state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
    ) -> JointState:
        compliance = state.compliance.copy()
        compliance[list(directions)] = values
        return replace(state, compliance=compliance)

    return change


def _rock(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    arm = bolt_arms(campaign, site.name)
    return replace(state, rocking=values[0] * np.outer(arm, arm))


def _tilt(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    arm = bolt_arms(campaign, site.name)
    factor = np.maximum(1.0 + values[0] * arm / np.abs(arm).max(), 1e-3)
    return replace(state, bolt=state.bolt * factor)


def _loosen(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    bolt = state.bolt.copy()
    bolt[campaign.bodies.bolt_number(site.name)] *= np.exp(-values[0])
    return replace(state, bolt=bolt)


def _by_torque(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    return replace(state, exponent=float(values[0]))


def _damp_by_torque(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    return replace(state, damping_exponent=float(values[0]))


def _stiffness_of(*names: str) -> _Report:
    def report(values: FloatArray) -> tuple[Reported, ...]:
        return tuple(
            Reported(name, "N/m", 1.0 / max(float(v), 1e-300))
            for name, v in zip(names, values, strict=True)
        )

    return report


def _loose_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(np.exp(-values[0]))),)


_COUPLING = "Craig and Kurdila 2006, ch. 17, closed by compliances"
_PRELOAD = "Ibrahim and Pettit 2005, J. Sound Vib. 279, 857"


def _compliance(name: str) -> Parameter:
    far = far_starts(0.05, 100.0)
    return Parameter(
        name, "m/N", "compliance", lower=0.0, upper=300.0, off=0.0, far=far
    )


JOINT_EFFECTS: tuple[StructureEffect, ...] = (
    StructureEffect(
        Effect(
            "joint_compliance_normal",
            "stiffness",
            (_compliance("compliance_z"),),
            _COUPLING,
            report=_stiffness_of("kn"),
        ),
        where_rigid(ALONG_BOLTS.name, (NORMAL,)),
        _compliant((NORMAL,)),
        always=True,
    ),
    StructureEffect(
        Effect(
            "joint_compliance_tangential",
            "stiffness",
            (
                _compliance("compliance_x"),
                # A fit that began at 3 and at 10 ended at seven times the true 1.9.
                replace(
                    _compliance("compliance_y"),
                    starts=(0.1, 0.3, 0.7, 1.0, 1.5, 2.2, 3.3, 10.0),
                ),
            ),
            _COUPLING,
            report=_stiffness_of("ktx", "kty"),
        ),
        where_rigid("tangential", (0, 1)),
        _compliant((0, 1)),
        always=True,
    ),
    replace(
        one_parameter(
            "joint_compliance_rocking",
            "stiffness",
            Parameter(
                "compliance",
                "rad/(N m)",
                "rocking",
                lower=0.0,
                upper=30.0,
                off=0.0,
                far=far_starts(0.05, 20.0),
            ),
            _COUPLING,
            joint_axes,
            _rock,
            always=True,
        ),
        yielding=True,
    ),
    StructureEffect(
        Effect(
            "loose_bolt",
            "stiffness",
            (
                Parameter(
                    "loss",
                    "-",
                    lower=0.0,
                    upper=6.0,
                    off=0.0,
                    far=(0.7, 1.1, 1.5, 2.0, 2.5, 3.0, 3.5, 4.5, 5.5),
                ),
            ),
            _COUPLING,
            report=_loose_factor,
        ),
        each_bolt,
        _loosen,
        always=True,
    ),
    replace(
        one_parameter(
            "contact_patch",
            "stiffness",
            Parameter(
                "slope",
                "-",
                lower=-0.95,
                upper=0.95,
                off=0.0,
                far=(-0.6, -0.3, 0.3, 0.6),
            ),
            _COUPLING,
            joint_axes,
            _tilt,
            always=True,
        ),
        yielding=True,
    ),
    one_parameter(
        "preload_stiffness",
        "preload",
        Parameter("n", "-", lower=-2.0, upper=2.0, off=0.0, far=(-0.8, -0.4, 0.4, 0.8)),
        _PRELOAD,
        with_torques,
        _by_torque,
        always=True,
        by_torque=True,
    ),
    one_parameter(
        "preload_damping",
        "preload",
        Parameter(
            "n", "-", lower=-3.0, upper=3.0, off=0.0, far=(-1.5, -0.75, 0.75, 1.5)
        ),
        _PRELOAD,
        with_torques,
        _damp_by_torque,
        always=True,
        by_torque=True,
    ),
)
"""Linear effects of the joint."""
