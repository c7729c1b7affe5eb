# SPDX-License-Identifier: MIT
"""What a diagnosed chain predicts that no fit has seen: torques, modes, a hit point."""

from dataclasses import replace

import numpy as np
from chain_cases import ChainCase

from jointbench.analysis.gap.chain.chain_diagnosis import (
    ChainDiagnosis,
    diagnose_chain,
)
from jointbench.analysis.gap.chain.locate_link import Chain
from jointbench.analysis.gap.chain.lumped_structure import (
    FittedState,
    LumpedStructure,
    read_lumped,
)
from jointbench.analysis.gap.chain.moved_quantities import (
    MovedStiffness,
    moved_modes,
    moved_stiffness,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.residuals.make_bench import make_bench

_JOINT = 1
"""Link of the two blocks that is the joint."""
_STRUCK = 1
"""Body whose hits are fitted; those on the other one are predicted."""


def torques_inside(found: ChainDiagnosis) -> tuple[int, int]:
    """Return how many torques are in their 95 % interval from the others, of all."""
    stiffness = moved_stiffness(found)
    count = len(stiffness.preload)
    return round(stiffness.inside * count), count


def modes_inside(found: ChainDiagnosis, structure: LumpedStructure) -> tuple[int, int]:
    """Return the same of the natural frequencies at each torque, all at once."""
    stiffness = moved_stiffness(found)
    reach = np.exp(CONTACT.interval_z * stiffness.after_sd)
    ends = [
        moved_modes(structure, replace(stiffness, after=stiffness.after * factor))
        for factor in (1.0 / reach, reach)
    ]
    inside = 0
    for low, high in zip(*ends, strict=True):
        seen, rounding = low.measured, 1e-9 * low.measured
        above = np.all(seen >= low.after - rounding)
        inside += bool(above and np.all(seen <= high.after + rounding))
    return inside, len(ends[0])


def unseen_point(case: ChainCase) -> tuple[float, float]:
    """Return the residual over the response of hits on a body that no fit has seen.

    By the law alone, and with what is named from the hits on the other body; each
    torque is predicted from the others.
    """
    own = tuple(_hits(one, struck=True) for one in case.campaigns)
    structure = read_lumped(own, link=_JOINT)
    found = diagnose_chain(Chain(case.surface, structure.reading, case.states))
    stiffness: MovedStiffness = moved_stiffness(found)
    off = [
        (
            _residual(state, _hits(whole, struck=False), float(before)),
            _residual(state, _hits(whole, struck=False), float(after)),
        )
        for state, whole, before, after in zip(
            structure.states,
            case.campaigns,
            stiffness.before,
            stiffness.after,
            strict=True,
        )
    ]
    before, after = np.sqrt(np.mean(np.square(off), axis=0))
    return float(before), float(after)


def _hits(campaign: Campaign, *, struck: bool) -> Campaign:
    keep = (campaign.hit == _STRUCK) == struck
    return replace(
        campaign,
        force=campaign.force[keep],
        response=campaign.response[keep],
        hit=campaign.hit[keep],
        level=campaign.level[keep],
        preload=campaign.preload[keep],
        order=np.arange(int(keep.sum()), dtype=float),
    )


def _residual(state: FittedState, unseen: Campaign, stiffness: float) -> float:
    """Return the residual over the response of hits with one stiffness [-]."""
    bench = make_bench(unseen)
    known = state.bench.campaign.model.nominal * np.exp(state.best.base)
    known[len(unseen.model.bodies) + _JOINT] = stiffness
    base = np.log(known / unseen.model.nominal)
    off = bench.response(base, ()) - unseen.response
    return float(np.sqrt(np.mean(off**2) / np.mean(unseen.response**2)))
