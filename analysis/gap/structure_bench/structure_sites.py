# SPDX-License-Identifier: MIT
"""Sites of effects on bolted bodies."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.structure_bench.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_bench.joint_state import JointState
from jointbench.analysis.gap.structure_bench.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_bench.structure_effects import Sites
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE

AXES = ("x", "y")
ALONG = " normal"
"""Ending of a point at which something moves in the direction of the hit or sensor."""


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


def joint_axes(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return the axes of the joint from which bolts lie apart."""
    if campaign.bodies.rigid[NORMAL]:
        return ()
    return tuple(
        Site("joint", axis)
        for axis in AXES
        if np.ptp(bolt_arms(campaign, axis)) > STRUCTURE.least_arm
    )


def bolt_arms(campaign: HitCampaign, axis: str) -> FloatArray:
    """Return the distance of each bolt from an axis through their middle [m].

    Args:
        campaign: with the places of the bolts, or without: zero then.
        axis: x or y.
    """
    places = campaign.nominal.bolt_places
    if len(places) != len(campaign.bodies.bolts):
        return np.zeros(len(campaign.bodies.bolts))
    column = places[:, 1 - AXES.index(axis)]
    return np.asarray(column - column.mean())


def each_foot(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every foot."""
    return tuple(Site("foot", f"{k}") for k in range(len(campaign.bodies.feet)))


def each_body(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every body."""
    return tuple(Site("body", name) for name in campaign.bodies.bodies)


def each_place(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every point at which something may sit, free in all known directions."""
    places = campaign.bodies.places
    return tuple(Site("point", one.name) for one in places if len(one.rows))


def each_direction(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every point with a direction, along which alone something acts."""
    places = campaign.bodies.places
    return tuple(
        Site("point", f"{one.name}{ALONG}") for one in places if len(one.normal)
    )


def place_and_direction(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return the sites of both; a place known in one direction is listed once."""
    single = {p.name for p in campaign.bodies.places if len(p.rows) == 1}
    along = [
        site
        for site in each_direction(campaign)
        if site.name.removesuffix(ALONG) not in single
    ]
    return (*each_place(campaign), *along)


def each_channel(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every response channel."""
    return tuple(Site("channel", name) for name in campaign.bodies.channels)


def turned_channels(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every channel whose other directions the modal table lists."""
    return each_channel(campaign) if len(campaign.bodies.across) else ()


def place_of(campaign: HitCampaign, site: Site) -> tuple[int, bool]:
    """Return the index of a place, and whether it acts along its direction only."""
    names = [place.name for place in campaign.bodies.places]
    if site.name in names:
        return names.index(site.name), False
    return names.index(site.name.removesuffix(ALONG)), True


def tangential_ports(state: JointState, bolts: tuple[int, ...]) -> tuple[int, ...]:
    """Return the compliant joint freedoms across bolts."""
    return tuple(
        3 * k + d for k in bolts for d in range(NORMAL) if state.compliance[d] > 0.0
    )
