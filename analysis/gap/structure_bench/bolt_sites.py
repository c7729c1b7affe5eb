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
    bodies = campaign.bodies
    return tuple(Site("bolt", bodies.bolt_name(k)) for k in range(len(bodies.bolts)))


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
    """Return all bolts together and each joint, if a tangential direction moves."""
    if all(campaign.bodies.rigid[:NORMAL]):
        return ()
    joints = tuple(Site("joint", name) for name in campaign.bodies.joints)
    return (*all_bolts(campaign), *joints)


def each_sliding_bolt(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return `sliding_bolts` and every single bolt that is no joint of its own."""
    alone = [own for own in campaign.bodies.joints.values() if len(own) == 1]
    bolts = [site for k, site in enumerate(each_bolt(campaign)) if (k,) not in alone]
    together = sliding_bolts(campaign)
    return (*together, *bolts) if together else ()


def _bolts_at(campaign: HitCampaign, site: Site) -> tuple[int, ...]:
    """Return the bolts of a site: all, those of a joint, or one."""
    if site.kind == "bolts":
        return tuple(range(len(campaign.bodies.bolts)))
    return campaign.bodies.bolts_of(site.name)


def tangential_ports(
    campaign: HitCampaign, state: JointState, site: Site
) -> tuple[int, ...]:
    """Return the compliant joint freedoms across the bolts of a site."""
    return tuple(
        3 * k + d
        for k in _bolts_at(campaign, site)
        for d in range(NORMAL)
        if state.compliance[d] > 0.0
    )
