# SPDX-License-Identifier: MIT
"""Axes of the joint about which it rocks, and the arms of the bolts."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE

AXES = ("x", "y")
ALONG_BOLTS = Site("joint", "normal")
"""Where a joint yields along its bolts that the model holds rigid."""


def joint_axes(campaign: HitCampaign) -> tuple[Site, ...]:
    """Return the axes of the joint from which bolts lie apart."""
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
