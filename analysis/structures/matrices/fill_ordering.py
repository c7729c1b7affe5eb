# SPDX-License-Identifier: MIT
"""Order the unknowns of a sparse symmetric matrix so that its factor stays small."""

import importlib.util

import numpy as np
from scipy.sparse import coo_array

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.analysis.structures.matrices.element_assembly import Sparse

# Up to this size minimum degree is as good.
_DISSECTED_FROM = 12_000
# Unknowns in a row that are ordered as one: the directions of a node. Where supports
# took some out the groups straddle nodes, which costs fill and no accuracy.
_GROUP = 3


def dissection_order(matrix: Sparse) -> IntArray | None:
    """Return the order of nested dissection, shape (n,), as old positions.

    Args:
        matrix: symmetric up to rounding, shape (n, n).

    Returns:
        The order; None for small matrices, and where METIS is not installed.

    Source:
        Karypis and Kumar 1998, SIAM J. Sci. Comput. 20, 359.
    """
    size = matrix.shape[0]
    if size < _DISSECTED_FROM or importlib.util.find_spec("pymetis") is None:
        return None
    import pymetis

    graph = _graph(matrix)
    order, _ = pymetis.nested_dissection(
        adjacency=pymetis.CSRAdjacency(
            graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
        )
    )
    found = _GROUP * np.asarray(order)[:, None] + np.arange(_GROUP)
    return np.asarray(found[found < size])


def _graph(matrix: Sparse) -> Sparse:
    """Return which groups share an entry, symmetric and without its diagonal.

    METIS does not return from a graph that is not symmetric, and a stiffness with
    zeros left out on one side of its diagonal is not.
    """
    row, column = (part // _GROUP for part in coo_array(matrix).coords)
    apart = row != column
    ends = np.stack([row[apart], column[apart]])
    both = np.concatenate([ends, ends[::-1]], axis=1)
    count = -(-matrix.shape[0] // _GROUP)
    graph = Sparse(
        coo_array((np.ones(both.shape[1], dtype=bool), both), shape=(count, count))
    )
    graph.sum_duplicates()
    return graph
