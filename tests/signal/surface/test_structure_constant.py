# SPDX-License-Identifier: MIT
"""The constant of the structure function, in both forms."""

import numpy as np
import pytest
from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.surface.structure_constant import (
    log_roughness,
    structure_constant,
)


@pytest.mark.parametrize("dimension", [1.1, 1.3, 1.49, 1.52, 1.75, 1.95])
def test_the_printed_constant_equals_its_textbook_form(dimension: float):
    """Away from D = 1.5, Gamma(2D-3) sin((2D-3) pi/2) / ((4-2D) ln 1.5)."""
    x = 2 * dimension - 3
    textbook = gamma_function(x) * np.sin(x * np.pi / 2) / (1 - x) / np.log(1.5)
    assert structure_constant(dimension, 1.5, "as-printed") == pytest.approx(textbook)


def test_the_printed_constant_passes_smoothly_through_one_and_a_half():
    """At D = 1.5 the limit is pi / (2 ln 1.5) = 3.87406."""
    assert structure_constant(1.5, 1.5, "as-printed") == pytest.approx(
        3.87406, abs=5e-6
    )
    near = structure_constant(1.5 + 1e-9, 1.5, "as-printed")
    assert near == pytest.approx(structure_constant(1.5, 1.5, "as-printed"), rel=1e-7)


def test_the_corrected_constant_carries_two_pi():
    """Heights of cos(2 pi gamma^n x) have (2 pi)^(4-2D) in their constant."""
    ratio = structure_constant(1.4) / structure_constant(1.4, 1.5, "as-printed")
    assert ratio == pytest.approx((2 * np.pi) ** 1.2)


def test_the_corrected_constant_is_that_of_a_weierstrass_sum():
    """S of a sum of waves, averaged over a period of its ripple, has G = 1.

    The waves are gamma^((D-2)n) cos(2 pi gamma^n x); the ripple is in ln lag.
    """
    dimension, gamma = 1.4, 1.5
    lags = np.exp(np.linspace(0, np.log(gamma), 200, endpoint=False))
    n = np.arange(-120, 60)[:, None]
    weight = gamma ** ((2 * dimension - 4) * n)
    total = np.sum(weight * (1 - np.cos(2 * np.pi * gamma**n * lags)), axis=0)
    mean = np.mean(total / lags ** (4 - 2 * dimension))
    assert mean == pytest.approx(structure_constant(dimension, gamma), rel=1e-3)


def test_the_roughness_inverts_the_structure_function():
    """From S = C G^(2(D-1)) lag^(4-2D) at one lag comes G back."""
    dimension, roughness, lag = 1.6, 3e-11, 5e-6
    factor = structure_constant(dimension) * roughness ** (2 * (dimension - 1))
    value = factor * lag ** (4 - 2 * dimension)
    found = np.exp(log_roughness(dimension, np.log(value), lag))
    assert found == pytest.approx(roughness, rel=1e-12)


@pytest.mark.parametrize(
    ("dimension", "gamma", "message"),
    [(1.0, 1.5, "between 1 and 2"), (2.1, 1.5, "between 1 and 2"), (1.5, 1.0, "gamma")],
)
def test_impossible_surfaces_are_refused(dimension: float, gamma: float, message: str):
    """D outside 1..2 and gamma not above 1 are usage errors."""
    with pytest.raises(UsageError, match=message):
        structure_constant(dimension, gamma)
