# SPDX-License-Identifier: MIT
"""Gauss nodes on panels of time, and integrals from the start to each of them."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze

# Nodes of the quadrature in each panel, and carrier cycles that a panel may hold:
# four nodes a cycle leave 1e-7 at the edge of the band.
_NODES, _CYCLES = 12, 3.0
_LEAST_PANELS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Panels:
    """Nodes of a quadrature over time.

    Attributes:
        time: of the nodes [s], ascending, shape (n_nodes,).
        weight: of the quadrature [s], shape (n_nodes,).
        half: half the length of a panel [s].
    """

    time: FloatArray
    weight: FloatArray
    half: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "time", "weight")

    def integral(self, values: FloatArray) -> FloatArray:
        """Integrate from time 0 to each node.

        Args:
            values: at the nodes, shape (n_hits, n_nodes, n).

        Returns:
            Integrals, same shape.
        """
        hits, nodes, n = values.shape
        parts = values.reshape(hits, nodes // _NODES, _NODES, n)
        inside = self.half * (_inner()[1] @ parts)
        whole = self.weight[:_NODES] @ parts
        before = np.cumsum(whole, axis=1) - whole
        return np.asarray((inside + before[:, :, None]).reshape(values.shape))


def panels(length: float, width: float) -> Panels:
    """Return nodes on panels that are short beside one over the width of the band.

    Args:
        length: of the record [s].
        width: of the band [Hz].
    """
    count = max(_LEAST_PANELS, int(np.ceil(length * width / 2 / _CYCLES)))
    (point, weight), _ = _inner()
    edges = length * np.arange(count) / count
    half = 0.5 * length / count
    time = (edges[:, None] + half * (1.0 + point)).ravel()
    return Panels(np.asarray(time), np.tile(half * weight, count), half)


@cache
def _inner() -> tuple[tuple[FloatArray, FloatArray], FloatArray]:
    """Return Gauss points and weights, and the matrix that integrates from -1."""
    legendre = np.polynomial.legendre
    point, weight = legendre.leggauss(_NODES)
    table = legendre.legvander(point, _NODES - 1)
    integrals = np.array(
        [
            legendre.legval(point, legendre.legint(row, lbnd=-1.0))
            for row in np.eye(_NODES)
        ]
    ).T
    return (point, weight), np.asarray(integrals @ np.linalg.inv(table))
