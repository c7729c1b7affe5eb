# SPDX-License-Identifier: MIT
"""The peaks are those of `scipy.signal.find_peaks`."""

import numpy as np
import pytest
from scipy.signal import find_peaks

from jointbench.signal.frf.prominent_peaks import prominent_peaks


@pytest.mark.parametrize("steps", [0, 6])
@pytest.mark.parametrize("distance", [1, 4, 25])
def test_peaks_of_rough_levels_are_those_of_scipy(steps: int, distance: int) -> None:
    """Also of levels in steps, whose maxima are flat and alike in height."""
    rng = np.random.default_rng(17 + distance)
    for prominence in (0.2, 1.0, 3.0):
        level = np.cumsum(rng.normal(size=400))
        if steps:
            # Flat tops; a slope of the whole makes no two of them equally high.
            level = np.repeat(np.round(level[::steps]), steps)
            level = level + 1e-6 * np.repeat(np.arange(level.size // steps), steps)
        expected, _ = find_peaks(level, prominence=prominence, distance=distance)
        found = prominent_peaks(level, prominence=prominence, distance=distance)
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("level", [[1.0], [1.0, 1.0], [0.0, 1.0], [3.0, 2.0, 1.0]])
def test_a_level_without_a_maximum_has_no_peak(level: list[float]) -> None:
    """An end of the record is none."""
    found = prominent_peaks(np.array(level), prominence=0.1, distance=1)
    assert found.size == 0
