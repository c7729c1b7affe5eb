# SPDX-License-Identifier: MIT
"""Sites at the sensors and hammer points of a structure."""

from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign


def each_channel(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every response channel."""
    return tuple(Site("channel", name) for name in campaign.bodies.channels)


def turned_channels(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every channel whose other directions the modal table lists."""
    return each_channel(campaign) if len(campaign.bodies.across) else ()


def movable_channels(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every channel around whose sensor the modal table shows the surface."""
    known = campaign.bodies.around_channels
    return tuple(site for site in each_channel(campaign) if site.name in known)


def movable_points(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every hammer point around which the modal table shows the surface."""
    return tuple(Site("point", name) for name in campaign.bodies.around_points)
