# SPDX-License-Identifier: MIT
"""Restricted likelihood of the scatter of hits along directions of the model.

The residual of record i over its noise, force noise whitened, is
``r_i = W_i (u_i + X_i beta) + e_i``. The columns of W_i are derivatives of the model;
u_i is the scatter of the hit, with variance S, and correlation rho^|i-j| between hits;
beta are systematic values, which are not scatter. Everything that the likelihood needs
is in the small matrices ``W_i' W_i`` and ``W_i' r_i``. They are kept as factors, since
a quiet record resolves scatter a million times smaller than what is tried.

Source:
    Patterson and Thompson 1971, Biometrika 58, 545 (restricted likelihood); Henderson
    1975, Biometrics 31, 423 (prediction of random effects).
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS


@dataclass(frozen=True, slots=True, eq=False)
class CompressedRecords:
    """Records as seen along the directions of scatter.

    Attributes:
        factor: F with F' F = W' W, shape (n_records, n_columns, n_columns).
        along: z with F' z = W' r, shape (n_records, n_columns).
        beside: r' r - z' z: chi2 that no scatter explains, shape (n_records,).
    """

    factor: FloatArray
    along: FloatArray
    beside: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "factor", "along", "beside")

    def moved(self, change: FloatArray) -> "CompressedRecords":
        """Return the records with W times `change` subtracted from each residual.

        Args:
            change: shape (n_records, n_columns).
        """
        shift = np.einsum("ikl,il->ik", self.factor, change)
        return CompressedRecords(self.factor, self.along - shift, self.beside)

    def some(self, rows: IntArray) -> "CompressedRecords":
        """Return some of the records."""
        return CompressedRecords(self.factor[rows], self.along[rows], self.beside[rows])


def compress(residual: FloatArray, ways: FloatArray) -> CompressedRecords:
    """Compress records along the directions of scatter.

    Args:
        residual: over the noise, shape (n_records, n_rows).
        ways: W', over the noise, shape (n_records, n_columns, n_rows).
    """
    gram = ways @ ways.transpose(0, 2, 1)
    size = np.sqrt(np.maximum(np.diagonal(gram, axis1=1, axis2=2), 1e-300))
    values, vectors = np.linalg.eigh(gram / (size[:, :, None] * size[:, None, :]))
    # Collinear columns leave directions without information.
    seen = values > RESIDUALS.least_information
    root = np.sqrt(np.where(seen, values, 1.0))
    score = np.einsum("ikr,ir->ik", ways, residual) / size
    along = np.where(seen, np.einsum("ika,ik->ia", vectors, score) / root, 0.0)
    factor = np.where(seen, root, 0.0)[:, :, None] * vectors.transpose(0, 2, 1)
    beside = np.sum(residual**2, axis=1) - np.sum(along**2, axis=1)
    return CompressedRecords(factor * size[:, None, :], along, beside)


@dataclass(frozen=True, slots=True, eq=False)
class Weighed:
    """Compressed records, weighted by the covariance C of noise and scatter.

    Attributes:
        log_determinant: of C, over the noise.
        chi2: r' C^-1 r.
        gram: W' C^-1 W of all records, square, of size n_records * n_columns.
        score: W' C^-1 r, shape (n_records * n_columns,).
        predicted: expected u of each hit, shape (n_records, n_columns).
    """

    log_determinant: float
    chi2: float
    gram: FloatArray
    score: FloatArray
    predicted: FloatArray


def weigh(
    records: CompressedRecords, variance: FloatArray, rho: float = 0.0
) -> Weighed:
    """Weigh records by the covariance of noise and scatter.

    Args:
        records: compressed.
        variance: of each hit along each column, shape (n_records, n_columns).
        rho: correlation between successive hits [-].
    """
    n, k = variance.shape
    root = np.sqrt(variance)
    if rho == 0.0:
        spread = records.factor * root[:, None, :]
        half = np.linalg.inv(_whitener(spread))
        log_determinant = -2.0 * np.sum(np.log(np.diagonal(half, axis1=1, axis2=2)))
        left = half @ records.factor
        residual = (half @ records.along[:, :, None])[:, :, 0]
        score = np.einsum("iak,ia->ik", left, residual)
        gram = np.zeros((n, k, n, k))
        each = np.arange(n)
        gram[each, :, each, :] = left.transpose(0, 2, 1) @ left
        predicted = variance * score
    else:
        order = np.arange(n)
        between = rho ** np.abs(order[:, None] - order[None, :])
        covariance = np.einsum("ik,jk,ij,kl->ikjl", root, root, between, np.eye(k))
        covariance = covariance.reshape(n * k, n * k)
        factor = scipy.linalg.block_diag(*records.factor)
        root_of_between = np.linalg.cholesky(between)
        spread = np.einsum("iak,ik,ij->iajk", records.factor, root, root_of_between)
        lower = _whitener(spread.reshape(n * k, n * k))
        log_determinant = 2.0 * np.sum(np.log(np.diag(lower)))
        both = np.concatenate([factor, records.along.reshape(-1, 1)], axis=1)
        both = scipy.linalg.solve_triangular(lower, both, lower=True)
        left, residual = both[:, :-1], both[:, -1]
        score = left.T @ residual
        gram = left.T @ left
        predicted = (covariance @ score).reshape(n, k)
    return Weighed(
        float(log_determinant),
        float(np.sum(residual**2) + records.beside.sum()),
        gram.reshape(n * k, n * k),
        score.ravel(),
        predicted,
    )


def _whitener(spread: FloatArray) -> FloatArray:
    """Return the lower factor of 1 + A A', A of shape (..., n, n).

    A joint near divergence has derivatives for which the 1 is lost beside A A'; its
    factor then comes from A itself, by an orthogonal decomposition.
    """
    one = np.broadcast_to(np.eye(spread.shape[-1]), spread.shape)
    across = np.swapaxes(spread, -1, -2)
    try:
        return np.asarray(np.linalg.cholesky(one + spread @ across), float)
    except np.linalg.LinAlgError:
        upper = np.linalg.qr(np.concatenate([across, one], axis=-2), mode="r")
    sign = np.where(np.diagonal(upper, axis1=-2, axis2=-1) < 0.0, -1.0, 1.0)
    return np.swapaxes(sign[..., :, None] * upper, -1, -2)


def deviance(
    weighed: Weighed, systematic: FloatArray, *, restricted: bool = True
) -> float:
    """Return -2 log likelihood, up to a constant of the records.

    Args:
        weighed: records under a covariance.
        systematic: X, shape (n_records, n_columns, n_systematic).
        restricted: True for variances, False to compare sets of systematic values.
    """
    bare = weighed.log_determinant + weighed.chi2
    count = systematic.shape[2]
    if count == 0:
        return bare
    x = systematic.reshape(-1, count)
    # A prior of 100 % on each value keeps collinear columns apart.
    normal = np.eye(count) + x.T @ weighed.gram @ x
    right = x.T @ weighed.score
    factor = scipy.linalg.cho_factor(normal, lower=True)
    fitted = float(right @ scipy.linalg.cho_solve(factor, right))
    if not restricted:
        return bare - fitted
    return bare - fitted + 2.0 * float(np.sum(np.log(np.diag(factor[0]))))


def without_systematic(
    weighed: Weighed, systematic: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return gram and score with the systematic values fitted.

    Args:
        weighed: records under a covariance.
        systematic: X, shape (n_records, n_columns, n_systematic).
    """
    count = systematic.shape[2]
    x = systematic.reshape(-1, count)
    ahead = weighed.gram @ x
    taken = np.linalg.solve(np.eye(count) + x.T @ ahead, ahead.T)
    left = weighed.gram - ahead @ taken
    return left, weighed.score - (weighed.score @ x) @ taken
