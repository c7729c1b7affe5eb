"""Smooth sliders against their closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.mechanics.sliders import (
    UNKNOWN,
    SliderBank,
    curve_place,
    curve_value,
    iwan_bank,
    loading_table,
    move_slider,
)

TABLE, STEP = loading_table(2.0)


def test_the_loading_curve_of_sharpness_two_is_a_hyperbolic_tangent():
    """The solution of u' = 1 - u^2 is tanh(s)."""
    places = np.linspace(0, 6, 500)
    values = [curve_value(s, TABLE, STEP) for s in places]
    assert_allclose(values, np.tanh(places), atol=1e-10)


@pytest.mark.parametrize("sharpness", [8.0, 14.0, 20.0])
def test_a_sharp_curve_keeps_to_its_differential_equation(sharpness):
    """The slope of the tabulated curve is 1 - u^n wherever it is read."""
    table, step = loading_table(sharpness)
    places, h = np.linspace(0.01, 2, 300), 1e-5
    values = np.array([curve_value(s, table, step) for s in places])
    ahead = np.array([curve_value(s + h, table, step) for s in places])
    below = np.array([curve_value(s - h, table, step) for s in places])
    assert_allclose((ahead - below) / (2 * h), 1 - values**sharpness, atol=1e-5)


def test_places_are_found_again_from_values():
    """The inverse of tanh, up to where rounding hides it."""
    values = np.linspace(0, 0.999, 200)
    places = [curve_place(u, TABLE, STEP) for u in values]
    assert_allclose(places, np.arctanh(values), atol=1e-8)


def test_a_slider_unloads_along_a_straight_line_and_loads_the_other_way():
    """From tanh(1): straight down to 0, then the mirrored loading curve."""
    u, place = move_slider(0.0, UNKNOWN, 1.0, TABLE, STEP)
    assert_allclose(u, np.tanh(1), atol=1e-10)
    u, place = move_slider(u, place, -0.5, TABLE, STEP)
    assert_allclose(u, np.tanh(1) - 0.5, atol=1e-10)
    u, place = move_slider(u, place, -1.0, TABLE, STEP)
    assert_allclose(u, -np.tanh(1.5 - np.tanh(1)), atol=1e-10)


def test_reloading_joins_the_loading_curve_at_the_value_left():
    """After an unloading by 0.2 the curve continues from tanh(1) - 0.2."""
    u, place = move_slider(0.0, UNKNOWN, 1.0, TABLE, STEP)
    u, place = move_slider(u, place, -0.2, TABLE, STEP)
    u, place = move_slider(u, place, 0.7, TABLE, STEP)
    expected = np.tanh(np.arctanh(np.tanh(1) - 0.2) + 0.7)
    assert_allclose(u, expected, atol=1e-8)


def test_a_move_in_parts_ends_where_one_move_ends():
    """The flow has no step size."""
    whole, _ = move_slider(-0.3, UNKNOWN, 2.2, TABLE, STEP)
    u, place = -0.3, UNKNOWN
    for _ in range(11):
        u, place = move_slider(u, place, 0.2, TABLE, STEP)
    assert_allclose(u, whole, atol=1e-9)


def test_the_sliders_of_an_iwan_bank_share_its_stiffness():
    """Together they are as stiff as asked, and slip at most at phimax."""
    bank = iwan_bank(kt=1e7, phimax=8e-6, chi=-0.3, sharpness=12, count=30)
    assert_allclose(bank.stiffness.sum(), 1e7, rtol=1e-12)
    assert bank.slip.max() < 8e-6


def test_the_mean_slip_of_an_iwan_bank_is_that_of_its_power_law():
    """Density phi^(chi + 1) on 0..phimax: the mean is (chi+2)/(chi+3) of phimax."""
    bank = iwan_bank(kt=1.0, phimax=1.0, chi=-0.3, sharpness=12, count=12)
    assert_allclose(bank.stiffness @ bank.slip, 1.7 / 2.7, rtol=1e-12)


def test_a_slip_of_zero_is_refused():
    """Nothing divides by it later."""
    with pytest.raises(UsageError, match="positive slips"):
        SliderBank(np.array([1.0]), np.array([0.0]), 8.0)
