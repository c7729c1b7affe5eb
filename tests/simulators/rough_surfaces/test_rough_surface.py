"""Surfaces of known dimension: the structure function is the stated one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import ShapeError, UsageError
from jointbench.simulators.rough_surfaces.brownian import (
    plane_variance,
    torus_covariance,
)
from jointbench.simulators.rough_surfaces.rough_surface import (
    rough_map,
    rough_profile,
    rough_rows,
    structure_constant,
    structure_of_line,
)

LAGS = np.array([1, 2, 4, 8, 16, 32])
KEYS = {"spacing": 0.5e-6, "roughness": 1e-9}


def _structure(heights):
    return np.array([np.mean((heights[:, n:] - heights[:, :-n]) ** 2) for n in LAGS])


def _dimension(structure):
    return 2 - np.polyfit(np.log(LAGS), np.log(structure), 1)[0] / 2


def test_the_constant_at_dimension_one_and_a_half_has_its_limit():
    """At s = 1: C = 2 pi (pi/2) / ln 1.5 = pi^2 / ln 1.5."""
    assert_allclose(structure_constant(1.5), np.pi**2 / np.log(1.5), rtol=1e-12)


@pytest.mark.parametrize("dimension", [1.2, 1.5, 1.8])
def test_independent_rows_have_the_stated_dimension_and_roughness(dimension):
    """Mean over 1,000 rows: D within 0.005, S within 4 % up to 32 steps."""
    rows = rough_rows(1000, 256, dimension=dimension, seed=3, **KEYS).heights
    found = _structure(rows)
    expected = structure_of_line(0.5e-6 * LAGS, dimension=dimension, roughness=1e-9)
    assert abs(_dimension(found) - dimension) < 0.005
    assert_allclose(found, expected, rtol=0.04)


@pytest.mark.parametrize("hurst", [0.05, 0.4, 0.5, 0.74, 0.8, 0.95])
def test_the_field_of_a_map_has_exactly_the_power_law(hurst):
    """On every distance of the map the variogram is 2 h^(2H), and none is clipped."""
    diagonal = np.hypot(20, 60)
    covariance = torus_covariance(diagonal, hurst)
    assert np.fft.fft2(covariance).real.min() > 0
    distance = np.hypot(*np.indices((21, 61))) / diagonal
    variogram = 2 * (covariance[0, 0] - covariance[:21, :61])
    variogram += 2 * plane_variance(hurst) * distance**2
    assert_allclose(variogram, 2 * distance ** (2 * hurst), atol=1e-12)


def test_maps_have_the_stated_dimension_along_both_directions():
    """Mean over 60 maps: S of rows and of columns within 5 % of the law."""
    expected = structure_of_line(0.5e-6 * LAGS, dimension=1.6, roughness=1e-9)
    along_x, along_y = np.zeros(LAGS.size), np.zeros(LAGS.size)
    for seed in range(60):
        heights = rough_map(48, 96, dimension=1.6, seed=seed, **KEYS).heights
        along_x += _structure(heights) / 60
        along_y += _structure(heights.T) / 60
    assert_allclose(along_x[:4], expected[:4], rtol=0.05)
    assert_allclose(along_y[:4], expected[:4], rtol=0.05)


def test_a_profile_is_the_same_for_the_same_seed_only():
    """Seeds make the realisation."""
    make = [rough_profile(64, dimension=1.5, seed=s, **KEYS).heights for s in (1, 1, 2)]
    assert np.array_equal(make[0], make[1])
    assert not np.array_equal(make[0], make[2])


def test_a_profile_has_mean_zero_and_the_stated_spacing():
    """Heights are about their mean line."""
    profile = rough_profile(500, dimension=1.4, seed=1, **KEYS)
    assert abs(profile.heights.mean()) < 1e-12 * np.abs(profile.heights).max()
    assert profile.spacing == 0.5e-6


def test_a_dimension_outside_one_to_two_is_refused():
    """A profile is more than a line and less than a plane."""
    with pytest.raises(UsageError, match="1 < D < 2"):
        rough_profile(64, dimension=2.4, seed=1, **KEYS)


def test_a_roughness_of_zero_is_refused():
    """A flat surface has no dimension."""
    with pytest.raises(ShapeError, match="roughness"):
        rough_map(8, 8, spacing=1e-6, dimension=1.5, roughness=0.0, seed=1)
