# SPDX-License-Identifier: MIT
"""The structure function is the plain mean over measured pairs, on any surface."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.surface.levelling import SurfaceTooSmall, level
from jointbench.signal.surface.structure_function import combine, structure_function


def walk(points: int, seed: int = 1) -> FloatArray:
    """Return a random walk of nanometre steps."""
    return np.cumsum(np.random.default_rng(seed).standard_normal(points)) * 1e-9


def profile(heights: FloatArray, valid: BoolArray | None = None) -> Profile:
    """Return a profile at 1 um spacing, gaps as zeros."""
    valid = all_valid(heights) if valid is None else valid
    return Profile("p", np.where(valid, heights, 0.0), 1e-6, valid)


def naive(heights: FloatArray, valid: BoolArray, lag: int) -> tuple[float, int]:
    """Return the mean squared difference and the pairs, point by point."""
    squares = [
        (heights[i + lag] - heights[i]) ** 2
        for i in range(heights.size - lag)
        if valid[i] and valid[i + lag]
    ]
    return float(np.mean(squares)), len(squares)


def test_values_are_the_mean_of_squared_differences():
    """Every default lag agrees with a loop over the points of the levelled profile."""
    surface = profile(walk(300))
    estimate = structure_function(surface)
    heights = level(surface).heights
    for lag, value, pairs in zip(
        np.rint(estimate.lag / 1e-6), estimate.value, estimate.pairs, strict=True
    ):
        mean, count = naive(heights, surface.valid, int(lag))
        assert value == pytest.approx(mean, rel=1e-12)
        assert pairs == count


def test_missing_points_drop_their_pairs_and_nothing_else():
    """With a third of the points missing, each lag averages the pairs that remain."""
    valid = np.random.default_rng(2).random(400) > 0.33
    surface = profile(walk(400), valid)
    estimate = structure_function(surface, lags=(1, 7, 40))
    heights = level(surface).heights
    expected = [naive(heights, valid, lag) for lag in (1, 7, 40)]
    assert_allclose(estimate.value, [mean for mean, _ in expected], rtol=1e-12)
    assert_allclose(estimate.pairs, [count for _, count in expected])


def test_a_height_offset_of_a_metre_changes_nothing():
    """Nanometre roughness on a metre of offset keeps its digits down to rounding."""
    plain = structure_function(profile(walk(500)))
    lifted = structure_function(profile(walk(500) + 1.0))
    assert_allclose(lifted.value, plain.value, rtol=1e-5)


def test_a_map_is_averaged_over_its_rows_and_along_y_over_its_columns():
    """The map along y is its transpose along x; counts are those of all rows."""
    heights = walk(40 * 60).reshape(40, 60)
    mask = all_valid(heights)
    along_x = structure_function(Areal("m", heights, (2e-6, 1e-6), mask))
    along_y = structure_function(Areal("m", heights, (2e-6, 1e-6), mask), direction="y")
    turned = structure_function(Areal("m", heights.T, (1e-6, 2e-6), mask.T))
    assert_allclose(along_y.value, turned.value, rtol=1e-12)
    assert_allclose(along_y.lag, turned.lag)
    assert (along_x.profiles, along_x.points) == (40, 60)
    assert along_x.pairs[0] == 40 * 59


def test_rows_that_repeat_each_other_are_recognised_as_one():
    """A ground lay leaves rows no distance apart; unrelated rows are far apart."""
    row = walk(256)
    same = np.tile(row, (32, 1))
    apart = np.array([walk(256, seed) for seed in range(32)])
    faces = [
        structure_function(Areal("m", z, (1e-6, 1e-6), all_valid(z))).samplings[0]
        for z in (same, apart)
    ]
    assert faces[0].row_distance < 0.01e-6
    assert faces[1].row_distance > 8e-6


def test_provenance_holds_levelling_and_lags():
    """The steps before the estimate stay, levelling among them."""
    estimate = structure_function(profile(walk(100)))
    assert [note.name for note in estimate.provenance] == [
        "level",
        "structure_function",
    ]


@pytest.mark.parametrize("lags", [(0, 1), (100,), ()])
def test_lags_beyond_the_profile_are_refused(lags: tuple[int, ...]):
    """Lag 0, a lag as long as the profile and no lag at all are usage errors."""
    with pytest.raises(UsageError, match="whole samples from 1 to 99"):
        structure_function(profile(walk(100)), lags=lags)


def test_a_profile_has_no_direction_y():
    """Asking a profile for its columns is a usage error."""
    with pytest.raises(UsageError, match="is a profile"):
        structure_function(profile(walk(100)), direction="y")


def test_a_comb_of_gaps_without_any_pair_is_refused():
    """Every third point measured leaves no pair at lag 1 or 2."""
    valid = np.arange(90) % 3 == 0
    with pytest.raises(SurfaceTooSmall, match="too full of gaps"):
        structure_function(profile(walk(90), valid), lags=(1, 2))


def test_two_faces_add():
    """S_e is the sum of both at the lags of the first, and shares add up to one."""
    a = structure_function(profile(walk(800, 3)))
    b = structure_function(profile(2 * walk(900, 4)))
    both = combine(a, b)
    inside = a.lag <= b.lag[-1]
    expected = a.value[inside] + np.exp(
        np.interp(np.log(a.lag[inside]), np.log(b.lag), np.log(b.value))
    )
    assert_allclose(both.value, expected, rtol=1e-12)
    assert sum(one.share for one in both.samplings) == pytest.approx(1.0)


def test_faces_without_a_common_lag_do_not_combine():
    """A surface measured at 1 mm spacing shares no lag with one of 0.3 mm length."""
    fine = structure_function(profile(walk(300)))
    heights = walk(300)
    coarse = structure_function(Profile("c", heights, 1e-3, all_valid(heights)))
    with pytest.raises(UsageError, match="share no lag"):
        combine(fine, coarse)
