# SPDX-License-Identifier: MIT
"""Sites at the bolts of a structure."""

import numpy as np

from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.structure_bench.structure_effects import Sites
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL


def where_rigid(name: str, directions: tuple[int, ...]) -> Sites:
    """Return the joint as a site if the model holds directions rigid."""

    def sites(campaign: HitCampaign) -> tuple[Site, ...]:
        rigid = all(campaign.bodies.rigid[d] for d in directions)
        return (Site("joint", name),) if rigid else ()

    return sites


def each_bolt(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every bolt."""
    count = campaign.bodies.bolts.shape[0]
    return tuple(Site("bolt", f"{k}") for k in range(count))


def each_sprung_bolt(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every bolt, if the normal direction moves."""
    return () if campaign.bodies.rigid[NORMAL] else each_bolt(campaign)


def all_bolts(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return all bolts together."""
    return (Site("bolts", "all"),)


def with_torques(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return all bolts together, if there are two torques or more."""
    return all_bolts(campaign) if np.unique(campaign.hits.torque).size > 1 else ()


def sliding_bolts(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return all bolts together, if a tangential direction moves."""
    return () if all(campaign.bodies.rigid[:NORMAL]) else all_bolts(campaign)


def each_sliding_bolt(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return all bolts together and every single one, if a tangential one moves."""
    rigid = all(campaign.bodies.rigid[:NORMAL])
    return () if rigid else (*all_bolts(campaign), *each_bolt(campaign))


def tangential_ports(state: JointState, bolts: tuple[int, ...]) -> tuple[int, ...]:
    """Return the compliant joint freedoms across bolts."""
    return tuple(
        3 * k + d for k in bolts for d in range(NORMAL) if state.compliance[d] > 0.0
    )
