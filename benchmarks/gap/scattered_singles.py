# SPDX-License-Identifier: MIT
"""Campaigns with one effect whose hits scatter, sized by their margin.

The margin is that of the definition: squared distance of the records, weighted by their
noise and scatter, from the nearest rival *refitted* with all its parameters and those
of the base, over the number of parameters of the effect. A margin by first order may be
a hundred times larger: a hidden mode on one body is a hidden mode on the other one, to
the noise of most records.
"""

from dataclasses import dataclass, replace

import numpy as np
from scattered_campaigns import (
    LARGEST_DELAY,
    SIZES,
    Scatter,
    draw_scatter,
    heavy_noise,
)

from jointbench.simulators.campaigns.campaign_records import (
    SimulatedCampaign,
    size_to_margin,
)
from jointbench.simulators.detectability.expected_margin import (
    Margin,
    MarginScale,
    expected_margin,
    margin_scale,
)
from jointbench.simulators.hidden.campaign_design import CampaignDesign, draw_design
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE
from jointbench.simulators.hidden.effect_draws import CATALOGUE, draw_effect
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.hit_deviations import ScatterWays

LEAST_MARGIN = 50.0
LARGEST_MARGIN = 1e4
_TRIES = 3


@dataclass(frozen=True, slots=True)
class SingleTruth:
    """The effect of a campaign.

    Attributes:
        effect: at its size.
        margin: with all rivals refitted.
    """

    effect: HiddenEffect
    margin: Margin


def scattered_single(
    seed: int, way: str, size: float
) -> tuple[SimulatedCampaign | None, SingleTruth]:
    """Return a campaign with one effect, and its truth.

    Args:
        seed: of all draws; the effects take turns over the seeds.
        way: of scatter, one of `scattered_campaigns.WAYS`.
        size: relative size of the scatter [-].

    Returns:
        No campaign if the effect, at the largest size that is physical, does not reach
        the least margin over that scatter.
    """
    rng = np.random.default_rng([seed, 7])
    plain = draw_design(seed)
    scatter = draw_scatter(way, size, len(plain.conditions), rng)
    design = scattered_design(plain, way, size, scatter)
    scale = margin_scale(design)
    name = CATALOGUE[seed % len(CATALOGUE)]
    largest = draw_effect(name, scale.scales, rng)
    ends = np.log((LEAST_MARGIN, LARGEST_MARGIN))
    truth = sized(scale, largest, float(np.exp(rng.uniform(*ends))))
    if truth.margin.margin < LEAST_MARGIN:
        return None, truth
    force, acceleration = simulate_records(design, [truth.effect])
    force = force + FORCE_NOISE * design.noise * heavy_noise(rng, force.shape)
    acceleration = acceleration + design.noise * heavy_noise(rng, acceleration.shape)
    campaign = SimulatedCampaign(
        design, (truth.effect,), (truth.margin,), force, acceleration
    )
    return campaign, truth


def sized(scale: MarginScale, largest: HiddenEffect, wanted: float) -> SingleTruth:
    """Return an effect near a wanted margin, and not below the least one."""
    for _ in range(_TRIES):
        effect = size_to_margin(scale, largest, wanted)
        truth = SingleTruth(effect, expected_margin(scale, effect))
        if truth.margin.margin >= LEAST_MARGIN or effect == largest:
            break
        wanted *= 1.5 * LEAST_MARGIN / max(truth.margin.margin, 1.0)
    return truth


def scattered_design(
    design: CampaignDesign, way: str, size: float, scatter: Scatter
) -> CampaignDesign:
    """Return a design whose hits deviate, and whose margins count that."""
    hits = tuple(
        replace(
            condition,
            channel_gain=(float(gain[0]), float(gain[1])),
            force_delay=float(delay),
            joint_factor=float(joint),
        )
        for condition, gain, delay, joint in zip(
            design.conditions, scatter.gain, scatter.delay, scatter.joint, strict=True
        )
    )
    late = LARGEST_DELAY * size / max(SIZES) if way == "delay" else 0.0
    gains = 0.0 if way == "delay" else size / 10.0 if way == "bad" else size
    settling = size / 10.0 if way == "joint" else 0.0
    ways = ScatterWays(channel=gains, delay=late)
    return replace(design, conditions=hits, ways=ways, hit_scatter=settling)
