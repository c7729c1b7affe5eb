# SPDX-License-Identifier: MIT
"""Sparse matrices of a mesh, with element matrices added in place.

The pattern follows from the connectivity alone and is built once. Values are added
chunk by chunk into the compressed matrix: memory is that of the matrix, not that of
the triplets of all elements (20 times as much for hex20).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled

Sparse = sparse.csr_array
"""Sparse matrices, row by row."""

_Index = NDArray[np.int32 | np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class NodePattern:
    """Which nodes share an element: neighbours of each node, ascending.

    Attributes:
        starts: first neighbour of each node, and the end, shape (n_nodes + 1,).
        neighbours: of all nodes, in order, shape (n_pairs,).
    """

    starts: IntArray
    neighbours: NDArray[np.int32]

    @property
    def pairs(self) -> int:
        """Number of pairs of nodes."""
        return int(self.neighbours.size)


def node_pattern(cells: IntArray, n_nodes: int) -> NodePattern:
    """Return the pattern of elements.

    Args:
        cells: nodes of each element, shape (n_cells, n).
        n_nodes: of the mesh.

    Returns:
        The neighbours; a node without an element has none.
    """
    count, wide = cells.shape
    holds = sparse.csr_array(
        (
            np.ones(cells.size, np.int16),
            cells.ravel().astype(np.int32),
            np.arange(count + 1, dtype=np.int32) * np.int32(wide),
        ),
        shape=(count, n_nodes),
    )
    near = sparse.csr_array(holds.T @ holds)
    near.sort_indices()
    return NodePattern(near.indptr.astype(np.int64), near.indices.astype(np.int32))


def add_elements(
    values: FloatArray,
    pattern: NodePattern,
    cells: IntArray,
    blocks: FloatArray,
    kind_of: IntArray,
) -> None:
    """Add element matrices to the values of a compressed matrix.

    Args:
        values: of the matrix, changed in place, shape (width^2 n_pairs,): three rows
            of each node one after the other for width 3, one for width 1.
        pattern: of the mesh.
        cells: nodes of the elements, shape (n_cells, n).
        blocks: matrices of different elements, shape (n_kinds, n width, n width).
        kind_of: which matrix each element has, shape (n_cells,).
    """
    width = blocks.shape[1] // cells.shape[1]
    _scatter(
        values,
        (pattern.starts, pattern.neighbours),
        np.ascontiguousarray(cells),
        np.ascontiguousarray(blocks),
        np.ascontiguousarray(kind_of),
        width,
    )


def vector_matrix(values: FloatArray, pattern: NodePattern) -> Sparse:
    """Return the matrix whose values have been added with width 3.

    Args:
        values: shape (9 n_pairs,).
        pattern: of the mesh.

    Returns:
        Shape (3 n_nodes, 3 n_nodes).
    """
    degree = np.diff(pattern.starts)
    count = degree.size
    starts = np.concatenate([[0], np.cumsum(np.repeat(3 * degree, 3))])
    kind = _index_type(9 * pattern.pairs)
    columns = np.empty(9 * pattern.pairs, kind)
    _vector_columns(columns, pattern.starts, pattern.neighbours)
    return Sparse((values, columns, starts.astype(kind)), shape=(3 * count,) * 2)


def scalar_matrix(values: FloatArray, pattern: NodePattern) -> Sparse:
    """Return a matrix that is the same in each direction, such as a mass.

    Args:
        values: shape (n_pairs,).
        pattern: of the mesh.

    Returns:
        Shape (3 n_nodes, 3 n_nodes); directions are not coupled.
    """
    degree = np.diff(pattern.starts)
    count = degree.size
    starts = np.concatenate([[0], np.cumsum(np.repeat(degree, 3))])
    kind = _index_type(3 * pattern.pairs)
    columns = np.empty(3 * pattern.pairs, kind)
    repeated = np.empty(3 * pattern.pairs)
    _scalar_columns(columns, repeated, pattern.starts, pattern.neighbours, values)
    return Sparse((repeated, columns, starts.astype(kind)), shape=(3 * count,) * 2)


def _index_type(count: int) -> type[np.int32] | type[np.int64]:
    return np.int32 if count < np.iinfo(np.int32).max else np.int64


@compiled()
def _scatter(
    values: FloatArray,
    pattern: tuple[IntArray, NDArray[np.int32]],
    cells: IntArray,
    blocks: FloatArray,
    kind_of: IntArray,
    width: int,
) -> None:  # pragma: no cover - compiled
    starts, neighbours = pattern
    wide = cells.shape[1]
    for cell in range(cells.shape[0]):
        block = blocks[kind_of[cell]]
        for i in range(wide):
            node = cells[cell, i]
            low, high = starts[node], starts[node + 1]
            row = width * width * low
            long = width * (high - low)
            for j in range(wide):
                at = low + np.searchsorted(neighbours[low:high], cells[cell, j])
                for a in range(width):
                    begin = row + a * long + width * (at - low)
                    for b in range(width):
                        values[begin + b] += block[width * i + a, width * j + b]


@compiled()
def _vector_columns(
    columns: _Index, starts: IntArray, neighbours: NDArray[np.int32]
) -> None:  # pragma: no cover - compiled
    place = 0
    for node in range(starts.size - 1):
        for _ in range(3):
            for at in range(starts[node], starts[node + 1]):
                for b in range(3):
                    columns[place] = 3 * neighbours[at] + b
                    place += 1


@compiled()
def _scalar_columns(
    columns: _Index,
    repeated: FloatArray,
    starts: IntArray,
    neighbours: NDArray[np.int32],
    values: FloatArray,
) -> None:  # pragma: no cover - compiled
    place = 0
    for node in range(starts.size - 1):
        for a in range(3):
            for at in range(starts[node], starts[node + 1]):
                columns[place] = 3 * neighbours[at] + a
                repeated[place] = values[at]
                place += 1
