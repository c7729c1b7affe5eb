# SPDX-License-Identifier: MIT
"""Paths of a panel: whole numbers on a fixed grid, no more points than can be seen."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray

WIDTH, HEIGHT = 8000, 4000
"""Units of a panel along x and along y; 1 of 8000 stays sharp when zoomed."""
_MOST_COLUMNS = 700
"""Stretches of a line of which the smallest and the largest value are drawn."""
_BEYOND = 20.0
"""How far beyond a panel a line is drawn [panels]: seen when zoomed out."""


def on_grid(x: FloatArray, y: FloatArray) -> tuple[IntArray, IntArray, BoolArray]:
    """Return places as whole numbers of a panel, y downwards, and which are known.

    Args:
        x: places along the panel, 0 to 1 [-], shape (n,).
        y: places up the panel, 0 to 1 [-], shape (n,).
    """
    known = np.isfinite(x) & np.isfinite(y)
    across = np.clip(np.where(known, x, 0.0), -_BEYOND, 1 + _BEYOND) * WIDTH
    down = (1.0 - np.clip(np.where(known, y, 0.0), -_BEYOND, 1 + _BEYOND)) * HEIGHT
    return np.rint(across).astype(np.int64), np.rint(down).astype(np.int64), known


def line_path(x: FloatArray, y: FloatArray) -> str:
    """Return a line through points, broken where one is not known."""
    across, down, known = on_grid(x, y)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(int), [0]])))
    return "".join(
        _run(*_envelope(across[a:b], down[a:b]))
        for a, b in edges.reshape(-1, 2).tolist()
    )


def _run(x: IntArray, y: IntArray) -> str:
    start = f"M{x[0]} {y[0]}"
    if x.size == 1:
        return start + "h0"
    steps = np.stack([np.diff(x), np.diff(y)], axis=1).ravel().tolist()
    return start + "l" + _joined(steps)


def _joined(steps: list[int]) -> str:
    """Return numbers with a blank only where the sign does not part them."""
    return "".join(f"{v}" if k == 0 or v < 0 else f" {v}" for k, v in enumerate(steps))


def _envelope(x: IntArray, y: IntArray) -> tuple[IntArray, IntArray]:
    """Return a long line with its smallest and largest value of each stretch."""
    if x.size <= 2 * _MOST_COLUMNS or np.any(np.diff(x) < 0):
        return x, y
    group = -(-x.size // _MOST_COLUMNS)
    whole = x.size - x.size % group
    rows = y[:whole].reshape(-1, group)
    start = np.arange(rows.shape[0]) * group
    pair = np.stack([start + rows.argmin(1), start + rows.argmax(1)], 1)
    kept = np.unique(np.concatenate([[0], pair.ravel(), [x.size - 1]]))
    return x[kept], y[kept]


def dots_path(x: FloatArray, y: FloatArray) -> str:
    """Return a path whose round ends are dots of the width of the stroke."""
    across, down, known = on_grid(x, y)
    across, down = across[known], down[known]
    if not across.size:
        return ""
    steps = zip(np.diff(across).tolist(), np.diff(down).tolist(), strict=True)
    moved = "".join(f"m{_joined([dx, dy])}h0" for dx, dy in steps)
    return f"M{across[0]} {down[0]}h0{moved}"


def area_path(x: FloatArray, low: FloatArray, high: FloatArray) -> str:
    """Return the area between two curves over the same places."""
    known = np.isfinite(x) & np.isfinite(low) & np.isfinite(high)
    if known.sum() < 2:
        return ""
    x, low, high = x[known], low[known], high[known]
    every = max(1, x.size // _MOST_COLUMNS)
    kept = np.unique(np.append(np.arange(0, x.size, every), x.size - 1))
    around = np.concatenate([x[kept], x[kept][::-1]])
    edge = np.concatenate([low[kept], high[kept][::-1]])
    across, down, _ = on_grid(around, edge)
    return _run(across, down) + "z"


def bars_path(left: FloatArray, right: FloatArray, low: float, high: float) -> str:
    """Return one box of a panel.

    Args:
        left: place of the left edge [-], shape (1,).
        right: place of the right edge [-], shape (1,).
        low: place of the lower edge [-].
        high: place of the upper edge [-].
    """
    across, down, _ = on_grid(np.concatenate([left, right]), np.array([low, high]))
    (x0, x1), (y0, y1) = across.tolist(), down.tolist()
    return f"M{x0} {y0}H{x1}V{y1}H{x0}z"


def spans_path(x: FloatArray, low: FloatArray, high: FloatArray) -> str:
    """Return upright lines from low to high at each place."""
    across, bottom, known = on_grid(x, low)
    _, top, also = on_grid(x, high)
    return "".join(
        f"M{a} {b}V{c}"
        for a, b, c in zip(
            across[known & also].tolist(),
            bottom[known & also].tolist(),
            top[known & also].tolist(),
            strict=True,
        )
    )


def level_spans_path(left: FloatArray, right: FloatArray, y: FloatArray) -> str:
    """Return level lines from left to right at each place."""
    begin, down, known = on_grid(left, y)
    end, _, also = on_grid(right, y)
    return "".join(
        f"M{a} {b}H{c}"
        for a, b, c in zip(
            begin[known & also].tolist(),
            down[known & also].tolist(),
            end[known & also].tolist(),
            strict=True,
        )
    )
