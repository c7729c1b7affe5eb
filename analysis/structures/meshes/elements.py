# SPDX-License-Identifier: MIT
"""Quadratic solid elements: shape functions, their slopes, quadrature, faces.

Node order is that of VTK and Abaqus: corners, then midsides.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.special import roots_jacobi

from jointbench.acquisition.basics.arrays import FloatArray, IntArray


class ElementKind(StrEnum):
    """The supported elements, by their number of nodes."""

    HEX20 = "hex20"
    TET10 = "tet10"


_HEX_CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ],
    float,
)
_HEX_EDGES = np.array(
    [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 0],
        [4, 5],
        [5, 6],
        [6, 7],
        [7, 4],
        [0, 4],
        [1, 5],
        [2, 6],
        [3, 7],
    ]
)
_TET_EDGES = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])
_HEX_FACES = np.array(
    [
        [0, 3, 2, 1, 11, 10, 9, 8],
        [4, 5, 6, 7, 12, 13, 14, 15],
        [0, 1, 5, 4, 8, 17, 12, 16],
        [1, 2, 6, 5, 9, 18, 13, 17],
        [2, 3, 7, 6, 10, 19, 14, 18],
        [3, 0, 4, 7, 11, 16, 15, 19],
    ]
)
_TET_FACES = np.array(
    [
        [0, 2, 1, 6, 5, 4],
        [0, 1, 3, 4, 8, 7],
        [1, 2, 3, 5, 9, 8],
        [2, 0, 3, 6, 7, 9],
    ]
)


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """One kind of element.

    Attributes:
        kind: which.
        edges: corners on both sides of each midside node, shape (n_midsides, 2).
        faces: nodes of each face, corners first, counter-clockwise seen from outside,
            shape (n_faces, n_face_nodes).
        corners: number of corner nodes.
        face_corners: number of corners of a face.
        centre: natural coordinates of the middle, shape (3,).
    """

    kind: ElementKind
    edges: IntArray
    faces: IntArray
    corners: int
    face_corners: int
    centre: FloatArray


HEX20 = Element(ElementKind.HEX20, _HEX_EDGES, _HEX_FACES, 8, 4, np.zeros(3))
TET10 = Element(ElementKind.TET10, _TET_EDGES, _TET_FACES, 4, 3, np.full(3, 0.25))
ELEMENTS = {ElementKind.HEX20: HEX20, ElementKind.TET10: TET10}


def shape_functions(
    kind: ElementKind, natural: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the shape functions and their slopes.

    Args:
        kind: of element.
        natural: coordinates, -1 to 1 (hex20) or in the unit simplex (tet10), shape
            (n_points, 3).

    Returns:
        Values, shape (n_points, n_nodes), and slopes by the natural coordinates,
        shape (n_points, n_nodes, 3).

    Source:
        Zienkiewicz and Taylor, The Finite Element Method, vol. 1 (2000), ch. 8.
    """
    if kind is ElementKind.HEX20:
        return _hex20(natural)
    return _tet10(natural)


def _hex20(natural: FloatArray) -> tuple[FloatArray, FloatArray]:
    value = np.empty((natural.shape[0], 20))
    slope = np.empty((natural.shape[0], 20, 3))
    factor = 1.0 + natural[:, None, :] * _HEX_CORNERS  # (points, corners, axes)
    product, bracket = factor.prod(axis=2), factor.sum(axis=2) - 5.0
    value[:, :8] = 0.125 * product * bracket
    for axis in range(3):
        others = factor[:, :, [a for a in range(3) if a != axis]].prod(axis=2)
        slope[:, :8, axis] = (
            0.125 * _HEX_CORNERS[:, axis] * (others * bracket + product)
        )
    middle = 0.5 * (_HEX_CORNERS[_HEX_EDGES[:, 0]] + _HEX_CORNERS[_HEX_EDGES[:, 1]])
    flat = middle == 0.0
    across = np.where(
        flat, 1.0 - natural[:, None, :] ** 2, 1.0 + natural[:, None, :] * middle
    )
    value[:, 8:] = 0.25 * across.prod(axis=2)
    rate = np.where(flat, -2.0 * natural[:, None, :], middle)
    for axis in range(3):
        others = across[:, :, [a for a in range(3) if a != axis]].prod(axis=2)
        slope[:, 8:, axis] = 0.25 * rate[:, :, axis] * others
    return value, slope


def _tet10(natural: FloatArray) -> tuple[FloatArray, FloatArray]:
    last = 1.0 - natural.sum(axis=1, keepdims=True)
    barycentric = np.concatenate([last, natural], axis=1)
    rate = np.concatenate([-np.ones((1, 3)), np.eye(3)])
    value = np.empty((natural.shape[0], 10))
    slope = np.empty((natural.shape[0], 10, 3))
    value[:, :4] = barycentric * (2.0 * barycentric - 1.0)
    slope[:, :4] = (4.0 * barycentric - 1.0)[:, :, None] * rate
    first, second = _TET_EDGES.T
    value[:, 4:] = 4.0 * barycentric[:, first] * barycentric[:, second]
    slope[:, 4:] = 4.0 * (
        barycentric[:, first, None] * rate[second]
        + barycentric[:, second, None] * rate[first]
    )
    return value, slope


def volume_rule(kind: ElementKind) -> tuple[FloatArray, FloatArray]:
    """Return 27 quadrature points and weights of the element's volume.

    Exact for the mass of straight-edged elements: degree 5 in each direction.

    Returns:
        Points, shape (27, 3), and weights, shape (27,); they add up to 8 or 1/6.

    Source:
        Stroud, Approximate Calculation of Multiple Integrals (1971), conical product.
    """
    if kind is ElementKind.HEX20:
        point, weight = np.polynomial.legendre.leggauss(3)
        grid = np.stack(np.meshgrid(point, point, point, indexing="ij"), axis=-1)
        return grid.reshape(-1, 3), np.einsum(
            "i,j,k->ijk", weight, weight, weight
        ).ravel()
    (a, wa), (b, wb), (c, wc) = (_unit_jacobi(power) for power in (2, 1, 0))
    x, y, z = np.meshgrid(a, b, c, indexing="ij")
    points = np.stack([x, y * (1 - x), z * (1 - x) * (1 - y)], axis=-1)
    return points.reshape(-1, 3), np.einsum("i,j,k->ijk", wa, wb, wc).ravel()


def triangle_rule() -> tuple[FloatArray, FloatArray]:
    """Return a rule of degree 7 on the unit triangle: exact for squares of faces.

    Returns:
        Points, shape (16, 2), and weights, shape (16,); they add up to 1/2.
    """
    (a, wa), (b, wb) = (_unit_jacobi(power, count=4) for power in (1, 0))
    x, y = np.meshgrid(a, b, indexing="ij")
    points = np.stack([x, y * (1 - x)], axis=-1).reshape(-1, 2)
    return points, np.outer(wa, wb).ravel()


def _unit_jacobi(power: int, *, count: int = 3) -> tuple[FloatArray, FloatArray]:
    """Gauss points for weight (1 - x)^power on 0 to 1."""
    point, weight = roots_jacobi(count, power, 0)
    return 0.5 * (1.0 + point), weight / 2.0 ** (power + 1)
