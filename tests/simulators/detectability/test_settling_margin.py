# SPDX-License-Identifier: MIT
"""A law of the joint's stiffness is seen over its scatter as far as a mean is."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.simulators.detectability.base_refit import base_view
from jointbench.simulators.detectability.settling_margin import settled_shares
from jointbench.simulators.hidden.campaign_design import CampaignDesign, draw_design
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

SCATTER = 1.5e-3


@pytest.fixture(scope="module")
def design() -> CampaignDesign:
    """Return a design whose joint scatters."""
    return draw_design(5, hit_scatter=SCATTER)


def test_the_share_is_that_of_a_slope_over_its_sd(design: CampaignDesign) -> None:
    """Sharp records: the sd of a slope is the scatter over the pattern's spread."""
    quiet = replace(design, noise=1e-6)
    found = settled_shares(
        base_view(quiet), HiddenEffect("preload_stiffness", {"n": 0.01})
    )
    assert found is not None
    pattern = np.log([c.preload_ratio for c in design.conditions])
    spread = np.linalg.norm(pattern - pattern.mean())
    assert found[0] == pytest.approx(0.01 * spread / SCATTER, rel=1e-3)


def test_preload_is_distinguished_from_loosening_by_their_order(
    design: CampaignDesign,
) -> None:
    """The correlation is that of the two patterns over the records."""
    quiet = replace(design, noise=1e-6)
    found = settled_shares(base_view(quiet), HiddenEffect("loosening", {"frac": 1e-3}))
    assert found is not None
    pattern = np.log([c.preload_ratio for c in design.conditions])
    order = np.array([c.progress for c in design.conditions])
    alike = abs(np.corrcoef(pattern, order)[0, 1])
    assert found[1] == pytest.approx(alike, abs=0.01)
    assert found[2].startswith("preload_stiffness")


def test_a_joint_that_does_not_scatter_hides_nothing(design: CampaignDesign) -> None:
    """Then the samples say all, and so they do for other effects."""
    still = replace(design, hit_scatter=0.0)
    law = HiddenEffect("preload_stiffness", {"n": 0.01})
    assert settled_shares(base_view(still), law) is None
    assert (
        settled_shares(
            base_view(design), HiddenEffect("delay", {"tau": 1e-5, "dof": 0.0})
        )
        is None
    )
