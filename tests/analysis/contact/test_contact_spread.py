# SPDX-License-Identifier: MIT
import numpy as np
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.contact.draws import predict_interval
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.predict import predict_contact
from jointbench.analysis.contact.spread import ContactSpread

IRON = ContactMaterial(69.3e9, 2.265e9, 0.25)
JOINT = {"dimension": 2.5, "roughness": 1e-9, "material": IRON, "preload": 1e3}


def stiffness(**changes):
    return predict_contact(joint_case("ke_3d", **{**JOINT, **changes})).normal_stiffness


def half_width(interval):
    """Half the interval in ln K, in standard deviations of 95 %."""
    return np.log(interval.upper / interval.lower) / 2 / 1.95996


def test_a_joint_known_exactly_has_an_interval_of_no_width():
    """No spread: all three numbers are the prediction."""
    found = predict_interval(
        joint_case("ke_3d", spread=ContactSpread(), **JOINT), draws=50
    )
    wanted = [stiffness()] * 3
    assert_allclose((found.lower, found.median, found.upper), wanted, rtol=1e-12)


def test_the_interval_equals_first_order_propagation_where_spread_is_small():
    """Dimension and ln G correlated, preload and hardness on top: within 6 %."""
    spread = ContactSpread(0.004, 0.15, -0.8, preload=40.0, hardness=5e7)
    found = predict_interval(
        joint_case("ke_3d", spread=spread, **JOINT), draws=8000, seed=3
    )
    step = 1e-4
    by_dimension = np.log(
        stiffness(dimension=2.5 + step) / stiffness(dimension=2.5 - step)
    ) / (2 * step)
    by_log = np.log(
        stiffness(roughness=1e-9 * 1.01) / stiffness(roughness=1e-9 / 1.01)
    ) / (2 * np.log(1.01))
    by_load = np.log(stiffness(preload=1010.0) / stiffness(preload=990.0)) / 20
    harder = ContactMaterial(69.3e9, 2.265e9 * 1.01, 0.25)
    by_hardness = np.log(stiffness(material=harder) / stiffness()) / (0.01 * 2.265e9)
    first, second = by_dimension * 0.004, by_log * 0.15
    variance = first**2 + second**2 - 2 * 0.8 * first * second
    variance += (by_load * 40) ** 2 + (by_hardness * 5e7) ** 2
    assert_allclose(half_width(found), np.sqrt(variance), rtol=0.06)
    assert found.lower < found.median < found.upper


def test_correlation_of_dimension_and_roughness_matters():
    """The same standard deviations, opposite correlation, another interval."""
    widths = [
        half_width(
            predict_interval(
                joint_case(
                    "ke_3d", spread=ContactSpread(0.01, 0.2, sign * 0.95), **JOINT
                )
            )
        )
        for sign in (-1, 1)
    ]
    assert max(widths) > 2 * min(widths)


def test_the_same_seed_gives_the_same_interval():
    """Another seed does not."""
    spread = ContactSpread(dimension=0.02)
    first, again, other = (
        predict_interval(joint_case("ke_3d", spread=spread, **JOINT), seed=seed)
        for seed in (7, 7, 8)
    )
    assert first == again != other


def test_a_dimension_that_is_mostly_out_of_range_is_refused():
    """A centre in range does not help where the spread is wider than the range."""
    with pytest.raises(BadData, match="mostly outside"):
        predict_interval(
            joint_case("ke_3d", spread=ContactSpread(dimension=3.0), **JOINT)
        )


def test_draws_outside_the_range_are_counted():
    """The median stays a prediction of the model, the rejected share is reported."""
    found = predict_interval(
        joint_case("ke_3d", spread=ContactSpread(dimension=0.4), **JOINT)
    )
    assert_allclose(found.outside, 0.2113, atol=0.02)  # |z| > 1.25


@pytest.mark.parametrize("bad", [{"dimension": -1.0}, {"correlation": 1.2}])
def test_a_spread_that_cannot_be_is_refused(bad):
    """Negative standard deviations, correlations beyond one."""
    with pytest.raises(UsageError):
        ContactSpread(**bad)


@pytest.mark.parametrize("bad", [{"preload": 0.0}, {"dimension": 1.5}])
def test_a_centre_the_model_cannot_take_is_refused_as_without_spread(bad):
    """A preload of zero, a profile dimension for a surface model."""
    with pytest.raises(BadData, match=next(iter(bad))):
        predict_interval(
            joint_case(
                "ke_3d", spread=ContactSpread(0.01, preload=5.0), **{**JOINT, **bad}
            )
        )
