# SPDX-License-Identifier: MIT
"""Normal equations of many weighted linear fits at once: Gram matrices and inverses."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray

_RIDGE = 1e-13
# Up to this number of rows the products of columns cost more than they save.
_FEW_FRFS = 8
# Products of columns are formed for this many lines at a time, to stay in the cache.
_LINES_AT_ONCE = 512


def stacked(values: ComplexArray) -> FloatArray:
    """Return real and imaginary parts one below the other, as real rows."""
    return np.concatenate((values.real, values.imag))


def gram_matrices(columns: ComplexArray, weight: FloatArray) -> FloatArray:
    """Return Re(columns^H diag(weight) columns) for every row of weights.

    With many rows, each product of two columns is formed once for all.

    Args:
        columns: shape (n_lines, n).
        weight: shape (n_frf, n_lines).

    Returns:
        Shape (n_frf, n, n).
    """
    if weight.shape[0] <= _FEW_FRFS:
        rows = stacked(columns)
        scaled = (rows * np.sqrt(np.tile(w, 2))[:, None] for w in weight)
        return np.array([part.T @ part for part in scaled])
    size = columns.shape[1]
    upper = np.triu_indices(size)
    packed = np.zeros((weight.shape[0], upper[0].size))
    for first in range(0, columns.shape[0], _LINES_AT_ONCE):
        part = np.ascontiguousarray(columns[first : first + _LINES_AT_ONCE].T)
        real, imag = part.real.copy(), part.imag.copy()
        pairs = [real[i] * real[i:] + imag[i] * imag[i:] for i in range(size)]
        packed += weight[:, first : first + part.shape[1]] @ np.vstack(pairs).T
    gram = np.empty((weight.shape[0], size, size))
    gram[:, upper[0], upper[1]] = gram[:, upper[1], upper[0]] = packed
    return gram


def correlations(columns: ComplexArray, values: ComplexArray) -> FloatArray:
    """Return Re(columns^H values) row by row, shape (n_frf, n)."""
    return np.asarray((values @ columns.conj()).real)


def inverses(gram: FloatArray) -> FloatArray:
    """Invert Gram matrices after scaling them to a unit diagonal.

    Args:
        gram: symmetric, shape (..., n, n).

    Returns:
        Same shape.
    """
    # Rounding can make the square of a tiny value negative.
    diagonal = np.sqrt(np.maximum(np.einsum("...ii->...i", gram), 0.0))
    scale = 1.0 / np.where(diagonal > 0.0, diagonal, 1.0)
    outer = scale[..., :, None] * scale[..., None, :]
    return np.asarray(
        np.linalg.inv(gram * outer + _RIDGE * np.eye(gram.shape[-1])) * outer
    )
