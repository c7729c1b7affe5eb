"""The direction of the lay of a map with a single spike."""

import numpy as np

from jointbench.signal.roughness.texture_spatial import lay_direction


def test_a_spike_has_some_direction() -> None:
    """No power lies within half a bin of the strongest direction; it is an angle."""
    heights = np.zeros((64, 64))
    heights[3, 3] = 1.0
    rows, columns = np.mgrid[:64, :64]
    plane = np.column_stack([np.ones(4096), rows.ravel(), columns.ravel()])
    fit = np.linalg.lstsq(plane, heights.ravel(), rcond=None)[0]
    heights -= (plane @ fit).reshape(64, 64)
    noise = np.random.default_rng(161).standard_normal((64, 64))
    heights += 161e-6 * noise
    found = lay_direction(heights, np.ones(heights.shape, np.bool_), (1e-5, 1e-5))
    assert found is not None
    assert 0 <= found < np.pi
