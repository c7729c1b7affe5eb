"""The test at one more torque: closed forms of a line through logarithms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.analysis.design.fisher_plan import PairInformation, PlanPrior
from jointbench.analysis.design.torque_law import (
    TorqueLaw,
    TorqueRequest,
    TorqueTest,
    law_covariance,
    torque_steps,
)


def pair(precision: np.ndarray) -> PairInformation:
    """One sensor and one hit point without gain."""
    size = len(precision)
    return PairInformation(
        np.diag(precision)[None, None], np.zeros((1, 1, size)), np.ones((1, 1))
    )


def request(known: list[TorqueTest], scatter: float = 0.0) -> TorqueRequest:
    """A stiffness that changes with the torque, and a modulus that does not."""
    return TorqueRequest(
        tuple(known),
        PlanPrior(np.full(2, np.inf)),
        TorqueLaw(np.array([1.0 / 3.0, 0.0]), scatter),
        np.array([0]),
        np.array([0]),
    )


FIRST = TorqueTest(0.0, pair(np.array([1e4, 25.0])))


def test_two_torques_give_an_exponent_as_a_line_through_two_points() -> None:
    """Variance (s0^2 + s1^2 + 2 scatter^2)/x^2, beside the prior."""
    x, other = np.log(2.0), TorqueTest(np.log(2.0), pair(np.array([2500.0, 25.0])))
    found = law_covariance(request([FIRST], 0.03), [FIRST, other])
    line = (1e-4 + 4e-4 + 18e-4) / x**2
    assert_allclose(found[2, 2], 1.0 / (1.0 / line + 9.0), rtol=1e-6)
    (step,) = torque_steps(request([FIRST], 0.03), [other])
    assert_allclose(step.law_width, np.sqrt(found[2, 2]) * 3.0, rtol=1e-6)


def test_the_joint_is_narrowed_through_the_law_only() -> None:
    """Near the first torque it is a repeat; far away the open exponent takes it all.

    The modulus is the same in both.
    """
    near, far = (TorqueTest(x, FIRST.pairs) for x in (1e-6, 50.0))
    steps = torque_steps(request([FIRST]), [near, far])
    assert_allclose(steps[0].width, np.sqrt(0.5), rtol=1e-6)
    assert_allclose(steps[1].width, 1.0, atol=1e-4)
    whole = law_covariance(request([FIRST]), [FIRST, far])
    assert_allclose(whole[1, 1], 1.0 / 50.0, rtol=1e-6)


def test_what_a_state_departs_from_the_law_limits_its_gain() -> None:
    """A scatter far above the errors leaves the joint as it was."""
    (step,) = torque_steps(request([FIRST], 1.0), [TorqueTest(0.01, FIRST.pairs)])
    assert step.width == pytest.approx(1.0, abs=1e-4)


def test_a_gain_that_is_common_to_torques_is_found_once() -> None:
    """The gain of a sensor is better known after a second torque, and so the joint."""
    pairs = PairInformation(
        np.diag([1e4, 25.0])[None, None], np.array([[[8e3, 0.0]]]), np.full((1, 1), 1e4)
    )
    asked = request([TorqueTest(0.0, pairs)], 0.5)
    asked = TorqueRequest(
        asked.known,
        PlanPrior(np.full(2, np.inf), gain_sd=0.1),
        asked.law,
        asked.wanted,
        asked.judged,
    )
    (step,) = torque_steps(asked, [TorqueTest(1.0, pairs)])
    assert step.width < 0.999


@pytest.mark.parametrize(("ratio", "least", "most"), [(1.05, 0.0, 0.2), (8, 0.99, 1)])
def test_a_wider_span_of_torques_distinguishes_contact_laws(
    ratio: float, least: float, most: float
) -> None:
    """Powers 1/3, 1/2 and 1 differ by 1 to 3 % at 1.05 times, by 40 % at 8 times."""
    option = TorqueTest(float(np.log(ratio)), FIRST.pairs)
    (step,) = torque_steps(request([FIRST], 0.02), [option])
    assert least <= step.decides <= most
