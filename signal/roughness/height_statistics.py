# SPDX-License-Identifier: MIT
"""Parameters of the distribution of heights, of profiles (R) and maps (S) alike."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_PIECE = 1 << 20
"""Heights summed at a time, so that a map needs no copy."""


def height_statistics(heights: FloatArray) -> dict[str, float | None]:
    """Return the parameters that depend on the distribution of heights only.

    Args:
        heights: measured ones about their reference line or plane [m], any shape.

    Returns:
        ``a`` arithmetic mean height [m], ``q`` root mean square [m], ``sk`` skewness
        [-] and ``ku`` kurtosis [-] (None for a plane, which has no deviation).

    Source:
        ISO 21920-2:2021, 4.3; ISO 25178-2:2021, 4.2.
    """
    flat = heights.reshape(-1)
    sums = np.zeros(4)
    for start in range(0, flat.size, _PIECE):
        one = flat[start : start + _PIECE]
        square = one * one
        sums += (np.abs(one).sum(), square.sum(), square @ one, square @ square)
    mean, second, third, fourth = (float(part) / flat.size for part in sums)
    root = float(np.sqrt(second))
    return {
        "a": mean,
        "q": root,
        "sk": third / root**3 if root > 0 else None,
        "ku": fourth / second**2 if root > 0 else None,
    }


def section_extremes(
    heights: FloatArray, known: FloatArray, sections: int
) -> dict[str, float]:
    """Return heights of peaks and valleys over the sections of a profile.

    Args:
        heights: [m], shape (n,).
        known: 1 where measured, 0 where missing, shape (n,).
        sections: equal parts of the evaluation length [-].

    Returns:
        ``p``, ``v`` and ``z``: means over the sections of the highest peak, deepest
        valley and total height [m]; ``t`` total height of all sections [m]. A section
        without a measured point does not count.

    Source:
        ISO 21920-2:2021, 4.4.
    """
    top = np.where(known > 0, heights, -np.inf)
    bottom = np.where(known > 0, heights, np.inf)
    parts = np.linspace(0, heights.size, sections + 1).round().astype(int)[:-1]
    high = np.maximum.reduceat(top, parts)
    low = np.minimum.reduceat(bottom, parts)
    met = np.isfinite(high)
    peak, valley = float(high[met].mean()), 0.0 - float(low[met].mean())
    return {
        "p": peak,
        "v": valley,
        "z": peak + valley,
        "t": float(high[met].max() - low[met].min()),
    }
