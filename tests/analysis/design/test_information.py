"""The core of every plan: information, nuisances, covariances to expect."""

import numpy as np
from numpy.testing import assert_allclose

from jointbench.analysis.design.information import (
    expected_covariance,
    forecast_covariance,
    information_of,
    prior_information,
    without_nuisances,
)


def test_nuisances_leave_what_the_whole_inverse_leaves() -> None:
    """The wanted block of the inverse of the whole information."""
    slopes = np.random.default_rng(1).normal(size=(9, 5))
    whole = information_of(slopes)
    own = without_nuisances(whole[:2, :2], whole[:2, 2:], whole[2:, 2:])
    wanted = np.linalg.inv(whole)[:2, :2]
    assert_allclose(expected_covariance(own), wanted, rtol=1e-10)


def test_complex_data_inform_by_both_parts() -> None:
    """Real and imaginary parts as rows of their own; one matrix for each pair."""
    slopes = np.random.default_rng(2).normal(size=(2, 3, 6, 4, 2))
    both = np.concatenate([slopes[..., 0], slopes[..., 1]], axis=-2)
    found = information_of(slopes[..., 0] + 1j * slopes[..., 1])
    assert found.shape == (2, 3, 4, 4)
    assert_allclose(found, information_of(both), rtol=1e-12, atol=1e-12)


def test_an_open_parameter_does_not_spoil_the_others() -> None:
    """A parameter without data and prior beside one known to a part in 1e9."""
    whole = prior_information(np.array([1e-9, np.inf]))
    found = expected_covariance(whole)
    assert_allclose(found[0, 0], 1e-18, rtol=1e-12)
    assert found[1, 1] > 1e6


def test_a_forecast_is_the_spread_of_a_line_beyond_its_points() -> None:
    """Ends of a straight line through points of unit error: closed form."""
    x = np.linspace(-1.0, 1.0, 5)
    line = np.column_stack([np.ones(5), x])
    ahead = np.array([[1.0, 3.0]])
    found = forecast_covariance(ahead, information_of(line))
    assert_allclose(found, [[1 / 5 + 9.0 / np.sum(x**2)]], rtol=1e-12)
