# SPDX-License-Identifier: MIT
"""What a campaign cannot show, whatever the fit says: its own limits, in words."""

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.campaign import Campaign
from jointbench.analysis.gap.noise import repeat_groups

LEVEL_SPAN = 1.5
FLAT_SAMPLES = 6
MIN_RECORDS = 4


def campaign_limits(campaign: Campaign) -> str:
    """Return why no verdict but `unknown` can be given, or an empty text."""
    if campaign.continuous:
        return ""
    if campaign.force.shape[0] < MIN_RECORDS:
        return (
            f"{campaign.force.shape[0]} records are too few, at least {MIN_RECORDS} "
            "are needed: hit each point at three levels, twice"
        )
    level = np.abs(campaign.force).max(axis=1)
    if level.max() < LEVEL_SPAN * level.min():
        return (
            f"all hits have one level ({level.min():.0f} to {level.max():.0f} N): "
            "nothing that depends on it can be told apart; hit over 30x in level"
        )
    if campaign.repeatability is None and not repeat_groups(
        campaign.hit, campaign.level, campaign.preload
    ):
        return (
            "no condition was measured twice, so the repeatability is not known; "
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
    near = size > (top[None, :] - 5 * sigma)[:, :, None]
    run = near[:, :, 1:] & near[:, :, :-1]
    loud = top[None, :] > 50 * sigma
    hits = (run.sum(axis=2) >= FLAT_SAMPLES // 2) & loud
    return [int(i) for i in np.flatnonzero(hits.any(axis=1))]
