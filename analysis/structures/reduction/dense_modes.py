# SPDX-License-Identifier: MIT
"""Modes of a small dense matrix whose eigenvalues span many decades.

A soft joint's mode has a millionth of a millionth of the largest eigenvalue, below the
rounding of a direct solution. The inverse of K + shift has its largest eigenvalues
there, and its range ends at 1/shift.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrf, dpotrs

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData

# Relative residual of each vector, of modes far below the shift and of others; its
# square is the error of the eigenvalue of the inverse.
_CONVERGED, _CONVERGED_HIGH = 1e-6, 1e-5
# Relative residual of modes that are part of a basis.
_ROUGH = 3e-3
# Vectors in one block beyond the number of modes.
_SPARE = 4
# Vectors of a block per wanted mode, and the least: narrow blocks need fewer vectors in
# all, wide ones fewer steps. Modes of one frequency must not be more than one block.
_BLOCK, _LEAST_BLOCK = 0.6, 6
# Vectors in the space per wanted mode before the first check: fewer never suffice.
_FIRST_SPACE = 3.5
# Part of the start that is random: what a guess by its symmetry cannot hold.
_RANDOM_PART = 1e-3
# From this share of all modes on, all of them are computed.
_MOST_OF_ALL = 0.25
_SMALL = 160
# Least diagonal of a Cholesky factor that leaves an orthonormal block after two passes.
_NEARLY_DEPENDENT = 1e-5
# Blocks before the first check: fewer never suffice.
_FIRST_CHECK = 4


def lowest_dense_modes(
    matrix: FloatArray, shift: float, count: int, start: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Find the lowest eigenvalues of a symmetric positive semi-definite matrix.

    Args:
        matrix: shape (n, n) [1/s^2].
        shift: added to its diagonal before the inversion [1/s^2].
        count: number of eigenvalues.
        start: vectors near the wanted ones, shape (n, k); None for random ones.

    Returns:
        Eigenvalues, the lowest first, and orthonormal vectors as columns.

    Raises:
        BadData: the matrix is not positive semi-definite.
    """
    size = matrix.shape[0]
    factor = _factor(matrix, shift)
    if size <= _SMALL or count > _MOST_OF_ALL * size:
        value, vector = _all_of_inverse(factor, size)
        value, vector = value[:count], vector[:, :count]
    else:
        block = max(_LEAST_BLOCK, round(_BLOCK * count))
        value, vector = _block_lanczos(
            factor,
            _narrow_start(size, block, start),
            lambda value: _allowed(value[:count], shift),
            round(_FIRST_SPACE * count),
        )
    return _without_shift(value, shift), vector


def dense_modes_below(
    matrix: FloatArray, shift: float, limit: float, start: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Find the eigenvalues below a limit, as accurately as a basis needs them.

    Args:
        matrix: symmetric positive semi-definite, shape (n, n) [1/s^2].
        shift: added to its diagonal before the inversion [1/s^2].
        limit: [1/s^2].
        start: vectors near the wanted ones, shape (n, k); None for random ones.

    Returns:
        Eigenvalues, the lowest first, and orthonormal vectors as columns; the
        eigenvalues are within 1e-5.
    """
    size = matrix.shape[0]
    factor = _factor(matrix, shift)
    least = 1.0 / (limit + shift)
    if size <= _SMALL:
        value, vector = _all_of_inverse(factor, size)
        kept = int(np.count_nonzero(value > least))
        value, vector = value[:kept], vector[:, :kept]
    else:
        if start is None:
            start = _random_start(size, _SPARE)
        value, vector = _block_lanczos(
            factor,
            start,
            lambda value: _ROUGH * value[value > least],
            _FIRST_CHECK * start.shape[1],
        )
    return _without_shift(value, shift), vector


def _without_shift(value: FloatArray, shift: float) -> FloatArray:
    """Return eigenvalues of the matrix from those of the shifted inverse."""
    # Softer joints cannot be distinguished from rounding.
    least = np.finfo(float).eps * shift
    return np.asarray(np.maximum(1.0 / value - shift, least))


def _random_start(size: int, count: int) -> FloatArray:
    return _random(size, min(count + _SPARE, size))


def _narrow_start(size: int, block: int, near: FloatArray | None) -> FloatArray:
    """Return a block of mixtures of vectors, with a little of every direction."""
    start = _random(size, block)
    if near is not None:
        start = near @ _random(near.shape[1], block) + _RANDOM_PART * start
    return start


@lru_cache(maxsize=32)
def _random(rows: int, columns: int) -> FloatArray:
    """Return normal numbers, each time the same, to be read only."""
    found = np.random.default_rng(rows).standard_normal((rows, columns))
    found.flags.writeable = False
    return found


def _all_of_inverse(factor: FloatArray, size: int) -> tuple[FloatArray, FloatArray]:
    """Return all eigenvalues of the inverse, the largest first, and vectors."""
    inverse = _solved(factor, np.eye(size))
    value, vector = np.linalg.eigh(0.5 * (inverse + inverse.T))
    return value[::-1], vector[:, ::-1]


def shifted_inverse(
    matrix: FloatArray, shift: float
) -> Callable[[FloatArray], FloatArray]:
    """Return a function that solves with matrix + shift."""
    factor = _factor(matrix, shift)

    def solve(load: FloatArray) -> FloatArray:
        return _solved(factor, load)

    return solve


def _factor(matrix: FloatArray, shift: float) -> FloatArray:
    """Return the lower Cholesky factor of matrix + shift."""
    # The transpose of a symmetric matrix has the order of LAPACK, which then factors in
    # place.
    shifted = np.array(matrix.T, order="F")
    np.einsum("ii->i", shifted)[:] += shift
    factor, failed = dpotrf(shifted, lower=1, clean=0, overwrite_a=1)
    if failed:
        raise BadData(
            f"the reduced stiffness is not positive (leading minor {failed}); a "
            "joint's stiffness exceeds the box of the reduction by far"
        )
    return np.asarray(factor)


def _solved(factor: FloatArray, load: FloatArray) -> FloatArray:
    return np.asarray(dpotrs(factor, load, lower=1)[0])


def _block_lanczos(
    factor: FloatArray,
    start: FloatArray,
    allowed: Callable[[FloatArray], FloatArray],
    first: int,
) -> tuple[FloatArray, FloatArray]:
    """Return the largest eigenvalues of the inverse, and vectors.

    Args:
        factor: of the matrix with its shift.
        start: see `lowest_dense_modes`.
        allowed: from eigenvalues, the largest first, to the residuals that are allowed
            of those that are wanted.
        first: number of vectors before the first check.
    """
    size = factor.shape[0]
    new = _orthonormal(start)
    # Columns are contiguous, as LAPACK wants them.
    space = np.zeros((size, size), order="F")
    small = np.zeros((size, size), order="F")
    low = 0
    while True:
        high = low + new.shape[1]
        space[:, low:high] = new
        image = _solved(factor, new)
        new, inside = _next_block(space[:, :high], image)
        small[:high, low:high] = inside
        if high == size or high >= first:
            # The lower triangle is not needed.
            value, vector = np.linalg.eigh(small[:high, :high], UPLO="U")
            value, vector = value[::-1], vector[:, ::-1]
            limit = allowed(value)
            value, vector = value[: limit.size], vector[:, : limit.size]
            # What an inversion adds to the space comes from its last block alone.
            outside = (new.T @ image) @ vector[low:high]
            if high == size or np.all(np.linalg.norm(outside, axis=0) <= limit):
                break
        low = high
    # One more inversion damps what high modes leave; it stays orthonormal to rounding.
    better = (space[:, :high] @ vector) * value
    better += new @ outside
    return value, _orthonormal(better)


def _allowed(value: FloatArray, shift: float) -> FloatArray:
    """Return the residual that leaves each eigenvalue a relative error of 1e-10."""
    level = np.maximum(1.0 / value - shift, 0.0)
    relative = _CONVERGED_HIGH * np.sqrt(level / shift)
    return np.asarray(value * np.clip(relative, _CONVERGED, _CONVERGED_HIGH))


def _next_block(space: FloatArray, image: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return an orthonormal block outside of the space, and the part inside."""
    room = space.shape[0] - space.shape[1]
    inside = space.T @ image
    new = _orthonormal(image - space @ inside)[:, :room]
    new = _orthonormal(new - space @ (space.T @ new))
    return np.asarray(new), np.asarray(inside)


def _orthonormal(block: FloatArray) -> FloatArray:
    """Return an orthonormal basis of columns.

    By the Cholesky factor of their products, which takes a third of the time of
    reflections; these are used where columns are nearly dependent.
    """
    products = block.T @ block
    factor, failed = dpotrf(products, lower=1)
    length = np.sqrt(np.diag(products))
    if failed or np.any(np.diag(factor) < _NEARLY_DEPENDENT * length):
        return np.asarray(np.linalg.qr(block)[0])
    return np.asarray(dtrsm(1.0, factor, block.T, lower=1).T)
