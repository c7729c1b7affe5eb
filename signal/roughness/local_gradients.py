# SPDX-License-Identifier: MIT
"""Local gradients of profiles and maps by seven points."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray

STENCIL = (45.0, -9.0, 1.0)
"""Factors of the differences over 2, 4 and 6 samples, over 60 [-] (ISO 21920-2:2021,
annex on local gradients, as ISO 4287:1997, 3.1.9): of sixth order."""
REACH = len(STENCIL)
_ROWS = 256
"""Rows of a map that are treated at a time."""


def line_gradients(heights: FloatArray, valid: BoolArray, spacing: float) -> FloatArray:
    """Return the gradients [-] where all seven points are measured, shape (m,)."""
    slope = _differences(heights, 0) / spacing
    return slope[_complete(valid, 0)]


def map_gradients(
    heights: FloatArray, valid: BoolArray, spacing: tuple[float, float]
) -> tuple[float, float]:
    """Return the root mean square gradient and the developed area ratio of a map.

    Args:
        heights: [m], shape (rows, columns).
        valid: False where a point is missing, same shape.
        spacing: along (rows, columns) [m].

    Returns:
        Sdq [-] and Sdr [-], means over the points whose neighbours are all measured;
        NaN where there are none.

    Source:
        ISO 25178-2:2021, 4.5: means of |grad z|^2 and of sqrt(1 + |grad z|^2) - 1.
    """
    complete = bool(valid.all())
    square, area, count = 0.0, 0.0, 0
    for start in range(REACH, heights.shape[0] - REACH, _ROWS):
        stop = min(start + _ROWS, heights.shape[0] - REACH)
        band = slice(start - REACH, stop + REACH)
        down = _differences(heights[band, REACH:-REACH], 0) / spacing[0]
        along = _differences(heights[start:stop], 1) / spacing[1]
        down *= down
        along *= along
        steep = down + along
        if not complete:
            rows = _complete(valid[band, REACH:-REACH], 0)
            steep = steep[rows & _complete(valid[start:stop], 1)]
        square += float(steep.sum())
        # sqrt(1 + s) - 1 without cancellation.
        area += float((steep / (1 + np.sqrt(1 + steep))).sum())
        count += steep.size
    if not count:
        return float("nan"), float("nan")
    return float(np.sqrt(square / count)), area / count


def _differences(heights: FloatArray, axis: int) -> FloatArray:
    """Return the gradient per sample, without the three outer points."""
    lines = np.moveaxis(heights, axis, 0)
    points = lines.shape[0]
    found = np.zeros((max(points - 2 * REACH, 0), *lines.shape[1:]))
    for step, factor in enumerate(STENCIL, start=1):
        ahead = lines[REACH + step : points - REACH + step]
        found += (factor / 60) * (ahead - lines[REACH - step : points - REACH - step])
    return np.moveaxis(found, 0, axis)


def _complete(valid: BoolArray, axis: int) -> BoolArray:
    """Return where all seven points are measured."""
    lines = np.moveaxis(valid, axis, 0)
    points = lines.shape[0]
    found = np.ones((max(points - 2 * REACH, 0), *lines.shape[1:]), dtype=np.bool_)
    for step in range(2 * REACH + 1):
        if step != REACH:
            found &= lines[step : points - 2 * REACH + step]
    return np.moveaxis(found, 0, axis)
