# SPDX-License-Identifier: MIT
"""The matrices of joints, each over the few coordinates that move it."""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class JointSpread:
    """G of every joint and direction, total 1 N/m.

    Attributes:
        size: number of coordinates.
        columns: coordinates of each group of directions.
        blocks: G over these, shape (n_directions, n_columns, n_columns) [1/kg].
        entries: of each group, in the whole matrix row by row; None is all of it.
    """

    size: int
    columns: tuple[IntArray, ...]
    blocks: tuple[FloatArray, ...]
    entries: tuple[IntArray | None, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Find the entries once."""
        entries = tuple(self._entries(own) for own in self.columns)
        object.__setattr__(self, "entries", entries)

    def _entries(self, columns: IntArray) -> IntArray | None:
        if np.array_equal(columns, np.arange(self.size)):
            return None
        return np.asarray((columns[:, None] * self.size + columns).ravel())

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
        low = 0
        for entries, block in zip(self.entries, self.blocks, strict=True):
            own = values[low : low + block.shape[0]]
            low += own.size
            if not np.any(own):
                continue
            part = own @ block.reshape(own.size, -1)
            # A flat index takes half the time of rows and columns.
            if entries is None:
                flat += part
            else:
                flat[entries] += part
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
