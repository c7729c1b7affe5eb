# SPDX-License-Identifier: MIT
"""Robust Gaussian regression filter: deep valleys and spikes have little weight."""

from collections.abc import Callable

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.roughness.regression_filter import known_share

TUKEY_LIMIT = 4.4478
"""Residual that gets no weight, over the median of all absolute residuals [-]: three
standard deviations of Gaussian heights (ISO 16610-31:2016, formula (6))."""
_SETTLED = 1e-3
"""Relative change of that limit at which the iteration ends [-]."""
_MOST_ROUNDS = 60
_NO_HEIGHT = 1e-300


def smooth_robustly(
    heights: FloatArray,
    valid: BoolArray,
    smooth: Callable[[FloatArray], FloatArray],
) -> FloatArray:
    """Return the long-wave part of a surface that few outlying points do not move.

    Args:
        heights: [m], any shape.
        valid: False where a point is missing, same shape.
        smooth: the regression filter, from weights [-] to heights [m].

    Returns:
        Filtered heights [m].

    Source:
        ISO 16610-31:2016, 5 and ISO 16610-71:2014: Tukey's biweights, iterated.
    """
    share = known_share(valid)
    found = smooth(share)
    limit = 0.0
    for _ in range(_MOST_ROUNDS):
        residual = np.where(np.isfinite(found), heights - found, 0.0)
        new = TUKEY_LIMIT * float(np.median(np.abs(residual[valid])))
        if new <= _NO_HEIGHT or abs(new - limit) <= _SETTLED * new:
            break
        limit = new
        inside = valid & (np.abs(residual) < limit)
        share = np.where(inside, (1 - (residual / limit) ** 2) ** 2, 0.0)
        better = smooth(share)
        found = np.where(np.isfinite(better), better, found)
    return found
