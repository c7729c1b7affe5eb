"""Gaussian regression filters against their definition, on open and closed profiles."""

import numpy as np
import pytest
from scipy.special import erf

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.roughness.gaussian_weights import QUADRATIC_ALPHA
from jointbench.signal.roughness.regression_filter import smooth_line, smooth_map
from jointbench.signal.roughness.robust_filter import smooth_robustly
from jointbench.signal.surface.gaussian_filter import GAUSSIAN_ALPHA

PITCH, INDEX, POINTS = 1e-6, 200e-6, 3000
PLACE = PITCH * np.arange(POINTS)
ALL = np.ones(POINTS)


def weights(place):
    """Return the weighting function of ISO 16610-21 for one sample."""
    width = GAUSSIAN_ALPHA * INDEX
    return np.exp(-np.pi * (place / width) ** 2) * PITCH / width


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("order", [0, 1])
def test_an_impulse_becomes_the_weighting_function(order, closed):
    impulse = (np.arange(POINTS) == 1500).astype(float)
    found = smooth_line(impulse, ALL, INDEX, PITCH, order=order, closed=closed)
    wanted = weights(PLACE - PLACE[1500])
    assert np.abs(found - wanted).max() < 1e-6 * wanted.max()


def test_an_impulse_at_the_seam_of_a_closed_profile_reaches_both_ends():
    impulse = (np.arange(POINTS) == 0).astype(float)
    found = smooth_line(impulse, ALL, INDEX, PITCH, closed=True)
    around = np.minimum(PLACE, POINTS * PITCH - PLACE)
    assert np.abs(found - weights(around)).max() < 1e-6 * weights(0.0)


def test_a_step_becomes_the_integral_of_the_weights():
    """Midway between two samples it is one half; the sum is off by h^2/24 g' = 7e-6."""
    step = (np.arange(POINTS) >= 1500).astype(float)
    found = smooth_line(step, ALL, INDEX, PITCH)
    edge = PLACE - (PLACE[1500] - 0.5 * PITCH)
    wanted = 0.5 * (1 + erf(np.sqrt(np.pi) * edge / (GAUSSIAN_ALPHA * INDEX)))
    inner = slice(300, -300)
    assert np.abs(found - wanted)[inner].max() < 8e-6


@pytest.mark.parametrize("order", [0, 1, 2])
def test_ends_and_gaps_keep_polynomials_of_the_order(order):
    """The moment criterion of ISO 16610-28, with a gap of a quarter nesting index."""
    share = ALL.copy()
    share[700:750] = 0
    form = 3 + (PLACE / 1e-3) ** order
    found = smooth_line(form * share, share, INDEX, PITCH, order=order)
    assert np.abs(found - form).max() < 1e-10


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_wave_of_the_nesting_index_keeps_half_its_amplitude(order):
    wave = np.cos(2 * np.pi * PLACE / INDEX)
    found = smooth_line(wave, ALL, INDEX, PITCH, order=order, closed=True)
    assert found.max() == pytest.approx(0.5, abs=2e-5)
    assert pytest.approx(0.7309, abs=5e-5) == QUADRATIC_ALPHA


def test_an_impulse_of_a_map_becomes_the_product_of_weights():
    """ISO 16610-61, with different pitches along rows and columns."""
    impulse = np.zeros((120, 240))
    impulse[60, 120] = 1
    found = smooth_map(impulse, np.ones(impulse.shape), 40e-6, (2e-6, 1e-6))
    width = GAUSSIAN_ALPHA * 40e-6
    down = 2e-6 * np.exp(-np.pi * (2e-6 * (np.arange(120) - 60) / width) ** 2)
    along = 1e-6 * np.exp(-np.pi * (1e-6 * (np.arange(240) - 120) / width) ** 2)
    wanted = np.outer(down, along) / width**2
    assert np.abs(found - wanted).max() < 2e-6 * wanted.max()


def test_a_map_with_one_missing_point_is_filtered_as_the_complete_one():
    """Two ways of computing agree, at edges and corners too."""
    rng = np.random.default_rng(1)
    heights = rng.normal(size=(90, 120)).cumsum(0).cumsum(1)
    share = np.ones(heights.shape)
    share[45, 60] -= 1e-12
    one, two = (smooth_map(heights, s, 30e-6, (1e-6, 1e-6)) for s in (share, share**0))
    assert np.abs(one - two).max() < 1e-9 * np.abs(heights).max()


def test_planes_of_maps_with_gaps_stay_planes():
    rows, columns = np.mgrid[:90, :120]
    plane = 1.0 + 2 * columns - 3 * rows
    share = (np.hypot(rows - 20, columns - 30) > 6).astype(float)
    found = smooth_map(plane * share, share, 30e-6, (1e-6, 1e-6))
    assert np.abs(found - plane).max() < 1e-9 * np.abs(plane).max()


def test_the_robust_filter_passes_below_grooves():
    """Deep grooves lower the linear filter, not the robust one."""
    heights = 0.01 * np.sin(2 * np.pi * PLACE / 50e-6)
    heights[np.abs(np.arange(POINTS) % 400 - 200) < 20] -= 1.0
    valid = np.ones(POINTS, dtype=bool)

    def smooth(share):
        return smooth_line(heights, share, INDEX, PITCH)

    linear, robust = smooth(ALL), smooth_robustly(heights, valid, smooth)
    assert linear.min() < -0.2
    assert np.abs(robust).max() < 0.02


def test_the_robust_filter_of_gaussian_heights_is_near_the_linear_one():
    """Biweights at three standard deviations have an efficiency of some 80 %."""
    heights = np.random.default_rng(2).normal(size=POINTS)

    def smooth(share):
        return smooth_line(heights, share, INDEX, PITCH)

    valid = np.ones(POINTS, dtype=bool)
    apart = smooth_robustly(heights, valid, smooth) - smooth(ALL)
    inner = slice(200, -200)
    assert np.std(apart[inner]) < 0.6 * np.std(smooth(ALL)[inner])


def test_a_nesting_index_below_two_samples_is_refused():
    with pytest.raises(UsageError, match="below two samples"):
        smooth_line(ALL, ALL, 1.5e-6, PITCH)
