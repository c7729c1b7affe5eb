# SPDX-License-Identifier: MIT
"""Effects at bolts, joints, points and channels of bolted bodies."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.effect import Candidate, Effect, Site, Term
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.structure_bench.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_bench.joint_state import Attached, JointState
from jointbench.analysis.gap.structure_bench.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_bench.port_laws import PortLaws, iwan_sliders

_Change = Callable[[JointState, HitCampaign, Site, FloatArray], JointState]
_Sites = Callable[[HitCampaign], tuple[Site, ...]]
_BOLTS = "bolts"


@dataclass(frozen=True, slots=True)
class StructureEffect:
    """An effect with its physics on bolted bodies.

    Attributes:
        effect: name, parameters and rivals.
        sites: where it can act on a structure.
        change: adds it to a state of the model.
        nonlinear: True if it is integrated in time.
        always: True if fits start from it whatever the directed tests find.
    """

    effect: Effect
    sites: _Sites
    change: _Change
    nonlinear: bool = False
    always: bool = False


def structure_candidates(
    entries: Sequence[StructureEffect], campaign: HitCampaign
) -> tuple[Candidate, ...]:
    """Return every effect of a catalogue at each of its sites."""
    return tuple(
        Candidate(entry.effect, site)
        for entry in entries
        for site in entry.sites(campaign)
    )


def structure_state(
    entries: Sequence[StructureEffect],
    campaign: HitCampaign,
    bare: JointState,
    terms: Sequence[Term],
    values: Sequence[FloatArray],
) -> JointState:
    """Return a state with effects added.

    Args:
        entries: the catalogue.
        campaign: model and nominal.
        bare: state without effects.
        terms: effects.
        values: of their parameters [SI].
    """
    known = {entry.effect.name: entry.change for entry in entries}
    state = bare
    for term, value in zip(terms, values, strict=True):
        change = known[term.candidate.effect.name]
        state = change(state, campaign, term.candidate.site, value)
    return state


def without_effects(
    entries: Sequence[StructureEffect], names: frozenset[str]
) -> tuple[StructureEffect, ...]:
    """Return a catalogue without some effects.

    Raises:
        UsageError: no entry has one of the names.
    """
    known = {entry.effect.name for entry in entries}
    for name in sorted(names - known):
        raise UsageError(
            f"there is no effect {name!r} on structures; known are "
            f"{', '.join(sorted(known))}"
        )
    return tuple(entry for entry in entries if entry.effect.name not in names)


def _rigid_site(name: str, directions: tuple[int, ...]) -> _Sites:
    def sites(campaign: HitCampaign) -> tuple[Site, ...]:
        rigid = all(campaign.bodies.rigid[d] for d in directions)
        return (Site("joint", name),) if rigid else ()

    return sites


def _each_bolt(campaign: HitCampaign) -> tuple[Site, ...]:
    count = campaign.bodies.bolts.shape[0]
    return tuple(Site("bolt", f"{k}") for k in range(count))


def _all_bolts(campaign: HitCampaign) -> tuple[Site, ...]:
    return (Site(_BOLTS, "all"),)


def _two_torques(campaign: HitCampaign) -> tuple[Site, ...]:
    return _all_bolts(campaign) if np.unique(campaign.hits.torque).size > 1 else ()


def _tangential(campaign: HitCampaign) -> tuple[Site, ...]:
    return () if all(campaign.bodies.rigid[:NORMAL]) else _all_bolts(campaign)


def _places(campaign: HitCampaign) -> tuple[Site, ...]:
    return tuple(Site("point", place.name) for place in campaign.bodies.places)


def _channels(campaign: HitCampaign) -> tuple[Site, ...]:
    return tuple(Site("channel", name) for name in campaign.bodies.channels)


def _compliant(directions: tuple[int, ...]) -> _Change:
    def change(
        state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
    ) -> JointState:
        compliance = state.compliance.copy()
        compliance[list(directions)] = values
        return replace(state, compliance=compliance)

    return change


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


def _attach(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    names = [place.name for place in campaign.bodies.places]
    place = names.index(site.name)
    if values.size == 1:
        new = Attached(place, float(values[0]))
    else:
        new = Attached(place, *(float(v) for v in values))
    return replace(state, attached=(*state.attached, new))


def _amplify(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    gain = state.gain.copy()
    gain[campaign.bodies.channels.index(site.name)] += values[0]
    return replace(state, gain=gain)


def _postpone(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    lag = state.lag.copy()
    lag[campaign.bodies.channels.index(site.name)] += values[0]
    return replace(state, lag=lag)


def tangential_ports(state: JointState) -> tuple[int, ...]:
    """Return the compliant joint freedoms across the bolts."""
    return tuple(
        3 * k + d
        for k in range(state.bolt.size)
        for d in range(NORMAL)
        if state.compliance[d] > 0.0
    )


def _slide(
    state: JointState, campaign: HitCampaign, site: Site, values: FloatArray
) -> JointState:
    slips, weights = iwan_sliders(float(values[1]), float(values[2]))
    laws = PortLaws(tangential_ports(state), float(values[0]), slips, weights)
    return replace(state, laws=laws)


def _stiffness_of(*names: str) -> Callable[[FloatArray], tuple[Reported, ...]]:
    def report(values: FloatArray) -> tuple[Reported, ...]:
        return tuple(
            Reported(name, "N/m", 1.0 / max(float(v), 1e-300))
            for name, v in zip(names, values, strict=True)
        )

    return report


def _factor(values: FloatArray) -> tuple[Reported, ...]:
    return (Reported("factor", "-", float(np.exp(-values[0]))),)


def _iwan(values: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("share", "-", float(values[0])),
        Reported("phimax", "m", float(values[1])),
        Reported("chi", "-", float(values[2] - 2.0)),
    )


_SEGALMAN = "Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), stiffness ~ phi^(chi+1)"
_COUPLING = "Craig and Kurdila 2006, ch. 17, closed by compliances"


def _compliance(name: str) -> Parameter:
    far = (0.1, 0.3, 1.0, 3.0, 10.0)
    return Parameter(
        name, "m/N", "compliance", lower=0.0, upper=300.0, off=0.0, far=far
    )


STRUCTURE_CATALOGUE: tuple[StructureEffect, ...] = (
    StructureEffect(
        Effect(
            "joint_compliance_normal",
            "stiffness",
            (_compliance("compliance_z"),),
            _COUPLING,
            report=_stiffness_of("kn"),
        ),
        _rigid_site("normal", (NORMAL,)),
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
        _rigid_site("tangential", (0, 1)),
        _compliant((0, 1)),
        always=True,
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
            report=_factor,
        ),
        _each_bolt,
        _loosen,
        always=True,
    ),
    StructureEffect(
        Effect(
            "preload_stiffness",
            "preload",
            (Parameter("n", "-", lower=-2.0, upper=2.0, off=0.0),),
            "Ibrahim and Pettit 2005, J. Sound Vib. 279, 857",
        ),
        _two_torques,
        _by_torque,
    ),
    StructureEffect(
        Effect(
            "added_mass",
            "mass",
            (Parameter("m", "kg", "mass", lower=0.0, upper=0.5, off=0.0),),
            "Ewins 2000, Modal Testing, sec. 3.9",
        ),
        _places,
        _attach,
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
        _places,
        _attach,
    ),
    StructureEffect(
        Effect(
            "gain_error",
            "sensor",
            (Parameter("gain", "-", lower=-0.6, upper=1.5, off=0.0),),
            "ISO 16063-21",
        ),
        _channels,
        _amplify,
    ),
    StructureEffect(
        Effect(
            "delay",
            "sensor",
            (Parameter("tau", "s", "sample time", lower=-20.0, upper=20.0, off=0.0),),
            "ISO 7626-5:2019, 8.3",
        ),
        _channels,
        _postpone,
    ),
    StructureEffect(
        Effect(
            "microslip",
            "friction",
            (
                Parameter("share", "-", lower=0.0, upper=1.0, off=0.0),
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
            ),
            _SEGALMAN,
            report=_iwan,
            has_sliders=True,
        ),
        _tangential,
        _slide,
        nonlinear=True,
        always=True,
    ),
)
"""Effects that hits on bolted bodies can show."""
