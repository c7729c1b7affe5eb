# SPDX-License-Identifier: MIT
"""Prepare a campaign on bolted bodies for the engine."""

import numpy as np

from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.structure_catalogue import (
    STRUCTURE_CATALOGUE,
)
from jointbench.analysis.gap.structure_bench.structure_effects import (
    StructureEffect,
    structure_candidates,
    without_effects,
)
from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    base_layout,
)
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitCampaign,
    record_blocks,
)
from jointbench.analysis.gap.structure_response.joint_state import state_of
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_response.table_errors import tuned_modes


def make_structure_bench(
    campaign: HitCampaign,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[StructureEffect, ...] = STRUCTURE_CATALOGUE,
    policy: Policy = STANDARD,
) -> StructureBench:
    """Prepare a campaign for the engine.

    Args:
        campaign: records, model and nominal parameters.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        policy: thresholds for its fits.

    Raises:
        UsageError: `without` holds a name that no entry has.
    """
    entries = without_effects(entries, without)
    hits = campaign.hits
    peak = np.abs(hits.response).max(axis=2)
    return StructureBench(
        campaign=campaign,
        layout=_layout(campaign),
        entries=entries,
        candidates=structure_candidates(entries, campaign),
        floor=STRUCTURE.coarse_floor,
        landing=np.zeros((len(hits.names), 4)),
        sigma=np.hypot(hits.noise, STRUCTURE.coarse_floor * peak),
        directions=None,
        reach=STRUCTURE.search_reach,
        blocks=record_blocks(campaign),
        scales=_scales(campaign),
        kept={},
        policy=policy,
    )


def _layout(campaign: HitCampaign) -> BaseLayout:
    """Return the base coordinates, with frequencies where the table is uncertain."""
    bodies, nominal = campaign.bodies, campaign.nominal
    bare = base_layout(bodies, nominal)
    state = state_of(bodies, nominal, bare, np.zeros(bare.sd.size))
    return base_layout(bodies, nominal, tuned_modes(campaign, state))


def _scales(campaign: HitCampaign) -> dict[str, float]:
    """Return the sizes that scale starts and bounds of effects."""
    bodies, nominal, hits = campaign.bodies, campaign.nominal, campaign.hits
    # The rigid motions of a mass-normalised table: phi = 1 / sqrt(mass) along an axis.
    rigid = bodies.omega < STRUCTURE.rigid_share * 2.0 * np.pi * hits.band
    motion = np.sum(bodies.points[0].rows[:, rigid] ** 2, axis=1)
    mass = 1.0 / float(np.min(motion))
    known = nominal.stiffness[np.isfinite(nominal.stiffness)]
    inside = (0.5 * np.pi * hits.band) ** 2 * mass / 2 / bodies.bolts.shape[0]
    stiffness = float(np.exp(np.mean(np.log(known)))) if known.size else inside
    force = float(np.abs(hits.raw_force).max())
    travel = force / stiffness / bodies.bolts.shape[0]
    speed = travel * np.pi * hits.band
    places = nominal.bolt_places
    moment = (
        stiffness
        * max(
            float(np.sum(places.var(axis=0))) if len(places) else 0.0,
            STRUCTURE.least_arm**2,
        )
        * max(len(places), 1)
    )
    return {
        "one": 1.0,
        "mass": mass,
        "stiffness": stiffness,
        "compliance": 1.0 / stiffness,
        "rocking": 1.0 / moment,
        "travel": travel,
        "stiffness/travel": stiffness / travel,
        "stiffness/travel^2": stiffness / travel**2,
        "damping/speed": float(nominal.damping[NORMAL]) / speed,
        "band": hits.band,
        "sample time": 1.0 / hits.sample_rate,
    }
