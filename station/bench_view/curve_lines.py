# SPDX-License-Identifier: MIT
"""Curves as rows of block characters, with numbers at their axes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

_BARS = " ▁▂▃▄▅▆▇█"
_EIGHTHS = len(_BARS) - 1
MARGIN = 9
"""Columns left of a curve, for the numbers of its axis."""


def curve_rows(
    values: Sequence[float], low: float, high: float, *, width: int, rows: int
) -> tuple[str, ...]:
    """Return values as bars from the lowest row up, the largest of each column.

    Args:
        values: of the curve; more than columns, or fewer.
        low: value of an empty column.
        high: value of a full one.
        width: columns.
        rows: of the terminal.
    """
    given = np.asarray(values, dtype=float)
    edges = np.linspace(0, given.size, width + 1).astype(int).tolist()
    last = given.size
    columns = [
        given[min(a, last - 1) : max(b, a + 1)].max() for a, b in pairwise(edges)
    ]
    share = (np.array(columns) - low) / max(high - low, 1e-30)
    heights = np.clip(np.round(share * rows * _EIGHTHS), 0, rows * _EIGHTHS).astype(int)
    return tuple(
        "".join(_BARS[int(np.clip(h - row * _EIGHTHS, 0, _EIGHTHS))] for h in heights)
        for row in reversed(range(rows))
    )


def with_axis(
    rows: Sequence[str], top: str, bottom: str, *, margin: int = MARGIN
) -> tuple[str, ...]:
    """Return rows with the values of the top and of the bottom at their left."""
    labels = [top, *[""] * (len(rows) - 2), bottom] if len(rows) > 1 else [top]
    cut = [label[: margin - 2] for label in labels]
    return tuple(
        f"{label:>{margin - 2}} │{row}" for label, row in zip(cut, rows, strict=True)
    )


def axis_line(low: float, high: float, unit: str, *, width: int) -> str:
    """Return the numbers below a curve: both ends, and what fits between."""
    count = max(2, min(6, width // 20))
    line = [" "] * width
    for number, value in enumerate(np.linspace(low, high, count)):
        last = number == count - 1
        text = f"{value:.0f} {unit}" if last else f"{value:.0f}"
        centre = round(number * (width - 1) / (count - 1))
        first = min(max(0, centre - len(text) // 2), width - len(text))
        line[first : first + len(text)] = text
    return "".join(line)
