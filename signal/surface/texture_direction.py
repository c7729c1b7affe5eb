# SPDX-License-Identifier: MIT
"""The lay of a map: how heights vary across its rows compared with along them."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray

CROSS_LAGS = (1, 2, 4)
"""Row distances at which the lay of a map is judged [rows]."""
RATIO_LIMITS = (1e-3, 1e3)
"""Bounds of the lay: identical rows one side, independent rows the other [-]."""


def stretch_across(
    heights: FloatArray,
    valid: BoolArray,
    lag: FloatArray,
    value: FloatArray,
    across: float,
) -> float:
    """Return the factor on the row distance at which S across rows equals S along them.

    Args:
        heights: levelled rows [m], shape (n_rows, n_points).
        valid: False where a point is missing, same shape.
        lag: lags along the rows [m], shape (n_lags,).
        value: S along the rows [m^2], same shape.
        across: distance of neighbouring rows [m].

    Returns:
        1 on an isotropic map, near 0 where the rows repeat each other (a turned or
        ground lay along y), large where they are independent [-].
    """
    usable = value > 0
    if heights.shape[0] <= CROSS_LAGS[-1] or usable.sum() < 2:
        return 1.0
    ratios = []
    for rows in CROSS_LAGS:
        both = valid[rows:] & valid[:-rows]
        if not both.any():
            return 1.0
        squares = np.square(heights[rows:] - heights[:-rows])
        ratios.append(
            _equivalent(float(squares[both].mean()), lag[usable], value[usable])
            / (rows * across)
        )
    return float(np.clip(np.exp(np.mean(np.log(ratios))), *RATIO_LIMITS))


def _equivalent(difference: float, lag: FloatArray, value: FloatArray) -> float:
    """Return the lag along the rows at which S reaches `difference` [m]."""
    reached = np.flatnonzero(value >= difference)
    if difference <= 0:
        return float(lag[0]) * RATIO_LIMITS[0]
    if reached.size == 0:
        return float(lag[-1])
    k = int(reached[0])
    if k == 0:
        return float(lag[0]) * max(difference / float(value[0]), RATIO_LIMITS[0])
    low, high = np.log(value[k - 1 : k + 1])
    part = (np.log(difference) - low) / (high - low)
    return float(lag[k - 1] * (lag[k] / lag[k - 1]) ** part)
