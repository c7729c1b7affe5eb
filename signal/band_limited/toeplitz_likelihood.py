# SPDX-License-Identifier: MIT
"""Restricted Gaussian likelihood of evenly spaced data, in the square of their number.

A fit calls it a thousand times: one compiled pass over the columns of the Cholesky
factor takes a fraction of the time of factor, substitution and QR by LAPACK.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled


@compiled()
def toeplitz_log_likelihood(
    covariance: FloatArray, trend: FloatArray, data: FloatArray
) -> float:
    """Return the restricted log-likelihood of independent columns, up to a constant.

    Args:
        covariance: at distances 0, 1, ..., shape (n,).
        trend: what the columns may have added to them, shape (n, n_terms).
        data: shape (n, n_columns).

    Returns:
        The log-likelihood; nan where the covariance is not positive.

    Source:
        Columns of the factor by Schur's recursion with mixed rotations: Bojanczyk et
        al., SIAM J. Matrix Anal. Appl. 16 (1995) 40.
    """
    terms, columns, count = trend.shape[1], data.shape[1], covariance.size
    rest = np.empty((terms + columns, count))
    rest[:terms] = trend.T
    rest[terms:] = data.T
    if not covariance[0] > 0:
        return np.nan
    column = covariance / np.sqrt(covariance[0])
    other = column.copy()
    logs = 0.0
    for j in range(count):
        pivot = column[j]
        if not pivot > 0:
            return np.nan
        logs += columns * np.log(pivot)
        for k in range(terms + columns):
            value = rest[k, j] / pivot
            rest[k, j] = value
            for i in range(j + 1, count):
                rest[k, i] -= column[i] * value
        if j + 1 == count:
            break
        for i in range(count - 1, j, -1):
            column[i] = column[i - 1]
        turn = other[j + 1] / column[j + 1]
        if not abs(turn) < 1:
            return np.nan
        left = np.sqrt(1 - turn * turn)
        for i in range(j + 1, count):
            column[i] = (column[i] - turn * other[i]) / left
            other[i] = left * other[i] - turn * column[i]
    # The trend is taken out of all that follows it, by Gram and Schmidt.
    for k in range(terms):
        size = np.sqrt(np.sum(rest[k] ** 2))
        logs += columns * np.log(size)
        rest[k] /= size
        for i in range(k + 1, terms + columns):
            rest[i] -= np.sum(rest[k] * rest[i]) * rest[k]
    return float(-0.5 * np.sum(rest[terms:] ** 2) - logs)
