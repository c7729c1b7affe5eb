# SPDX-License-Identifier: MIT
"""Finds the step in which heights were read, where it is coarse enough to matter."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

FEWEST_LEVELS = 5
"""Fewer distinct heights are steps of the surface, not of a converter [-]."""
FEWEST_READINGS = 4
"""Readings a level, on average, without which the step is finer than the relief [-]."""
OFF_STEP = 0.02
"""How far a height may lie from a whole number of steps [steps]."""
SAME_LEVEL = 1e-9
"""Heights nearer than this share of their range are the same up to rounding [-]."""


def height_step(heights: FloatArray) -> float:
    """Return the step of which all heights are multiples, apart from an offset.

    Args:
        heights: measured ones [m], any shape.

    Returns:
        The step [m]; 0 where heights are as good as continuous.
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
