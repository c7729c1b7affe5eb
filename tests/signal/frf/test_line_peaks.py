"""Peaks by distance and prominence, against `scipy.signal.find_peaks`."""

import numpy as np
import pytest
from scipy.signal import find_peaks

from jointbench.signal.frf.line_peaks import prominent_peaks


@pytest.mark.parametrize("seed", range(20))
def test_peaks_are_those_of_a_reference(seed: int) -> None:
    """Rounded noise has many plateaus, at its ends as well."""
    rng = np.random.default_rng(seed)
    values = np.cumsum(rng.normal(size=400)).round(1)
    prominence, distance = rng.uniform(0.1, 3.0), int(rng.integers(1, 30))
    expected, _ = find_peaks(values, prominence=prominence, distance=distance)
    found = prominent_peaks(values, prominence=prominence, distance=distance)
    assert found.tolist() == expected.tolist()


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0], [0.0] * 5, [0.0, 1.0, 0.0]])
def test_short_and_level_curves_have_a_peak_only_between_lower_values(
    values: list[float],
) -> None:
    """Only the last of these has one."""
    given = np.array(values)
    expected = [1] if values == [0.0, 1.0, 0.0] else []
    found = prominent_peaks(given, prominence=0.5, distance=1)
    assert found.tolist() == expected
