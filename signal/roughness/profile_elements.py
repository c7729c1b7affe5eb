# SPDX-License-Identifier: MIT
"""Profile elements: a hill and the dale next to it, by crossings of the mean line."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray

DISCRIMINATION = 0.1
"""Least height of a hill over Rp, and depth of a dale over Rv [-]."""


def profile_elements(
    heights: FloatArray, valid: BoolArray, spacing: float, limits: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Return widths and heights of the profile elements.

    Args:
        heights: about the mean line [m], shape (n,).
        valid: False where a point is missing, shape (n,); no element spans a gap.
        spacing: [m].
        limits: least height of a hill, and least depth of a dale [m].

    Returns:
        Widths [m] and heights [m] of all elements found from left to right and from
        right to left; both directions count, so that none is preferred.

    Source:
        ISO 21920-2:2021, annex on the crossing-the-line segmentation.
    """
    widths, tall = [], []
    for start, stop in _runs(valid):
        for line in (heights[start:stop], heights[start:stop][::-1]):
            places = _crossings(line, limits)
            for left, right in zip(places[:-2:2], places[2::2], strict=False):
                inside = line[int(np.ceil(left)) : int(np.floor(right)) + 1]
                widths.append((right - left) * spacing)
                tall.append(float(inside.max() - inside.min()))
    return np.array(widths), np.array(tall)


def _runs(valid: BoolArray) -> list[tuple[int, int]]:
    """Return starts and ends of the runs of measured points."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], valid.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _crossings(line: FloatArray, limits: tuple[float, float]) -> FloatArray:
    """Return where significant hills and dales follow each other [samples].

    Between a hill and a dale there may be several crossings of small waves; the last
    one counts, at which the next significant part begins.
    """
    above = line >= 0
    turns = np.flatnonzero(above[1:] != above[:-1]) + 1
    if turns.size < 2:
        return np.empty(0)
    starts = np.concatenate([[0], turns])
    hill = above[starts]
    extent = np.where(
        hill, np.maximum.reduceat(line, starts), -np.minimum.reduceat(line, starts)
    )
    large = np.flatnonzero(extent > np.where(hill, limits[0], limits[1]))
    # The first part is cut by the end of the line: its begin is no crossing.
    follows = large[1:][hill[large[1:]] != hill[large[:-1]]]
    place = starts[follows]
    before, after = line[place - 1], line[place]
    return np.asarray(place - 1 + before / (before - after), dtype=np.float64)
