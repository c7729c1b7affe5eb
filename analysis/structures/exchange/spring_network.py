# SPDX-License-Identifier: MIT
"""A symmetric matrix as a network of springs between degrees of freedom.

Programs without matrix input have springs: one of -K_ij between every two degrees of
freedom i and j, and one of the sum of row i to the ground. Many constants are negative;
the network is the matrix, exactly.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.structures.matrices.element_assembly import Sparse

# Constants below this share of the largest one are rounding.
_ROUNDING = 1e-13


@dataclass(frozen=True, slots=True, eq=False)
class SpringNetwork:
    """Springs between degrees of freedom, and to the ground.

    Degrees of freedom are numbered x, y, z, node by node.

    Attributes:
        first: degree of freedom of one end of each spring, shape (n,).
        second: of the other end; -1 for the ground, shape (n,).
        constant: [N/m], shape (n,).
    """

    first: IntArray
    second: IntArray
    constant: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "first", "second", "constant")


def network_of(matrix: Sparse) -> SpringNetwork:
    """Return the springs of a symmetric matrix.

    Args:
        matrix: [N/m], shape (n, n).

    Source:
        Off-diagonal terms of a spring of constant k between i and j are -k, diagonal
        ones +k.
    """
    upper = sparse.triu(matrix, 1).tocoo()
    ground = np.asarray(matrix.sum(axis=1)).ravel()
    own = np.flatnonzero(ground)
    first = np.concatenate([upper.row, own]).astype(np.int64)
    second = np.concatenate([upper.col, np.full(own.size, -1)]).astype(np.int64)
    constant = np.concatenate([-upper.data, ground[own]])
    large = np.abs(constant) > _ROUNDING * np.abs(constant).max(initial=0.0)
    return SpringNetwork(first[large], second[large], constant[large])


def matrix_of(network: SpringNetwork, size: int) -> Sparse:
    """Return the matrix of a network, shape (size, size) [N/m]."""
    tied = network.second >= 0
    i, j, k = network.first[tied], network.second[tied], network.constant[tied]
    held, value = network.first[~tied], network.constant[~tied]
    row = np.concatenate([i, j, i, j, held])
    column = np.concatenate([j, i, i, j, held])
    data = np.concatenate([-k, -k, k, k, value])
    whole = sparse.coo_array((data, (row, column)), shape=(size, size))
    return Sparse(whole.tocsr())
