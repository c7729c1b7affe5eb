# SPDX-License-Identifier: MIT
"""The covariance of S is the exact one of Gaussian heights."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.fractal.map_covariance import map_sums
from jointbench.signal.fractal.structure_covariance import structure_covariance
from jointbench.signal.surface.structure_function import structure_function

LAGS = (1, 2, 5, 13, 40)


def noisy_power(lag: FloatArray) -> FloatArray:
    """Return S = lag^1.4 with white noise on top, lags in metres of unit spacing."""
    return np.where(lag > 0, lag**1.4 + 0.3, 0.0)


def test_one_profile_agrees_with_the_full_double_sum():
    """800 points: every entry within 1e-4 of the sum over all pairs of positions."""
    points = 800
    heights = np.random.default_rng(0).standard_normal(points)
    surface = Profile("p", heights, 1.0, all_valid(heights))
    found = structure_covariance(structure_function(surface, lags=LAGS))(noisy_power)
    expected = np.empty_like(found)
    for i, a in enumerate(LAGS):
        for j, b in enumerate(LAGS):
            d = np.arange(points - b)[None, :] - np.arange(points - a)[:, None]
            c = 0.5 * (
                noisy_power(np.abs(d - a).astype(float))
                + noisy_power(np.abs(d + b).astype(float))
                - noisy_power(np.abs(d).astype(float))
                - noisy_power(np.abs(d + b - a).astype(float))
            )
            scale = noisy_power(np.array([float(a), float(b)])).prod()
            expected[i, j] = 2 * np.mean(c**2) / scale
    assert_allclose(found, expected, rtol=1e-4)


def test_a_map_agrees_with_the_full_sum_over_rows():
    """24 rows of 60 points of an isotropic map: within 1 % of the four-fold sum."""
    rows, points = 24, 60
    heights = np.random.default_rng(0).standard_normal((rows, points))
    surface = Areal("m", heights, (1.0, 1.0), all_valid(heights))
    estimate = structure_function(surface, lags=(1, 4, 10))
    sampling = replace(estimate.samplings[0], row_distance=1.0)
    found = structure_covariance(replace(estimate, samplings=(sampling,)))(noisy_power)
    e = np.arange(rows)[:, None] - np.arange(rows)
    for i, a in enumerate((1, 4, 10)):
        d = np.arange(points - a)[None, :] - np.arange(points - a)[:, None]
        total = 0.0
        for across in range(rows):
            c = 0.5 * (
                noisy_power(np.hypot(d - a, across))
                + noisy_power(np.hypot(d + a, across))
                - 2 * noisy_power(np.hypot(d, across))
            )
            total += np.count_nonzero(np.abs(e) == across) * float(np.mean(c**2))
        expected = 2 * total / rows**2 / noisy_power(np.array([float(a)]))[0] ** 2
        assert found[i, i] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("row_distance", [0.4, 1.0, 2.5])
def test_a_map_agrees_with_the_full_sum_for_lags_of_all_lengths(row_distance: float):
    """80 rows of 120 points, even and odd lags: each entry within 5e-4."""
    rows, points, lags = 80, 120, np.array([1, 2, 5, 12, 24])
    sums = map_sums(lags, points, rows, row_distance)
    found = sums.covariance(noisy_power(sums.distance))
    across = np.arange(rows)
    weight = np.where(across > 0, 2, 1) * (rows - across) / rows**2
    row = row_distance * across[:, None]
    for i, a in enumerate(lags):
        for j, b in enumerate(lags[i:], start=i):
            d = np.arange(a - points + 1, points - b)
            pairs = np.minimum(points - a, points - b - d) - np.maximum(0, -d)
            c = 0.5 * (
                noisy_power(np.hypot(d - a, row))
                + noisy_power(np.hypot(d + b, row))
                - noisy_power(np.hypot(d, row))
                - noisy_power(np.hypot(d + b - a, row))
            )
            expected = 2 * weight @ (c**2 @ pairs) / ((points - a) * (points - b))
            assert found[i, j] == pytest.approx(expected, rel=5e-4)
            assert found[j, i] == found[i, j]


def test_random_walks_scatter_as_predicted():
    """400 Brownian profiles of 500 points: standard deviations within 4 sigma."""
    runs, points = 400, 500
    rng = np.random.default_rng(3)
    lags = np.array([1, 3, 10, 30])
    walks = np.cumsum(rng.standard_normal((runs, points)), axis=1)
    values = np.array(
        [np.mean((walks[:, lag:] - walks[:, :-lag]) ** 2, axis=1) for lag in lags]
    )
    surface = Profile("p", walks[0], 1.0, all_valid(walks[0]))
    relative = structure_covariance(structure_function(surface, lags=lags))(
        lambda lag: lag
    )
    measured = np.std(values, axis=1, ddof=1) / lags
    # The sd of a sd from 400 runs is 1 / sqrt(800), more for skewed values.
    assert_allclose(measured, np.sqrt(np.diag(relative)), rtol=4 * 1.4 / np.sqrt(800))


def test_missing_points_widen_the_scatter():
    """Losing 30 % of the points can only add variance, at every lag."""
    heights = np.random.default_rng(1).standard_normal(600)
    valid = np.random.default_rng(2).random(600) > 0.3
    full = Profile("p", heights, 1.0, all_valid(heights))
    gaps = Profile("p", np.where(valid, heights, 0), 1.0, valid)
    variances = [
        np.diag(structure_covariance(structure_function(s, lags=LAGS))(noisy_power))
        for s in (full, gaps)
    ]
    assert np.all(variances[1] > 1.3 * variances[0])
