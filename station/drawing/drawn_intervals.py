# SPDX-License-Identifier: MIT
"""Intervals of the points of a trace."""

from collections.abc import Mapping

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.drawing.axis_scale import numbers_of


def interval_ends(
    trace: Mapping[str, object],
) -> tuple[FloatArray, FloatArray] | None:
    """Return the lower and upper ends of the intervals of a trace; None without any.

    Returns:
        Ends in the unit of y, each of shape (n,); NaN where there is none.
    """
    error = trace.get("error_y")
    if not isinstance(error, Mapping) or "array" not in error:
        return None
    y = numbers_of(trace.get("y"))
    above = _sized(numbers_of(error["array"]), y.size)
    minus = error.get("arrayminus")
    even = minus is None or error.get("symmetric") is True
    below = above if even else _sized(numbers_of(minus), y.size)
    return y - below, y + above


def _sized(values: FloatArray, size: int) -> FloatArray:
    found = np.full(size, np.nan)
    found[: min(size, values.size)] = values[:size]
    return found
