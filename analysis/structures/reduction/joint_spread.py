# SPDX-License-Identifier: MIT
"""The matrices of joints, each over the few coordinates that move it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class JointSpread:
    """G of every joint and direction, total 1 N/m.

    Attributes:
        size: number of coordinates.
        columns: coordinates of each group of directions.
        blocks: G over these, shape (n_directions, n_columns, n_columns) [1/kg].
    """

    size: int
    columns: tuple[IntArray, ...]
    blocks: tuple[FloatArray, ...]

    @classmethod
    def of_all(cls, matrices: FloatArray, size: int) -> "JointSpread":
        """Return the spread of matrices over all coordinates, shape (n, r, r)."""
        return cls(size, (np.arange(size),), (matrices.reshape(-1, size, size),))

    @property
    def count(self) -> int:
        """Number of parameters."""
        return sum(block.shape[0] for block in self.blocks)

    def total(self, values: FloatArray, base: FloatArray | None = None) -> FloatArray:
        """Return the sum of values times G, added to a base, shape (r, r)."""
        shape = (self.size, self.size)
        whole = np.zeros(shape) if base is None else np.array(base, float, order="C")
        flat = whole.reshape(-1)
        for own, columns, block in self._groups(values):
            if not np.any(own):
                continue
            part = own @ block.reshape(own.size, -1)
            if np.array_equal(columns, np.arange(self.size)):
                flat += part
            else:
                # A flat index takes half the time of rows and columns.
                flat[(columns[:, None] * self.size + columns).ravel()] += part
        return whole

    def between(self, shapes: FloatArray) -> FloatArray:
        """Return shapes' G shapes of all parameters, shape (n_parameters, m, m)."""
        count = shapes.shape[1]
        found = [np.zeros((0, count, count))]
        for columns, block in zip(self.columns, self.blocks, strict=True):
            moved = shapes[columns]
            found.append(moved.T @ (block @ moved))
        return np.concatenate(found)

    def diagonal(self, shapes: FloatArray) -> FloatArray:
        """Return the diagonal of `between`, shape (n_parameters, m)."""
        found = [np.zeros((0, shapes.shape[1]))]
        for columns, block in zip(self.columns, self.blocks, strict=True):
            moved = shapes[columns]
            found.append(np.einsum("rm,drm->dm", moved, block @ moved))
        return np.concatenate(found)

    def restricted(self, turn: FloatArray) -> "JointSpread":
        """Return the spread in fewer coordinates, `turn` from them to the present."""
        small = self.between(turn)
        small = 0.5 * (small + np.swapaxes(small, 1, 2))
        return JointSpread.of_all(small, turn.shape[1])

    def _groups(
        self, values: FloatArray
    ) -> Sequence[tuple[FloatArray, IntArray, FloatArray]]:
        edges = np.cumsum([0] + [block.shape[0] for block in self.blocks])
        return [
            (values[low:high], columns, block)
            for low, high, columns, block in zip(
                edges, edges[1:], self.columns, self.blocks, strict=False
            )
        ]
