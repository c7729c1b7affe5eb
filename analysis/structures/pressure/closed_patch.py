# SPDX-License-Identifier: MIT
"""The closed part of a surface, its edge found within the elements.

Pressures vanish at the edge like a power of the distance; the approach of the surfaces
crosses its level at a slope. The edge is therefore a level of the approach.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.meshes.elements import triangle_rule
from jointbench.analysis.structures.pressure.interface_law import InterfaceLaw
from jointbench.analysis.structures.pressure.pressed_surface import PressedSurface
from jointbench.analysis.structures.pressure.pressure_totals import (
    OPEN,
    SurfacePoints,
)

_DEGREE = 3
"""Of the polynomial over a triangle [-]: as the shape functions on a plane face."""
_CUTS = 16
"""Parts of a triangle's side between which the edge is straight [-]."""


def open_share(
    points: SurfacePoints, law: InterfaceLaw, surface: PressedSurface
) -> float:
    """Return the share of the surface that is open [-].

    Args:
        points: of the surface, by triangles in the order of `triangle_rule`.
        law: of the interface.
        surface: pressures and gaps at the points.

    Returns:
        Area in which the pressure is below `OPEN` of the mean one, over the area of the
        surface. A triangle that a hole cuts counts with the points outside of it.
    """
    mean = float(points.area @ surface.pressure) / points.total
    closed = surface.pressure > 0
    approach = np.where(closed, law.approach(surface.pressure), -surface.gap)
    level = float(law.approach(np.array(OPEN * mean)))
    rule = triangle_rule()[0]
    area = points.area.reshape(-1, rule.shape[0]).sum(axis=1)
    above = (approach - level).reshape(-1, rule.shape[0])
    corners = _small_triangles(_CUTS)
    to_corners = _powers(corners.reshape(-1, 2)) @ np.linalg.pinv(_powers(rule))
    values = (above @ to_corners.T).reshape(area.size, -1, 3)
    share = float(area @ share_above_zero(values).mean(axis=1) / points.total)
    return 1.0 - share


def share_above_zero(values: FloatArray) -> FloatArray:
    """Return the share of each triangle in which a plane lies above 0 [-].

    Args:
        values: of the plane at the corners, shape (..., 3).

    Returns:
        Shape (...).
    """
    low, middle, high = np.moveaxis(np.sort(values, axis=-1), -1, 0)
    tiny = np.finfo(float).tiny
    top = high**2 / np.maximum((high - middle) * (high - low), tiny)
    bottom = low**2 / np.maximum((middle - low) * (high - low), tiny)
    cut = np.where(middle > 0, 1.0 - bottom, top)
    inside = np.where(low >= 0, 1.0, cut)
    return np.asarray(np.where(high <= 0, 0.0, inside))


def _small_triangles(cuts: int) -> FloatArray:
    """Return the corners of a divided unit triangle, shape (cuts^2, 3, 2)."""
    out = []
    for i in range(cuts):
        for j in range(cuts - i):
            out.append([(i, j), (i + 1, j), (i, j + 1)])
            if i + j < cuts - 1:
                out.append([(i + 1, j + 1), (i, j + 1), (i + 1, j)])
    return np.array(out, float) / cuts


def _powers(place: FloatArray) -> FloatArray:
    """Return the monomials up to the degree, shape (n, 10)."""
    x, y = place.T
    columns = [x**i * y**j for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
    return np.stack(columns, axis=1)
