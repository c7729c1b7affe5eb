# SPDX-License-Identifier: MIT
"""Limits of a campaign: what its records cannot show, regardless of the fit."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.hit_scatter import repeat_groups


def campaign_limits(campaign: Campaign, policy: Policy = STANDARD) -> str:
    """Return the reason why the verdict must be `unknown`, or an empty text."""
    if campaign.continuous:
        return ""
    least = policy.least_records
    if campaign.force.shape[0] < least:
        return (
            f"{campaign.force.shape[0]} records are too few, at least {least} "
            "are required: hit each point at three levels, twice"
        )
    level = np.abs(campaign.force).max(axis=1)
    if level.max() < policy.one_level_ratio * level.min():
        return (
            f"all hits have one level ({level.min():.0f} to {level.max():.0f} N): "
            "effects that depend on level cannot be distinguished; hit at levels over "
            "a factor of 30"
        )
    if campaign.repeatability is None and not repeat_groups(
        campaign.hit, campaign.level, campaign.preload
    ):
        return (
            "no condition was measured twice, so the repeatability is unknown; "
            "repeat at least one point, level and preload"
        )
    return ""


def flat_tops(response: FloatArray, sigma: FloatArray) -> list[int]:
    """Return the records with flat tops: many samples at one common maximum.

    Args:
        response: shape (n_records, n_channels, n_samples).
        sigma: noise, shape (n_records, n_channels).
    """
    size = np.abs(response)
    top = size.max(axis=(0, 2))
    at_top = _pairs_above(size, top - JUDGEMENT.at_top_sd * sigma)
    near_top = _pairs_above(size, top - JUDGEMENT.near_top_sd * sigma)
    flat = (at_top >= JUDGEMENT.flat_samples) & (
        near_top < JUDGEMENT.edge_ratio * at_top
    )
    strong = top > JUDGEMENT.strong_sd * sigma
    return [int(i) for i in np.flatnonzero((flat & strong).any(axis=1))]


def _pairs_above(size: FloatArray, limit: FloatArray) -> IntArray:
    """Count neighbours that are both above a limit, shape (n_records, n_channels)."""
    near = size > limit[:, :, None]
    return np.asarray(np.sum(near[:, :, 1:] & near[:, :, :-1], axis=2))
