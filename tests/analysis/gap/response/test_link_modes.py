# SPDX-License-Identifier: MIT
"""Modes between links are kept for the same inputs and for no others."""

from dataclasses import replace

import gap_bench as made
import numpy as np

from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.link_modes import link_modes


def test_modes_are_kept_for_the_same_inputs_and_for_no_others() -> None:
    """A base parameter, a settling or an array that was changed in place counts."""
    campaign = made.quiet_campaign()
    model, theta = campaign.model, campaign.model.nominal.copy()
    bench = make_bench(campaign)
    conditions = bench.excitation.conditions
    first = link_modes(model, theta, conditions, [0])
    assert link_modes(model, theta.copy(), conditions, [0]) is first
    settled = replace(conditions, settling=np.full(conditions.preload.size, 0.01))
    joint = [k for k, link in enumerate(model.links) if link.joint]
    other = link_modes(model, theta, settled, joint)
    assert not np.array_equal(
        other.poles, link_modes(model, theta, conditions, joint).poles
    )
    theta[0] *= 1.0 + 1e-9
    moved = link_modes(model, theta, conditions, [0])
    assert not np.array_equal(moved.poles, first.poles)
