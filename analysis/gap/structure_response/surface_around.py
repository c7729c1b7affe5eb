# SPDX-License-Identifier: MIT
"""Motion of a surface around a sensor or a hammer point, from nodes of a modal table.

A sensor that sits centimetres beside its place, or hits that all aim at a wrong mark,
meet mode shapes that a derivative does not reach. Nodes of the surface around the place
give them: a polynomial in the two coordinates of the surface is fitted to each mode.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceAround:
    """Polynomials of the mode shapes on the surface around a place.

    Attributes:
        axes: indices of the two coordinates along the surface.
        scale: largest distance of a node along them [m], shape (2,).
        powers: of both coordinates over their scale, shape (n_terms, 2).
        coefficients: of the motion, shape (n_terms, 3, n_modes).
    """

    axes: tuple[int, int]
    scale: FloatArray
    powers: IntArray
    coefficients: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "scale", "powers", "coefficients")

    def in_modes(self, shapes: FloatArray) -> "SurfaceAround":
        """Return the surface in modes that are combinations, (n_modes, n_new)."""
        return replace(self, coefficients=self.coefficients @ shapes)

    def change(self, u: float, v: float) -> FloatArray:
        """Return the motion at an offset [m] less that at the place, (3, n_modes)."""
        there, here = self._terms(u, v), self._terms(0.0, 0.0)
        return np.asarray(np.tensordot(there - here, self.coefficients, 1))

    def change_of_slopes(self, u: float, v: float) -> FloatArray:
        """Return the change of the derivatives along both axes [1/m], (2, 3, n)."""
        there, here = self._slopes(u, v), self._slopes(0.0, 0.0)
        return np.asarray(np.tensordot(there - here, self.coefficients, 1))

    def _terms(self, u: float, v: float) -> FloatArray:
        x, y = np.array([u, v]) / self.scale
        return np.asarray(x ** self.powers[:, 0] * y ** self.powers[:, 1])

    def _slopes(self, u: float, v: float) -> FloatArray:
        x, y = np.array([u, v]) / self.scale
        i, j = self.powers.T
        along = i * x ** np.maximum(i - 1, 0) * y**j / self.scale[0]
        across = j * x**i * y ** np.maximum(j - 1, 0) / self.scale[1]
        return np.stack([along, across])


def surface_around(
    place: tuple[float, ...] | None, nodes: FloatArray, rows: FloatArray
) -> SurfaceAround | None:
    """Fit the motion of the surface around a place.

    The surface is the plane through the place, at right angles to x, y or z, that holds
    most nodes.

    Args:
        place: [m]; None if it is not known.
        nodes: of the body's surface [m], shape (n_nodes, 3).
        rows: their motion, shape (n_nodes, 3, n_modes).

    Returns:
        None where too few nodes are near.
    """
    if place is None:
        return None
    apart = nodes - np.asarray(place)
    near = np.linalg.norm(apart, axis=1) < STRUCTURE.surface_radius
    planes = [near & (np.abs(apart[:, k]) < STRUCTURE.surface_apart) for k in range(3)]
    normal = int(np.argmax([np.count_nonzero(plane) for plane in planes]))
    first, second = (k for k in range(3) if k != normal)
    return _fitted(apart, rows, planes[normal], (first, second))


def _fitted(
    apart: FloatArray, rows: FloatArray, chosen: BoolArray, axes: tuple[int, int]
) -> SurfaceAround | None:
    """Fit polynomials of the highest degree that the nodes allow."""
    offsets = apart[chosen][:, list(axes)]
    if len(offsets) < STRUCTURE.surface_nodes:
        return None
    scale = np.abs(offsets).max(axis=0)
    if scale.min() < STRUCTURE.surface_apart:
        return None
    powers = _powers(offsets)
    x, y = (offsets / scale).T
    terms = x[:, None] ** powers[:, 0] * y[:, None] ** powers[:, 1]
    wanted = rows[chosen].reshape(len(offsets), -1)
    found = np.linalg.lstsq(terms, wanted, rcond=STRUCTURE.surface_rank)[0]
    return SurfaceAround(axes, scale, powers, found.reshape(-1, *rows.shape[1:]))


def _powers(offsets: FloatArray) -> IntArray:
    """Return the powers of both coordinates in a polynomial, shape (n_terms, 2).

    Few rows of nodes along an edge allow low powers across them only, and there are
    two nodes for each term.
    """
    lines = [np.unique(np.round(one, 5)).size for one in offsets.T]
    highest = [min(STRUCTURE.surface_degree, max(n - 2, 1)) for n in lines]
    every = [
        (i, degree - i)
        for degree in range(STRUCTURE.surface_degree + 1)
        for i in range(degree + 1)
    ]
    kept = [(i, j) for i, j in every if i <= highest[0] and j <= highest[1]]
    return np.array(kept[: len(offsets) // 2])
