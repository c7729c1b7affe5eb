# SPDX-License-Identifier: MIT
"""Numbers for a plot: rounded, and thinned where there are too many."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Values = NDArray[np.floating[Any]]
_SIGNIFICANT_DIGITS = 6


def numbers(values: Any) -> list[float | None]:
    """Return numbers rounded for plotting; numbers that are not finite leave a gap."""
    array = np.asarray(values, dtype=np.float64)
    return [
        float(f"{v:.{_SIGNIFICANT_DIGITS}g}") if np.isfinite(v) else None for v in array
    ]


def thin(x: _Values, y: _Values, most: int) -> tuple[_Values, _Values]:
    """Thin a long line to about `most` points; the envelope is preserved."""
    if x.size <= most:
        return x, y
    group = -(-x.size // (most // 2))
    whole = x.size - x.size % group
    rows = y[:whole].reshape(-1, group)
    start = np.arange(rows.shape[0]) * group
    pair = np.sort(
        np.stack([start + rows.argmin(1), start + rows.argmax(1)], 1), axis=1
    )
    keep = np.unique(np.append(pair.ravel(), x.size - 1))
    return x[keep], y[keep]
