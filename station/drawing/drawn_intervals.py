# SPDX-License-Identifier: MIT
"""Intervals of the points of a trace."""

from collections.abc import Mapping

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.drawing.axis_scale import numbers_of


def interval_ends(
    trace: Mapping[str, object], side: str = "y"
) -> tuple[FloatArray, FloatArray] | None:
    """Return the lower and upper ends of the intervals of a trace; None without any.

    Args:
        trace: of a figure.
        side: "x" or "y".

    Returns:
        Ends in the unit of that side, each of shape (n,); NaN where there is none.
    """
    error = trace.get(f"error_{side}")
    if not isinstance(error, Mapping) or "array" not in error:
        return None
    values = numbers_of(trace.get(side))
    above = _sized(numbers_of(error["array"]), values.size)
    minus = error.get("arrayminus")
    even = minus is None or error.get("symmetric") is True
    below = above if even else _sized(numbers_of(minus), values.size)
    return values - below, values + above


def _sized(values: FloatArray, size: int) -> FloatArray:
    found = np.full(size, np.nan)
    found[: min(size, values.size)] = values[:size]
    return found
