# SPDX-License-Identifier: MIT
"""Normal equations of many weighted linear fits at once: Gram matrices and inverses."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled

_RIDGE = 1e-13
# Up to this number of rows the products of columns cost more than they save.
_FEW_FRFS = 8
# Products of columns are formed for this many lines at a time, to stay in the cache.
_LINES_AT_ONCE = 512
# Values of these products at the most, 8 MB, and lines that are always worth it.
_PRODUCTS_AT_ONCE, _LEAST_LINES = 2**20, 32


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
        rows = _as_real(columns.T)
        scaled = (rows * np.repeat(np.sqrt(w), 2) for w in weight)
        return np.array([part @ part.T for part in scaled])
    size = columns.shape[1]
    upper = np.triu_indices(size)
    packed = np.zeros((weight.shape[0], upper[0].size))
    step = min(_LINES_AT_ONCE, max(_LEAST_LINES, _PRODUCTS_AT_ONCE // upper[0].size))
    pairs = np.empty((upper[0].size, step))
    for first in range(0, columns.shape[0], step):
        here = slice(first, first + step)
        real = np.ascontiguousarray(columns[here].real.T)
        imag = np.ascontiguousarray(columns[here].imag.T)
        count = real.shape[1]
        _products(real, imag, count, pairs)
        packed += weight[:, here] @ pairs[:, :count].T
    place = np.empty((size, size), int)
    place[upper] = place.T[upper] = np.arange(upper[0].size)
    return np.asarray(packed[:, place])


@compiled()
def _products(
    real: FloatArray, imag: FloatArray, count: int, pairs: FloatArray
) -> None:
    """Form the products of each column with itself and those after it, in place.

    Args:
        real: parts of the columns, shape (n, n_lines).
        imag: same shape.
        count: of lines.
        pairs: receives the products, shape (n (n + 1) / 2, at least count).
    """
    row = 0
    for i in range(real.shape[0]):
        a, b = real[i], imag[i]
        for j in range(i, real.shape[0]):
            c, d = real[j], imag[j]
            into = pairs[row]
            for k in range(count):
                into[k] = a[k] * c[k] + b[k] * d[k]
            row += 1


def correlations(columns: ComplexArray, values: ComplexArray) -> FloatArray:
    """Return Re(columns^H values) row by row, shape (n_frf, n)."""
    return np.asarray(_as_real(values) @ _as_real(columns.T).T)


def combined(coefficients: FloatArray, columns: ComplexArray) -> ComplexArray:
    """Return columns with real coefficients, row by row, shape (n_frf, n_lines)."""
    made = coefficients @ _as_real(columns.T)
    return np.asarray(made.view(np.complex128))


def _as_real(values: ComplexArray) -> FloatArray:
    """Return rows with real and imaginary parts in turn: half the work of complex."""
    return np.ascontiguousarray(values).view(np.float64)


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
