# SPDX-License-Identifier: MIT
"""Sparse factors by SuperLU, ordered by METIS, or by Pardiso where it is installed.

Every solve is checked by its residual.
"""

import importlib.util
import weakref
from collections.abc import Callable
from enum import StrEnum

import numpy as np
from scipy.sparse import csc_array, triu
from scipy.sparse.linalg import splu

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.fill_ordering import dissection_order

Solve = Callable[[FloatArray], FloatArray]

# The residual of a solve relative to the size of matrix times solution.
_LARGEST_RESIDUAL = 1e-8
# Below this size SuperLU is faster: a call of Pardiso has an overhead.
_PARDISO_FROM = 12_000


class Solver(StrEnum):
    """Sparse solver."""

    AUTO = "auto"
    SUPERLU = "superlu"
    PARDISO = "pardiso"


def factorise(matrix: Sparse, solver: Solver = Solver.AUTO) -> Solve:
    """Factor a symmetric positive definite matrix.

    Args:
        matrix: shape (n, n).
        solver: AUTO uses Pardiso for large matrices if pypardiso is installed, else
            SuperLU.

    Returns:
        A function from right-hand sides, shape (n,) or (n, k), to solutions.

    Raises:
        BadData: the matrix is singular, or a solve leaves a large residual.
        UsageError: Pardiso is requested but not installed.
    """
    installed = importlib.util.find_spec("pypardiso") is not None
    if solver is Solver.PARDISO and not installed:
        raise UsageError(
            "solver 'pardiso' needs pypardiso; pip install 'jointbench[pardiso]', or "
            "use 'superlu'"
        )
    large = matrix.shape[0] > _PARDISO_FROM
    fast = solver is Solver.PARDISO or (installed and large and solver is Solver.AUTO)
    solve = _pardiso(matrix) if fast else _superlu(matrix)
    size = abs(matrix).max()

    def checked(load: FloatArray) -> FloatArray:
        answer = solve(load)
        _require_small_residual(matrix, load, answer, float(size))
        return answer

    return checked


def _require_small_residual(
    matrix: Sparse, load: FloatArray, answer: FloatArray, size: float
) -> None:
    # One column is checked: all use the same factor.
    load, answer = load.reshape(load.shape[0], -1), answer.reshape(load.shape[0], -1)
    column = int(np.argmax(np.abs(load).max(axis=0)))
    left = np.abs(matrix @ answer[:, column] - load[:, column]).max()
    scale = size * np.abs(answer[:, column]).max() + np.abs(load[:, column]).max()
    if not left <= _LARGEST_RESIDUAL * scale:
        raise BadData(
            f"a linear solve left a residual of {left / max(scale, 1e-300):.2g}, at "
            f"most {_LARGEST_RESIDUAL:g} is allowed; the matrix is near singular: "
            "check supports, joints and units"
        )


def _superlu(matrix: Sparse) -> Solve:
    order = dissection_order(matrix)
    ordered = matrix if order is None else matrix[order][:, order]
    try:
        factor = splu(
            csc_array(ordered),
            permc_spec="MMD_AT_PLUS_A" if order is None else "NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise BadData(
            f"the stiffness cannot be factored ({error}); a body or node is not "
            "connected: check supports and joints"
        ) from error

    def solve(load: FloatArray) -> FloatArray:
        if order is None:
            return np.asarray(factor.solve(np.ascontiguousarray(load)))
        answer = np.empty(load.shape)
        answer[order] = factor.solve(load[order])
        return answer

    return solve


def _pardiso(matrix: Sparse) -> Solve:
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError

    upper = Sparse(triu(matrix, format="csr"))
    upper.sort_indices()
    engine = PyPardisoSolver(mtype=2)
    # All parameters are set: with its defaults MKL from 2025 on fails (PyPardiso issue
    # 87). Nested dissection, two refinements, no pivoting.
    for place, value in {1: 1, 2: 2, 8: 2, 10: 8, 18: -1, 21: 1}.items():
        engine.set_iparm(place, value)
    try:
        engine.factorize(upper)
    except PyPardisoError as error:
        raise BadData(
            f"the stiffness cannot be factored (Pardiso: {error}); a body or node is "
            "not connected: check supports and joints"
        ) from error

    def solve(load: FloatArray) -> FloatArray:
        wanted = np.asfortranarray(load)
        return np.asarray(engine.solve(upper, wanted)).reshape(load.shape)

    weakref.finalize(solve, engine.free_memory, everything=True)
    return solve
