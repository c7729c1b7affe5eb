# SPDX-License-Identifier: MIT
"""Linear effects on bolted bodies: joint, bodies, supports, sensors."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.structure_bench.bolt_sites import (
    each_bolt,
    where_rigid,
    with_torques,
)
from jointbench.analysis.gap.structure_bench.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_bench.joint_axes import (
    bolt_arms,
    joint_axes,
)
from jointbench.analysis.gap.structure_bench.joint_state import (
    Attached,
    CableResonance,
    JointState,
)
from jointbench.analysis.gap.structure_bench.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_bench.place_sites import (
    each_body,
    each_channel,
    each_direction,
    each_foot,
    each_place,
    place_and_direction,
    place_of,
    turned_channels,
)
from jointbench.analysis.gap.structure_bench.structure_effects import (
    Change,
    Sites,
    StructureEffect,
)

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
    bolt[int(site.name)] *= np.exp(-values[0])
    return replace(state, bolt=bolt)


def _by_torque(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    return replace(state, exponent=float(values[0]))


def _damp_by_torque(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    return replace(state, damping_exponent=float(values[0]))


def _stiffen_body(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    modulus = state.modulus.copy()
    modulus[campaign.bodies.bodies.index(site.name)] *= 1.0 + values[0]
    return replace(state, modulus=modulus)


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


def _amplify(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    gain = state.gain.copy()
    gain[campaign.bodies.channels.index(site.name)] += values[0]
    return replace(state, gain=gain)


def _reverse(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    return _amplify(state, campaign, site, -values)


def _postpone(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    lag = state.lag.copy()
    lag[campaign.bodies.channels.index(site.name)] += values[0]
    return replace(state, lag=lag)


def _resound(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    channel = campaign.bodies.channels.index(site.name)
    new = CableResonance(channel, float(values[0]), float(values[1]))
    return replace(state, cables=(*state.cables, new))


def _turned(rigidly: bool) -> Change:
    """Return the change of a sensor that is turned, or that hears across."""

    def change(
        state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
    ) -> JointState:
        bodies = campaign.bodies
        channel = bodies.channels.index(site.name)
        rows = (bodies.sensors if state.sensors is None else state.sensors).copy()
        size, azimuth = (float(v) for v in values)
        heading = np.array([np.cos(azimuth), np.sin(azimuth)])
        along, across = (np.cos(size), np.sin(size)) if rigidly else (1.0, size)
        rows[channel] *= along
        rows[channel] += across * (heading @ bodies.across[channel])
        return replace(state, sensors=rows)

    return change


def _stiffness_of(*names: str) -> _Report:
    def report(values: FloatArray) -> tuple[Reported, ...]:
        return tuple(
            Reported(name, "N/m", 1.0 / max(float(v), 1e-300))
            for name, v in zip(names, values, strict=True)
        )

    return report


def _loose_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(np.exp(-values[0]))),)


def _foot_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(np.exp(values[0]))),)


def _body_factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(1.0 + values[0])),)


def _cable(values: FloatArray) -> tuple[Reported, ...]:
    frequency = 1.0 / (2.0 * np.pi * max(float(values[0]), 1e-12))
    damping = Reported("damping_ratio", "-", float(values[1]))
    return Reported("frequency", "Hz", frequency), damping


_COUPLING = "Craig and Kurdila 2006, ch. 17, closed by compliances"
_PRELOAD = "Ibrahim and Pettit 2005, J. Sound Vib. 279, 857"
_DIRECTION = "ISO 5347-11, transverse sensitivity"


def _compliance(name: str) -> Parameter:
    far = (0.1, 0.3, 1.0, 3.0, 10.0)
    return Parameter(
        name, "m/N", "compliance", lower=0.0, upper=300.0, off=0.0, far=far
    )


def _one(
    name: str,
    family: str,
    parameter: Parameter,
    source: str,
    sites: Sites,
    change: Change,
) -> StructureEffect:
    """Return an effect of one parameter."""
    return StructureEffect(Effect(name, family, (parameter,), source), sites, change)


_AZIMUTH = Parameter("azimuth", "rad", lower=-4.0, upper=4.0, starts=(0.0, np.pi / 2))
JOINT_EFFECTS: tuple[StructureEffect, ...] = (
    StructureEffect(
        Effect(
            "joint_compliance_normal",
            "stiffness",
            (_compliance("compliance_z"),),
            _COUPLING,
            report=_stiffness_of("kn"),
        ),
        where_rigid("normal", (NORMAL,)),
        _compliant((NORMAL,)),
        always=True,
    ),
    StructureEffect(
        Effect(
            "joint_compliance_tangential",
            "stiffness",
            (
                _compliance("compliance_x"),
                replace(_compliance("compliance_y"), starts=(0.1, 0.3, 1.0, 3.0, 10.0)),
            ),
            _COUPLING,
            report=_stiffness_of("ktx", "kty"),
        ),
        where_rigid("tangential", (0, 1)),
        _compliant((0, 1)),
        always=True,
    ),
    _one(
        "joint_compliance_rocking",
        "stiffness",
        Parameter(
            "compliance",
            "rad/(N m)",
            "rocking",
            lower=0.0,
            upper=30.0,
            off=0.0,
            far=(0.3, 1.0),
        ),
        _COUPLING,
        joint_axes,
        _rock,
    ),
    StructureEffect(
        Effect(
            "loose_bolt",
            "stiffness",
            (
                Parameter(
                    "loss", "-", lower=0.0, upper=6.0, off=0.0, far=(0.7, 1.5, 2.5, 3.5)
                ),
            ),
            _COUPLING,
            report=_loose_factor,
        ),
        each_bolt,
        _loosen,
        always=True,
    ),
    _one(
        "contact_patch",
        "stiffness",
        Parameter("slope", "-", lower=-0.95, upper=0.95, off=0.0),
        _COUPLING,
        joint_axes,
        _tilt,
    ),
    _one(
        "preload_stiffness",
        "preload",
        Parameter("n", "-", lower=-2.0, upper=2.0, off=0.0),
        _PRELOAD,
        with_torques,
        _by_torque,
    ),
    _one(
        "preload_damping",
        "preload",
        Parameter("n", "-", lower=-3.0, upper=3.0, off=0.0),
        _PRELOAD,
        with_torques,
        _damp_by_torque,
    ),
)
"""Linear effects of the joint."""
BODY_EFFECTS: tuple[StructureEffect, ...] = (
    _one(
        "added_mass",
        "mass",
        Parameter("m", "kg", "mass", lower=0.0, upper=0.5, off=0.0),
        "Ewins 2000, Modal Testing, sec. 3.9",
        each_place,
        _attach,
    ),
    _one(
        "added_stiffness",
        "stiffness",
        Parameter(
            "k", "N/m", "stiffness", lower=0.0, upper=100.0, off=0.0, far=(0.1, 1.0)
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
                Parameter("m", "kg", "mass", lower=0.0, upper=0.5, off=0.0),
                Parameter(
                    "f",
                    "Hz",
                    "band",
                    lower=0.02,
                    upper=1.2,
                    starts=(0.08, 0.12, 0.18, 0.27, 0.4, 0.6),
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
            (Parameter("change", "-", lower=-0.6, upper=1.5, off=0.0),),
            "Ewins 2000, Modal Testing, sec. 6.3",
            report=_body_factor,
            by_prior=True,
        ),
        each_body,
        _stiffen_body,
    ),
    StructureEffect(
        Effect(
            "support",
            "stiffness",
            (
                Parameter(
                    "rise", "-", lower=-4.0, upper=8.0, off=0.0, far=(2.0, 3.5, 5.0)
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
SENSOR_EFFECTS: tuple[StructureEffect, ...] = (
    _one(
        "gain_error",
        "sensor",
        Parameter("gain", "-", lower=-0.6, upper=1.5, off=0.0),
        "ISO 16063-21",
        each_channel,
        _amplify,
    ),
    _one(
        "polarity",
        "sensor",
        Parameter("reversal", "-", lower=1.9, upper=2.1, off=0.0, far=(2.0,)),
        "ISO 16063-21",
        each_channel,
        _reverse,
    ),
    _one(
        "delay",
        "sensor",
        Parameter("tau", "s", "sample time", lower=-20.0, upper=20.0, off=0.0),
        "ISO 7626-5:2019, 8.3",
        each_channel,
        _postpone,
    ),
    StructureEffect(
        Effect(
            "cable_resonance",
            "sensor",
            (
                Parameter(
                    "period",
                    "s",
                    "sample time",
                    lower=0.0,
                    upper=1.0,
                    off=0.0,
                    far=(0.15, 0.3, 0.5),
                ),
                Parameter(
                    "zeta",
                    "-",
                    lower=1e-3,
                    upper=1.0,
                    starts=(0.05,),
                    transform=Transform.LOG,
                ),
            ),
            "ISO 5347-14, resonance of a mounted accelerometer",
            report=_cable,
        ),
        each_channel,
        _resound,
    ),
    StructureEffect(
        Effect(
            "cross_axis",
            "sensor",
            (
                Parameter("share", "-", lower=-1.0, upper=1.0, off=0.0),
                _AZIMUTH,
            ),
            _DIRECTION,
        ),
        turned_channels,
        _turned(rigidly=False),
    ),
    StructureEffect(
        Effect(
            "wrong_direction",
            "sensor",
            (
                Parameter("angle", "rad", lower=-1.5, upper=1.5, off=0.0),
                _AZIMUTH,
            ),
            _DIRECTION,
        ),
        turned_channels,
        _turned(rigidly=True),
    ),
)
"""Faults of sensors and cables."""
