# SPDX-License-Identifier: MIT
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.analysis.contact.damping import DampingChoice
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.spread import ContactSpread
from jointbench.analysis.contact.uncertainty import (
    SURFACE_INPUT,
    predict_uncertainty,
)

JOINT = {
    "dimension": 2.5,
    "roughness": 1e-9,
    "material": ContactMaterial(69.3e9, 2.265e9, 0.25, friction_factor=0.9),
    "preload": 1e3,
}
PLATE = DampingChoice(mass=19.5)
SMALL = ContactSpread(0.003, 0.1, -0.7, preload=40.0, hardness=5e7, friction=0.02)


def test_draws_and_first_order_agree_where_the_spread_is_small():
    """Five inputs at once, stiffness and damping: half widths of ln within 5 %."""
    found = predict_uncertainty(
        joint_case("friction_3d", spread=SMALL, damping=PLATE, **JOINT),
        draws=8000,
        seed=4,
    )
    for one in (found.stiffness, found.damping):
        low, high = one.first_order
        assert_allclose(
            one.interval.upper / one.interval.lower - 1, high / low - 1, rtol=0.05
        )
        assert one.interval.lower < one.interval.median < one.interval.upper


def test_shares_of_the_variance_add_up_and_are_sorted():
    """The first one is called dominant."""
    found = predict_uncertainty(
        joint_case("friction_3d", spread=SMALL, **JOINT)
    ).stiffness
    values = list(found.shares.values())
    assert_allclose(sum(values), 1.0)
    assert values == sorted(values, reverse=True)
    assert found.dominant == next(iter(found.shares))


@pytest.mark.parametrize(
    ("spread", "dominant"),
    [
        (ContactSpread(preload=300.0, hardness=1e6), "preload"),
        (ContactSpread(hardness=8e8, preload=1.0), "hardness"),
        (ContactSpread(dimension=0.05, preload=10.0), SURFACE_INPUT),
        (ContactSpread(friction=0.3, preload=1.0), "friction"),
    ],
)
def test_the_input_that_is_least_sure_dominates(spread, dominant):
    """Each in turn."""
    found = predict_uncertainty(
        joint_case("friction_3d", spread=spread, **JOINT), draws=50
    )
    assert found.stiffness.dominant == dominant


def test_friction_means_nothing_to_a_model_without_it():
    """Yield by the mean contact pressure."""
    spread = ContactSpread(friction=0.3)
    found = predict_uncertainty(
        joint_case("ke_3d", spread=spread, **JOINT), draws=50
    ).stiffness
    assert found.dominant is None
    assert_allclose(found.interval.upper, found.interval.lower, rtol=1e-12)


def test_damping_is_left_out_unless_it_is_asked_for():
    """No mass and no frequency, no damping."""
    found = predict_uncertainty(joint_case("ke_3d", spread=SMALL, **JOINT), draws=50)
    assert found.damping is None


def test_a_joint_without_stiffness_has_no_first_order_interval():
    """All contacts plastic: zero, and nothing dominates."""
    joint = JOINT | {"dimension": 2.05}
    found = predict_uncertainty(
        joint_case("ke_3d", spread=ContactSpread(hardness=1e8), **joint), draws=50
    ).stiffness
    assert found.first_order == (0.0, 0.0)
    assert found.dominant is None
