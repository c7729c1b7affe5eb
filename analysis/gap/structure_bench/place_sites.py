# SPDX-License-Identifier: MIT
"""Sites at bodies, feet and points of a structure."""

from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign

_ALONG = " normal"
"""Ending of a point at which something moves in the direction of the hit or sensor."""


def each_foot(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every foot."""
    return tuple(Site("foot", f"{k}") for k in range(len(campaign.bodies.feet)))


def each_body(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every body."""
    return tuple(Site("body", name) for name in campaign.bodies.bodies)


def each_meshed_body(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every body whose mesh shows what another thickness would change."""
    return tuple(Site("body", name) for name in campaign.bodies.thickness)


def each_place(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every point at which something may sit, free in all known directions."""
    places = campaign.bodies.places
    return tuple(Site("point", one.name) for one in places if len(one.rows))


def each_direction(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return every point with a direction, along which alone something acts."""
    places = campaign.bodies.places
    return tuple(
        Site("point", f"{one.name}{_ALONG}") for one in places if len(one.normal)
    )


def place_and_direction(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return the sites of both; a place known in one direction is listed once."""
    single = {p.name for p in campaign.bodies.places if len(p.rows) == 1}
    along = [
        site
        for site in each_direction(campaign)
        if site.name.removesuffix(_ALONG) not in single
    ]
    return (*each_place(campaign), *along)


def place_of(campaign: HitCampaign, site: Site) -> tuple[int, bool]:
    """Return the index of a place, and whether it acts along its direction only."""
    names = [place.name for place in campaign.bodies.places]
    if site.name in names:
        return names.index(site.name), False
    return names.index(site.name.removesuffix(_ALONG)), True
