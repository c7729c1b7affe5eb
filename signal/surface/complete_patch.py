# SPDX-License-Identifier: MIT
"""The largest part of a map without gaps, as a two-dimensional spectrum needs it."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray
from jointbench.signal.surface.complete_lines import filled_line

_CELLS = 256
"""Cells per side in which the largest rectangle is searched for [-]."""


def complete_patch(heights: FloatArray, valid: BoolArray) -> FloatArray:
    """Return the largest rectangle of a map without gaps.

    Gaps of up to three points in rows with up to 2 % of them are interpolated along
    the row.

    Args:
        heights: [m], shape (n_rows, n_columns).
        valid: False where a point is missing, same shape.

    Returns:
        Heights [m], shape (n, m); a view of the map where it is complete, and an empty
        array where no point was measured.
    """
    if valid.all():
        return heights
    filled = heights.copy()
    known = valid.copy()
    for row in np.flatnonzero(~valid.all(axis=1)):
        line = filled_line(heights[row], valid[row]) if valid[row].any() else None
        if line is not None:
            filled[row], known[row] = line, True
    return filled[_largest_rectangle(known)]


def _largest_rectangle(known: BoolArray) -> tuple[slice, slice]:
    """Return rows and columns of the largest rectangle of True, by whole cells."""
    sides = [max(1, -(-n // _CELLS)) for n in known.shape]
    counts = [n // side for n, side in zip(known.shape, sides, strict=True)]
    kept = known[: counts[0] * sides[0], : counts[1] * sides[1]]
    split = kept.reshape(counts[0], sides[0], counts[1], sides[1])
    cells = np.asarray(split.all(axis=(1, 3)), dtype=np.bool_)
    best, found = 0, (slice(0, 0), slice(0, 0))
    depth = np.zeros(counts[1], dtype=np.int64)
    for row in range(counts[0]):
        depth = np.where(cells[row], depth + 1, 0)
        size, first, last, high = _widest_under(depth)
        if size > best:
            best = size
            found = (
                slice((row + 1 - high) * sides[0], (row + 1) * sides[0]),
                slice(first * sides[1], last * sides[1]),
            )
    return found


def _widest_under(depth: IntArray) -> tuple[int, int, int, int]:
    """Return area, first and last column and height of the largest one under a row.

    Source:
        Largest rectangle under a histogram by a stack of rising columns.
    """
    stack: list[tuple[int, int]] = []
    best = (0, 0, 0, 0)
    for column, high in enumerate([*depth.tolist(), 0]):
        start = column
        while stack and stack[-1][1] >= high:
            start, tall = stack.pop()
            area = tall * (column - start)
            if area > best[0]:
                best = (area, start, column, tall)
        stack.append((start, high))
    return best
