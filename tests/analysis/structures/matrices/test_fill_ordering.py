# SPDX-License-Identifier: MIT
"""Nested dissection of sparse matrices before their factorisation."""

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.fill_ordering import dissection_order
from jointbench.analysis.structures.reduction.sparse_factor import Solver, factorise

pytest.importorskip("pymetis", reason="no wheel of METIS for this system")


def grid(count: int) -> Sparse:
    """Return the Laplacian of a cube of nodes with three equal directions each."""
    line = diags_array([-1.0, 2.1, -1.0], offsets=[-1, 0, 1], shape=(count, count))
    unit = eye_array(count)
    plane = kron(line, unit) + kron(unit, line)
    space = kron(plane, unit) + kron(eye_array(count**2), line)
    return Sparse(csr_array(kron(space, eye_array(3))))


def test_the_factor_in_the_order_of_dissection_is_smaller_than_by_minimum_degree() -> (
    None
):
    """SuperLU keeps fewer entries, in its own options but for the order."""
    matrix = grid(17)
    order = dissection_order(matrix)
    assert order is not None
    assert np.array_equal(np.sort(order), np.arange(matrix.shape[0]))
    ordered = csc_array(matrix[order][:, order])

    def entries(given: csc_array, way: str) -> int:
        options = {"SymmetricMode": True}
        return int(
            splu(given, permc_spec=way, diag_pivot_thresh=0.0, options=options).nnz
        )

    least = entries(csc_array(matrix), "MMD_AT_PLUS_A")
    assert entries(ordered, "NATURAL") < least


def test_a_solve_in_the_order_of_dissection_has_its_unknowns_where_they_were() -> None:
    """One load and several; entries left out on one side of the diagonal do no harm."""
    matrix = grid(17)
    matrix.data[np.flatnonzero(matrix.data == -1.0)[:50]] = 0.0
    one_sided = Sparse(0.5 * (matrix + matrix.T))
    matrix.eliminate_zeros()
    pattern = Sparse(one_sided)
    load = np.random.default_rng(1).standard_normal((pattern.shape[0], 2))
    solve = factorise(pattern, Solver.SUPERLU)
    assert np.allclose(pattern @ solve(load), load, rtol=0, atol=1e-10)
    assert np.allclose(solve(load)[:, 0], solve(load[:, 0]), rtol=0, atol=1e-12)
    assert dissection_order(matrix) is not None


def test_small_matrices_keep_the_order_of_minimum_degree() -> None:
    """Below some thousand unknowns nothing is gained."""
    assert dissection_order(grid(6)) is None
