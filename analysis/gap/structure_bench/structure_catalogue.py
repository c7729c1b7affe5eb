# SPDX-License-Identifier: MIT
"""Effects on bolted bodies that are integrated in time, and the whole catalogue."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
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
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_response.port_laws import (
    LawForm,
    PortLaws,
    iwan_sliders,
)


def _slide(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    share, largest, power, preload, onset, gradual = (float(v) for v in values)
    slips, weights = iwan_sliders(largest, power, onset)
    ports = tangential_ports(campaign, state, site)
    return _with_friction(state, ports, share, (slips, weights, gradual), preload)


def _slip(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    share, slip, preload, gradual = (float(v) for v in values)
    ports = tangential_ports(campaign, state, site)
    sliders = np.array([slip]), np.ones(1), gradual
    return _with_friction(state, ports, share, sliders, preload)


def _with_friction(
    state: JointState,
    ports: tuple[int, ...],
    share: float,
    sliders: tuple[FloatArray, FloatArray, float],
    preload: float,
) -> JointState:
    """Return a state with sliders at ports.

    Args:
        state: of the model.
        ports: joint freedoms.
        share: of the stiffness of the port that the sliders hold [-].
        sliders: slip displacements [m], weights, and share of each that yields
            gradually [-].
        preload: power of the slip displacements in the bolt torque [-].
    """
    slips, weights, gradual = sliders
    both = np.concatenate([(1.0 - gradual) * weights, gradual * weights])
    laws = PortLaws(
        ports, share, np.tile(slips, 2), both, preload=preload, gradual=slips.size
    )
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


def _iwan(values: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("share", "-", float(values[0])),
        Reported("phimax", "m", float(values[1])),
        Reported("chi", "-", float(values[2] - 2.0)),
        Reported("torque_exponent", "-", float(values[3])),
        Reported("onset", "-", float(values[4])),
        Reported("gradual", "-", float(values[5])),
    )


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


_SEGALMAN = "Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), stiffness ~ phi^(chi+1)"
_SHARE = Parameter("share", "-", lower=0.0, upper=1.0, off=0.0)
_PRELOAD = Parameter(
    "torque_exponent", "-", lower=-0.5, upper=2.0, starts=(0.0, 1.0), prior=(0.5, 1.0)
)
_GRADUAL = Parameter(
    "gradual", "-", lower=0.0, upper=1.0, starts=(0.7,), prior=(0.5, 0.5)
)
LAW_EFFECTS: tuple[StructureEffect, ...] = (
    StructureEffect(
        Effect(
            "microslip",
            "friction",
            (
                _SHARE,
                Parameter(
                    "phimax",
                    "m",
                    "travel",
                    lower=0.02,
                    upper=100.0,
                    starts=(0.3, 1.5, 6.0),
                    transform=Transform.LOG,
                ),
                Parameter(
                    "chi_plus_2",
                    "-",
                    lower=1.05,
                    upper=2.2,
                    starts=(1.6,),
                    transform=Transform.LOG,
                    prior=(1.6, 0.3),
                ),
                _PRELOAD,
                Parameter(
                    "onset",
                    "-",
                    lower=0.005,
                    upper=0.5,
                    starts=(0.05,),
                    transform=Transform.LOG,
                    prior=(0.05, 1.5),
                ),
                _GRADUAL,
            ),
            _SEGALMAN,
            report=_iwan,
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
                Parameter(
                    "slip",
                    "m",
                    "travel",
                    lower=1e-3,
                    upper=10.0,
                    starts=(0.03, 0.1, 0.3),
                    transform=Transform.LOG,
                ),
                _PRELOAD,
                _GRADUAL,
            ),
            "Jenkins element: Gaul and Nitsche 2001, Appl. Mech. Rev. 54, 93",
            has_sliders=True,
        ),
        each_sliding_bolt,
        _slip,
        nonlinear=True,
    ),
    _law(
        "clearance",
        "contact",
        (
            Parameter("k", "N/m", "stiffness", lower=0.0, upper=100.0, off=0.0),
            Parameter(
                "g",
                "m",
                "travel",
                lower=1e-4,
                upper=3.0,
                starts=(0.01, 0.03, 0.1, 0.3),
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
                "k3", "N/m^3", "stiffness/travel^2", lower=0.0, upper=1e5, off=0.0
            ),
        ),
        LawForm.CUBIC,
        "Nayfeh and Mook 1979, Nonlinear Oscillations, sec. 4.1",
    ),
    _law(
        "quadratic",
        "stiffness",
        (Parameter("k2", "N/m^2", "stiffness/travel", lower=-1e3, upper=1e3, off=0.0),),
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
