# SPDX-License-Identifier: MIT
"""Errors of a modal table in closed modes, against tables drawn with such errors."""

from dataclasses import replace

import numpy as np
from bolted_bodies import NOMINAL, random_bodies, smooth_hits

from jointbench.analysis.gap.structure_response.base_layout import base_layout
from jointbench.analysis.gap.structure_response.closed_modes import real_modes
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import state_of
from jointbench.analysis.gap.structure_response.table_errors import tuned_modes

MADE = HitCampaign("made", random_bodies(), NOMINAL, smooth_hits())


def test_the_sd_of_closed_frequencies_is_that_of_drawn_tables() -> None:
    """Frequencies of the free modes drawn with their sd scatter the closed ones."""
    made = replace(MADE, nominal=replace(NOMINAL, table_sd=(0.005, 0.0)))
    layout = base_layout(made.bodies, made.nominal)
    state = state_of(made.bodies, made.nominal, layout, np.zeros(layout.sd.size))
    tuned = tuned_modes(made, state)
    assert tuned is not None
    whole = real_modes(made.bodies, state).omega
    at = [int(np.argmin(np.abs(whole - w))) for w in tuned.omega]
    rng = np.random.default_rng(498)
    drawn = []
    for _ in range(400):
        factor = np.exp(0.005 * rng.standard_normal(made.bodies.omega.size))
        bodies = replace(made.bodies, omega=made.bodies.omega * factor)
        drawn.append(np.log(real_modes(bodies, state).omega[at] / tuned.omega))
    np.testing.assert_allclose(np.std(drawn, axis=0), tuned.sd, rtol=0.15)


def test_an_exact_table_leaves_no_frequency_open() -> None:
    """Its modes are those of the bodies."""
    layout = base_layout(MADE.bodies, NOMINAL)
    state = state_of(MADE.bodies, NOMINAL, layout, np.zeros(layout.sd.size))
    assert tuned_modes(MADE, state) is None
