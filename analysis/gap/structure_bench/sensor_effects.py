# SPDX-License-Identifier: MIT
"""Faults of sensors, cables and hammer points on bolted bodies."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.structure_bench.sensor_sites import (
    each_channel,
    movable_channels,
    movable_points,
    turned_channels,
)
from jointbench.analysis.gap.structure_bench.structure_effects import (
    Change,
    StructureEffect,
    one_parameter,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import (
    CableResonance,
    JointState,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


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
        rows = state.sensors_of(bodies).copy()
        size, azimuth = (float(v) for v in values)
        heading = np.array([np.cos(azimuth), np.sin(azimuth)])
        along, across = (np.cos(size), np.sin(size)) if rigidly else (1.0, size)
        rows[channel] *= along
        rows[channel] += across * (heading @ bodies.across[channel])
        return replace(state, sensors=rows)

    return change


def _move_sensor(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    bodies = campaign.bodies
    channel = bodies.channels.index(site.name)
    rows = state.sensors_of(bodies).copy()
    moved = bodies.around_channels[site.name].change(*_offset(values))
    rows[channel] += bodies.directions[channel] @ moved
    return replace(state, sensors=rows)


def _move_point(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    around = campaign.bodies.around_points[site.name]
    points = tuple(
        point.beside(around, *_offset(values)) if point.name == site.name else point
        for point in state.points_of(campaign.bodies)
    )
    return replace(state, points=points)


def _offset(values: FloatArray) -> tuple[float, float]:
    """Return the offset along both axes of a surface [m]."""
    distance, azimuth = (float(v) for v in values)
    return distance * float(np.cos(azimuth)), distance * float(np.sin(azimuth))


def _offset_found(values: FloatArray) -> tuple[Reported, ...]:
    u, v = _offset(values)
    return Reported("u", "m", u), Reported("v", "m", v)


def _cable(values: FloatArray) -> tuple[Reported, ...]:
    frequency = 1.0 / (2.0 * np.pi * max(float(values[0]), 1e-12))
    damping = Reported("damping_ratio", "-", float(values[1]))
    return Reported("frequency", "Hz", frequency), damping


_DIRECTION = "ISO 5347-11, transverse sensitivity"
_AZIMUTH = Parameter("azimuth", "rad", lower=-4.0, upper=4.0, starts=(0.0, np.pi / 2))
_POSITION = (
    Parameter(
        "distance",
        "m",
        lower=-0.06,
        upper=0.06,
        off=0.0,
        far=(-0.03, -0.01, 0.01, 0.03),
    ),
    replace(_AZIMUTH, starts=(0.0, np.pi / 4, np.pi / 2, 3 * np.pi / 4)),
)
SENSOR_EFFECTS: tuple[StructureEffect, ...] = (
    replace(
        one_parameter(
            "gain_error",
            "sensor",
            Parameter("gain", "-", lower=-0.6, upper=1.5, off=0.0),
            "ISO 16063-21",
            each_channel,
            _amplify,
        ),
        tolerance=STRUCTURE.least_gain,
    ),
    one_parameter(
        "polarity",
        "sensor",
        Parameter("reversal", "-", lower=1.9, upper=2.1, off=0.0, far=(2.0,)),
        "ISO 16063-21",
        each_channel,
        _reverse,
    ),
    one_parameter(
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
        tolerance=STRUCTURE.least_cross_axis,
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
        tolerance=STRUCTURE.least_turn,
    ),
    StructureEffect(
        Effect(
            "wrong_position",
            "sensor",
            _POSITION,
            "Ewins 2000, Modal Testing, ch. 3, location of transducers",
            report=_offset_found,
        ),
        movable_channels,
        _move_sensor,
        tolerance=STRUCTURE.least_move,
    ),
    StructureEffect(
        Effect(
            "wrong_hit_point",
            "sensor",
            (replace(_POSITION[0], far=()), _AZIMUTH),
            "Ewins 2000, Modal Testing, ch. 3, point of excitation",
            report=_offset_found,
        ),
        movable_points,
        _move_point,
        aimed=True,
    ),
)
"""Faults of sensors, cables and hammer points."""
