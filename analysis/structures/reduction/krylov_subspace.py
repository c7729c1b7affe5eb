# SPDX-License-Identifier: MIT
"""Orthonormal bases, and a block Lanczos iteration that also finds multiple modes.

A single-vector iteration misses copies of a multiple eigenvalue (the six rigid
motions of a free body): ARPACK did, on simulated plates.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.reduction.sparse_factor import Solve

# Remainder of a direction after projection below which it is dropped.
_DEPENDENT = 1e-6
# Relative residual of each Ritz vector of the inverse: its square is the eigenvalue's
# error.
_CONVERGED = 1e-7
_BLOCK = 8
_MOST_STEPS = 80


def orthonormalise(basis: FloatArray, mass: Sparse, new: FloatArray) -> FloatArray:
    """Return the part of `new` outside of `basis`, orthonormal in M.

    Args:
        basis: orthonormal in M, shape (n, r).
        mass: M.
        new: directions, shape (n, k).

    Returns:
        Shape (n, at most k); directions that depend on others are dropped.
    """
    size = np.sqrt(np.einsum("nk,nk->k", new, mass @ new))
    kept = new[:, size > 0] / size[size > 0]
    limit = _DEPENDENT
    for _ in range(2):
        kept = kept - basis @ (basis.T @ (mass @ kept))
        value, vector = np.linalg.eigh(kept.T @ (mass @ kept))
        good = value > limit**2
        kept = kept @ (vector[:, good] / np.sqrt(value[good]))
        # The second pass removes rounding: directions kept by the first have length
        # one.
        limit = 0.5
    return np.asarray(kept)


def largest_of_inverse(
    solve: Solve,
    mass: Sparse,
    count: int,
    known: FloatArray | None = None,
    *,
    down_to: float = np.inf,
    converged: float = _CONVERGED,
) -> tuple[FloatArray, FloatArray]:
    """Find the largest eigenvalues of A^-1 M.

    Args:
        solve: with A, symmetric positive definite.
        mass: M, shape (n, n).
        count: number of eigenvalues, at least.
        known: eigenvectors orthonormal in M to exclude, shape (n, k).
        down_to: all eigenvalues from this one on are found, and the next one.
        converged: relative residual of each vector; its square is the error of the
            eigenvalue.

    Returns:
        Eigenvalues, the largest first, shape (at least count,), and vectors orthonormal
        in M as columns, shape (n, at least count).

    Raises:
        BadData: they do not converge.

    Source:
        Grimes, Lewis and Simon 1994, SIAM J. Matrix Anal. Appl. 15, 228-272.
    """
    full = mass.shape[0]
    apart = np.zeros((full, 0)) if known is None else known
    size = full - apart.shape[1]
    start = np.random.default_rng(0).standard_normal((full, min(_BLOCK, size)))
    new = orthonormalise(apart, mass, start)
    space, images, small = np.zeros((full, 0)), np.zeros((full, 0)), np.zeros((0, 0))
    for _ in range(_MOST_STEPS + count):
        weighted = mass @ new
        image = solve(weighted)
        image = image - apart @ (apart.T @ (mass @ image))
        space = np.concatenate([space, new], axis=1)
        small = _bordered(small, space.T @ (mass @ image))
        images = np.concatenate([images, image], axis=1)
        value, vector = np.linalg.eigh(small)
        wanted = max(count, int(np.count_nonzero(value >= down_to)) + 1)
        if space.shape[1] >= min(wanted + _BLOCK, size):
            value, vector = value[::-1][:wanted], vector[:, ::-1][:, :wanted]
            found = space @ vector
            left = images @ vector - found * value
            error = np.sqrt(np.einsum("nk,nk->k", left, mass @ left))
            if np.all(error <= converged * value) or space.shape[1] == size:
                return value, np.asarray(found)
        new = orthonormalise(np.concatenate([apart, space], axis=1), mass, image)
        if not new.shape[1]:
            break
    if space.shape[1] == size:
        order = np.argsort(-value)[:count]
        return value[order], np.asarray(space @ vector[:, order])
    raise BadData(
        f"{count} modes do not converge; the matrices are badly scaled: check units"
    )


def _bordered(small: FloatArray, column: FloatArray) -> FloatArray:
    """Return a symmetric matrix with new columns, and rows of the same values."""
    old, new = small.shape[0], column.shape[1]
    whole = np.zeros((old + new, old + new))
    whole[:old, :old] = small
    whole[:, old:] = column
    whole[old:, :old] = column[:old].T
    corner = column[old:]
    whole[old:, old:] = 0.5 * (corner + corner.T)
    return whole
