# SPDX-License-Identifier: MIT
"""The marble-plate rig of the 2025 paper as a lumped bench."""

from numpy.testing import assert_allclose

from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes

PLATE = 0.5 * 0.3 * 0.05 * 2600  # [kg]
STIFFNESS = 2.8667e7  # normal stiffness the paper identified [N/m]


def test_published_stiffness_under_one_plate_and_between_two():
    """19.5 kg: 193.0 Hz on the ground, 272.9 Hz between two free plates."""
    fixed = LumpedModel(
        (Body("plate", PLATE),), (Link("joint", ("ground", "plate"), STIFFNESS),)
    )
    free = LumpedModel(
        (Body("lower", PLATE), Body("upper", PLATE)),
        (Link("joint", ("lower", "upper"), STIFFNESS),),
    )
    assert_allclose(solve_modes(fixed).natural_frequency, [193.0], atol=0.05)
    assert_allclose(solve_modes(free).natural_frequency, [272.9], atol=0.1)


def test_published_damping_would_leave_no_mode_to_observe():
    """1.2713e7 N s/m is 270 times critical: the printed figure cannot be viscous."""
    model = LumpedModel(
        (Body("plate", PLATE),),
        (Link("joint", ("ground", "plate"), STIFFNESS, 1.2713e7),),
    )
    assert solve_modes(model).poles.size == 0
