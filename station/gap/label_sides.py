# SPDX-License-Identifier: MIT
"""On which side of its place each name of a picture stands, clear of the others."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_LETTER = (6.5, 14.0)
"""Width and height of a letter [px]."""
_MARKER = 7.0
"""Half of the size of a marker with its margin [px]."""
_SIDES = {
    "middle right": (1.0, 0.0),
    "middle left": (-1.0, 0.0),
    "top center": (0.0, 1.0),
    "bottom center": (0.0, -1.0),
}


def clear_sides(
    places: FloatArray, texts: Sequence[str], preferred: Sequence[str], pixel: float
) -> list[str]:
    """Return the side of each name: as preferred, where that covers nothing.

    Args:
        places: in the picture, shape (2, n).
        texts: names.
        preferred: side of each, as Plotly's ``textposition``.
        pixel: extent of a pixel, in the unit of the places.
    """
    at = places.T / pixel
    taken = [_box(one, (_MARKER, _MARKER)) for one in at]
    found: list[str] = []
    for place, text, first in zip(at, texts, preferred, strict=True):
        sides = dict.fromkeys((first, *_SIDES))
        boxes = {side: _name_box(place, text, side) for side in sides}
        best = min(sides, key=lambda side: _covered(boxes[side], taken))
        found.append(best)
        taken.append(boxes[best])
    return found


def _name_box(place: FloatArray, text: str, side: str) -> FloatArray:
    """Return the box of a name at a side of its place [px], shape (2, 2)."""
    half = 0.5 * _LETTER[0] * len(text), 0.5 * _LETTER[1]
    away = np.array(_SIDES[side]) * (np.array(half) + _MARKER)
    return _box(place + away, half)


def _box(centre: FloatArray, half: tuple[float, float]) -> FloatArray:
    """Return the low and high corner of a box."""
    return np.stack([centre - half, centre + half])


def _covered(box: FloatArray, others: Sequence[FloatArray]) -> float:
    """Return the area of others that a box covers, in whole pixels."""
    stacked = np.stack(others)
    low = np.maximum(box[0], stacked[:, 0])
    high = np.minimum(box[1], stacked[:, 1])
    return float(np.round(np.prod(np.maximum(high - low, 0.0), axis=1).sum()))
