# SPDX-License-Identifier: MIT
"""Effects on bolted bodies that are integrated in time, and the whole catalogue."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Transform,
)
from jointbench.analysis.gap.structure_bench.body_effects import BODY_EFFECTS
from jointbench.analysis.gap.structure_bench.bolt_sites import (
    each_sliding_bolt,
    each_sprung_bolt,
    sliding_bolts,
    tangential_ports,
)
from jointbench.analysis.gap.structure_bench.joint_effects import JOINT_EFFECTS
from jointbench.analysis.gap.structure_bench.sensor_effects import SENSOR_EFFECTS
from jointbench.analysis.gap.structure_bench.structure_effects import (
    Change,
    StructureEffect,
    far_starts,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS
from jointbench.analysis.gap.structure_response.port_laws import (
    LawForm,
    PortLaws,
    spread_sliders,
)


def _slide(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    share, slip, early, preload, tail = (float(v) for v in values[:5])
    gradual = float(values[5]) if values.size > 5 else 0.0
    ports = tangential_ports(campaign, state, site)
    slips, weights = spread_sliders(slip, early, tail)
    # Without a gradual slider the integration ends where all sliders rest.
    yields = gradual > 0.0
    if yields:
        weights = np.append((1.0 - gradual) * weights, gradual)
        slips = np.append(slips, slip)
    laws = PortLaws(ports, share, slips, weights, preload=preload, gradual=int(yields))
    return replace(state, laws=(*state.laws, laws))


def _at_bolt(kind: LawForm) -> Change:
    """Return the change by a law in the normal direction of a bolt."""

    def change(
        state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
    ) -> JointState:
        port = 3 * campaign.bodies.bolt_number(site.name) + NORMAL
        gap = float(values[1]) if values.size > 1 else 0.0
        laws = PortLaws((port,), float(values[0]), kind=kind, gap=gap)
        return replace(state, laws=(*state.laws, laws))

    return change


def _law(
    name: str,
    family: str,
    parameters: tuple[Parameter, ...],
    kind: LawForm,
    source: str,
) -> StructureEffect:
    return StructureEffect(
        Effect(name, family, parameters, source),
        each_sprung_bolt,
        _at_bolt(kind),
        nonlinear=True,
    )


_WEIBULL = "Iwan 1966, J. Appl. Mech. 33, 893, with strengths of Weibull 1951"
_SHARE = Parameter("share", "-", lower=0.0, upper=1.0, off=0.0)
_PRELOAD = Parameter(
    "torque_exponent", "-", lower=-0.5, upper=2.0, starts=(0.0, 1.0), prior=(0.5, 1.0)
)
_TAIL = Parameter(
    "tail", "-", lower=-0.97, upper=0.5, starts=(-0.1,), prior=(-0.1, 0.5)
)
_GRADUAL = Parameter(
    "gradual", "-", lower=0.0, upper=1.0, starts=(0.2,), prior=(0.5, 0.5)
)


def _slip(lower: float, upper: float, *starts: float) -> Parameter:
    """Return the mean slip displacement, over the largest motion of the bolts."""
    log = Transform.LOG
    return Parameter(
        "slip", "m", "travel", lower=lower, upper=upper, starts=starts, transform=log
    )


def _early(lower: float, upper: float, start: float, spread: float) -> Parameter:
    """Return the share of the stiffness that slips below half the slip displacement."""
    log, prior = Transform.LOG, (start, spread)
    return Parameter(
        *("early", "-"),
        lower=lower,
        upper=upper,
        starts=(start,),
        transform=log,
        prior=prior,
    )


LAW_EFFECTS: tuple[StructureEffect, ...] = (
    StructureEffect(
        Effect(
            "microslip",
            "friction",
            (
                _SHARE,
                _slip(0.01, 100.0, 0.1, 0.5, 2.0),
                _early(PORT_LAWS.micro_share, 0.8, 0.37, 0.5),
                _PRELOAD,
                _TAIL,
            ),
            _WEIBULL,
            has_sliders=True,
        ),
        sliding_bolts,
        _slide,
        nonlinear=True,
        always=True,
    ),
    StructureEffect(
        Effect(
            "macroslip",
            "friction",
            (
                _SHARE,
                _slip(1e-3, 10.0, 0.03, 0.1, 0.3),
                _early(1e-5, PORT_LAWS.micro_share, 0.02, 1.5),
                _PRELOAD,
                _TAIL,
                _GRADUAL,
            ),
            _WEIBULL,
            has_sliders=True,
        ),
        each_sliding_bolt,
        _slide,
        nonlinear=True,
    ),
    _law(
        "clearance",
        "contact",
        (
            Parameter(
                "k",
                "N/m",
                "stiffness",
                lower=0.0,
                upper=100.0,
                off=0.0,
                far=far_starts(0.5, 20.0),
            ),
            Parameter(
                "g",
                "m",
                "travel",
                lower=1e-4,
                upper=3.0,
                starts=(0.01, 0.02, 0.04, 0.08, 0.16, 0.32),
                transform=Transform.LOG,
            ),
        ),
        LawForm.STOP,
        "Shaw and Holmes 1983, J. Sound Vib. 90, 129",
    ),
    _law(
        "cubic",
        "stiffness",
        (
            Parameter(
                "k3",
                "N/m^3",
                "stiffness/travel^2",
                lower=0.0,
                upper=1e5,
                off=0.0,
                far=far_starts(0.3, 100.0),
            ),
        ),
        LawForm.CUBIC,
        "Nayfeh and Mook 1979, Nonlinear Oscillations, sec. 4.1",
    ),
    _law(
        "quadratic",
        "stiffness",
        (
            Parameter(
                "k2",
                "N/m^2",
                "stiffness/travel",
                lower=-1e3,
                upper=1e3,
                off=0.0,
                far=(-10.0, -4.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 4.0, 10.0),
            ),
        ),
        LawForm.QUADRATIC,
        "Nayfeh and Mook 1979, Nonlinear Oscillations, sec. 4.2",
    ),
    _law(
        "damping_law",
        "damping",
        (Parameter("c2", "N s^2/m^2", "damping/speed", lower=0.0, upper=1e4, off=0.0),),
        LawForm.SQUARE_DAMPING,
        "Nayfeh and Mook 1979, Nonlinear Oscillations, sec. 3.3",
    ),
)
"""Effects that are integrated in time."""
STRUCTURE_CATALOGUE = (*JOINT_EFFECTS, *BODY_EFFECTS, *SENSOR_EFFECTS, *LAW_EFFECTS)
"""Effects that hits on bolted bodies can show."""
