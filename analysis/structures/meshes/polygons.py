# SPDX-License-Identifier: MIT
"""Convex polygons in a plane: patches of a joint, and shared areas of faces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData

_DISC_CORNERS = 48


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A convex part of a joint's plane.

    Attributes:
        corners: counter-clockwise, in the two tangential directions of the joint [m],
            shape (n_corners, 2).
    """

    corners: FloatArray

    def __post_init__(self) -> None:
        """Check that the patch has an area, and freeze it."""
        if polygon_area(self.corners) <= 0.0:
            raise BadData(
                f"a patch with corners {self.corners.tolist()} has no area; give low "
                "before high, and corners counter-clockwise"
            )
        freeze(self, "corners")


def rectangle(first: Sequence[float], second: Sequence[float]) -> Patch:
    """Return a patch between two coordinates in each tangential direction [m]."""
    (a, b), (c, d) = first, second
    if not (a < b and c < d):
        raise BadData(f"a patch {list(first)} by {list(second)} m; give low, then high")
    return Patch(np.array([[a, c], [b, c], [b, d], [a, d]], float))


def disc(centre: Sequence[float], radius: float) -> Patch:
    """Return a bolt spot: a polygon of 48 corners with the area of the disc [m]."""
    if radius <= 0:
        raise BadData(f"a bolt spot of radius {radius:g} m; it must be above zero")
    angle = 2 * np.pi * (np.arange(_DISC_CORNERS) + 0.5) / _DISC_CORNERS
    step = 2 * np.pi / _DISC_CORNERS
    # Of a regular polygon of n corners the area is n/2 r^2 sin(2 pi / n).
    reach = radius * np.sqrt(step / np.sin(step))
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Patch(np.asarray(centre, float) + reach * ring)


def polygon_area(corners: FloatArray) -> float:
    """Return the area of a polygon, positive if counter-clockwise [m^2]."""
    x, y = corners.T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def clip(subject: FloatArray, window: FloatArray) -> FloatArray:
    """Return the part of one convex polygon inside another.

    Args:
        subject: corners, counter-clockwise, shape (n, 2).
        window: corners, counter-clockwise, shape (m, 2).

    Returns:
        Corners of the shared polygon, shape (k, 2); k = 0 without overlap.

    Source:
        Sutherland and Hodgman 1974, Commun. ACM 17, 32-42.
    """
    result = subject
    for start, end in zip(window, np.roll(window, -1, axis=0), strict=True):
        if not result.shape[0]:
            break
        edge = end - start
        side = edge[0] * (result[:, 1] - start[1]) - edge[1] * (result[:, 0] - start[0])
        result = _cut(result, side)
    return result


def _cut(polygon: FloatArray, side: FloatArray) -> FloatArray:
    """Keep the corners where `side` >= 0, and the points where it crosses zero."""
    if np.all(side >= 0):
        return polygon
    kept: list[FloatArray] = []
    count = polygon.shape[0]
    for at in range(count):
        after = (at + 1) % count
        if side[at] >= 0:
            kept.append(polygon[at])
        if side[at] * side[after] < 0:
            share = side[at] / (side[at] - side[after])
            kept.append(polygon[at] + share * (polygon[after] - polygon[at]))
    return np.array(kept).reshape(-1, 2)


def fan(polygon: FloatArray) -> FloatArray:
    """Divide a convex polygon into triangles, shape (n - 2, 3, 2)."""
    count = polygon.shape[0]
    return np.stack([polygon[[0, at, at + 1]] for at in range(1, count - 1)])
