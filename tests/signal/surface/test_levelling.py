# SPDX-License-Identifier: MIT
"""Levelling removes a line or plane, and nothing else."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.surface.levelling import SurfaceTooSmall, level


def test_a_tilted_line_levels_to_nothing_and_its_slope_is_recorded():
    """A slope of 3 um per mm is removed whole and stands in the provenance."""
    heights = 1e-6 + 3e-3 * 1e-6 * np.arange(100)
    levelled = level(Profile("p", heights, 1e-6, all_valid(heights)))
    assert_allclose(levelled.heights, 0, atol=1e-18)
    assert levelled.provenance[-1].name == "level"
    assert dict(levelled.provenance[-1].detail)["slope"] == pytest.approx(3e-3)


def test_missing_points_do_not_bias_the_plane():
    """A plane with a hole levels to nothing where measured and stays 0 in the hole."""
    rows, columns = np.indices((30, 40))
    valid = all_valid(np.empty((30, 40)))
    valid[5:12, 8:30] = False
    heights = np.where(valid, 2e-6 + 1e-7 * rows - 4e-7 * columns, 0.0)
    levelled = level(Areal("m", heights, (1e-6, 2e-6), valid))
    assert_allclose(levelled.heights, 0, atol=1e-18)
    detail = dict(levelled.provenance[-1].detail)
    assert detail["slope_x"] == pytest.approx(-0.2)
    assert detail["slope_y"] == pytest.approx(0.1)


def test_a_surface_with_too_few_measured_points_is_refused():
    """Ten measured points are no surface; the message states the needed number."""
    heights = np.zeros(50)
    valid = np.arange(50) < 10
    with pytest.raises(SurfaceTooSmall, match="10 measured points, at least 16"):
        level(Profile("p", heights, 1e-6, valid))
