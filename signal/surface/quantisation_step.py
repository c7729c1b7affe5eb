# SPDX-License-Identifier: MIT
"""Find the quantisation step of heights, if it is coarse enough to matter."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

FEWEST_LEVELS = 5
"""Least distinct heights; fewer are steps of the surface, not of a converter [-]."""
FEWEST_READINGS = 4
"""Least mean readings per level; with fewer the step is finer than the relief [-]."""
OFF_STEP = 0.02
"""Largest distance of a height from a whole number of steps [steps]."""
SAME_LEVEL = 1e-9
"""Heights closer than this share of their range are equal up to rounding [-]."""


def height_step(heights: FloatArray) -> float:
    """Return the step of which all heights are multiples, apart from an offset.

    Args:
        heights: measured ones [m], any shape.

    Returns:
        The step [m]; 0 for practically continuous heights.
    """
    met = np.unique(heights)
    if not FEWEST_LEVELS <= met.size <= heights.size / FEWEST_READINGS:
        return 0.0
    gaps = np.diff(met)
    gaps = gaps[gaps > SAME_LEVEL * (met[-1] - met[0])]
    if gaps.size < FEWEST_LEVELS - 1:
        return 0.0
    steps = np.rint(gaps / gaps.min())
    step = float(gaps.sum() / steps.sum())
    return step if np.all(np.abs(gaps / step - steps) < OFF_STEP) else 0.0
