# SPDX-License-Identifier: MIT
"""Exact Gaussian likelihood of the long waves of profiles: means of blocks.

Ordinates of a spectrum are independent only at waves much shorter than the profile,
and levelling takes part of the longest ones. Means of blocks of samples have an exact
covariance for any spectrum, and a polynomial is left out of it exactly.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze, read_only
from jointbench.acquisition.basics.compiled import compiled

_CELLS = 400
"""Cells of the integral over wavenumbers, equal in ln q [-]."""
_LOWEST = 1e-4
"""Lowest wavenumber of the integral over that of the profile's length [-]."""
_LONG_WAVE = 0.1
"""Phase over a block below which its mean is taken at the middle of a cell [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class BlockMeans:
    """Means of equal blocks of independent profiles.

    Attributes:
        means: [heights], shape (n_blocks, n_profiles).
        size: samples of a block [-].
        trend: polynomials that were removed, or are to be left out, shape
            (n_blocks, degree + 1).
    """

    means: FloatArray
    size: int
    trend: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "means", "trend")

    def log_likelihood(self, density: FloatArray) -> float:
        """Return the restricted log-likelihood of the means.

        Args:
            density: of the sampled heights at `wavenumbers` of these blocks.

        Raises:
            LinAlgError: the covariance is not positive.

        Source:
            Restricted likelihood: Harville, Biometrika 61 (1974) 383; a polynomial of
            any size leaves it unchanged.
        """
        _, kernel = kernel_of(self.means.shape[0], self.size)
        total = toeplitz_log_likelihood(kernel @ density, self.trend, self.means)
        if np.isnan(total):
            raise np.linalg.LinAlgError("the covariance of the means is not positive")
        return float(total)


def block_means(lines: FloatArray, count: int, degree: int) -> BlockMeans:
    """Return the means of `count` equal blocks; samples that are left over are unused.

    Args:
        lines: heights, shape (n_profiles, n_points).
        count: of blocks.
        degree: of the polynomial that each profile was, or is to be, levelled by.
    """
    size = lines.shape[1] // count
    used = lines[:, : size * count].reshape(lines.shape[0], count, size)
    place = np.linspace(-1, 1, count)
    vander = np.polynomial.legendre.legvander(place, degree)
    trend = np.ascontiguousarray(vander, dtype=np.float64)
    return BlockMeans(np.ascontiguousarray(used.mean(axis=2).T), size, trend)


def wavenumbers(blocks: BlockMeans) -> FloatArray:
    """Return where the likelihood takes the density [rad/sample]."""
    return kernel_of(blocks.means.shape[0], blocks.size)[0]


@lru_cache(8)
def kernel_of(count: int, size: int) -> tuple[FloatArray, FloatArray]:
    """Return wavenumbers and the kernel from density to covariance of the means.

    Args:
        count: of blocks.
        size: samples of each.

    Returns:
        Middles of cells of ln q [rad/sample], shape (n,), and the kernel, shape
        (count, n): the covariance at block distances 0, 1, ... is kernel @ density.
        Cosines are averaged over each cell exactly.
    """
    lowest = 2 * np.pi * _LOWEST / (count * size)
    edge = np.concatenate([[0.0], np.geomspace(lowest, np.pi, _CELLS)])
    middle = np.sqrt(np.maximum(edge[1:] * edge[:-1], (0.5 * edge[1]) ** 2))
    width = np.diff(edge)
    place = 0.5 * (edge[1:] + edge[:-1])
    distance = size * np.arange(-1, count + 1)[:, None]
    cosine = np.cos(distance * place) * np.sinc(distance * width / (2 * np.pi))
    # sin^2(x / 2) cos(j x) of the mean over a block, x = q times its size.
    product = 0.5 * cosine[1:-1] - 0.25 * (cosine[2:] + cosine[:-2])
    kernel = product / (size * np.sin(0.5 * place)) ** 2
    # The differences lose digits where a block is much shorter than the wave.
    long = size * place < _LONG_WAVE
    mean = np.sin(0.5 * size * place[long]) / (size * np.sin(0.5 * place[long]))
    kernel[:, long] = cosine[1:-1, long] * mean**2
    kernel *= 2 * width
    return read_only(middle), read_only(kernel)


@compiled()
def toeplitz_log_likelihood(
    covariance: FloatArray, trend: FloatArray, data: FloatArray
) -> float:
    """Return the restricted log-likelihood of independent columns, up to a constant.

    A fit calls it a thousand times: one pass over the columns of the Cholesky factor
    takes a fraction of the time of factor, substitution and QR by LAPACK.

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
