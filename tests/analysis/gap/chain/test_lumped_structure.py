"""Stiffness of a joint from the hits of one state of a lumped bench."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.chain.chain_records import LinkTest
from jointbench.analysis.gap.chain.lumped_structure import (
    read_lumped,
    repeated_elsewhere,
)
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.simulators.campaigns.campaign_records import noisy
from jointbench.simulators.hidden.campaign_design import (
    NOMINAL_SIGMA,
    CampaignDesign,
    draw_design,
    pulse_of,
)
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE

HITS = ((1, 30.0), (1, 200.0), (1, 1000.0), (1, 200.0), (0, 200.0), (0, 1000.0))


def one_state(seed: int, factor: float) -> tuple[Campaign, float]:
    """Return six hits with a joint of so many times its stiffness, and that [N/m]."""
    design: CampaignDesign = draw_design(
        seed, grid="small", noise=0.05, hit_scatter=0.001
    )
    rng, first = np.random.default_rng([seed, 79]), design.conditions[0]
    conditions = [
        replace(
            first,
            level=level,
            hit_dof=body,
            preload=1e4,
            preload_ratio=1.0,
            order=k,
            progress=0.0,
            pulse=pulse_of(level, rng),
            force_factor=1.0,
            joint_factor=factor,
        )
        for k, (body, level) in enumerate(HITS)
    ]
    design = replace(design, conditions=tuple(conditions))
    force, response = noisy(design, *simulate_records(design, ()))
    model = two_body_model(dict(design.nominal), dict(NOMINAL_SIGMA))
    count = len(HITS)
    campaign = Campaign(
        "one state",
        SAMPLE_RATE,
        force,
        response,
        np.array([body for body, _ in HITS]),
        np.array([level for _, level in HITS]),
        np.full(count, 1e4),
        np.arange(count, dtype=float),
        1e4,
        model,
    )
    return campaign, factor * design.physical["kj"]


@pytest.mark.parametrize(("seed", "factor"), [(8209, 1.9426), (8269, 2.604)])
def test_a_joint_far_from_its_nominal_stiffness_is_found(
    seed: int, factor: float
) -> None:
    """In the first 10 ms a joint 60 times too stiff fits as well as the right one."""
    campaign, stiffness = one_state(seed, factor)
    found = read_lumped([campaign], link=1).reading.before
    assert found.log_stiffness[0] == pytest.approx(np.log(stiffness), abs=0.02)


def test_a_deviation_that_another_preload_does_not_repeat_is_chance() -> None:
    """The structure counts as sound; with one preload alone the failure stays."""
    campaign, _ = one_state(8269, 1.0)
    sound = read_lumped([campaign], link=1).states
    failed = LinkTest(24139.5, 23808, passed=False, reason="chi2 would fall by 22")
    found = repeated_elsewhere(failed, sound, lambda line: None)
    assert found.passed
    assert "but not at 1e+04 N" in found.reason
    assert repeated_elsewhere(failed, (), lambda line: None) is failed
