# SPDX-License-Identifier: MIT
"""Noise of the channels and of the force, and how it is whitened."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_record import HitScatter

FORCE_SHAPES = RESIDUALS.force_directions


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """Expected noise of a residual.

    Attributes:
        sigma: white noise of each record and channel, shape (n_records, n_channels).
        force_sigma: white noise of the force [N].
        scatter: of the hits, along each direction.
    """

    sigma: FloatArray
    force_sigma: float
    scatter: HitScatter


def chi2_sd(dof: int) -> float:
    """Return the sd of chi2/dof under noise, including that of the noise estimate.

    The noise is estimated from a share of the same samples, so their common part
    cancels.
    """
    return float(np.sqrt(2.0 / dof * (1.0 / RESIDUALS.noise_share - 1.0)))


def high_band_sigma(residual: FloatArray) -> FloatArray:
    """Estimate white noise from the top of the spectrum.

    Args:
        residual: model minus measurement, shape (..., n_samples).

    Returns:
        Standard deviation, shape (...).
    """
    n = residual.shape[-1]
    taper = np.hanning(n)
    spectrum = scipy.fft.rfft(residual * taper, axis=-1)
    low, high = (int(edge * n) for edge in RESIDUALS.noise_band)
    power = np.mean(np.abs(spectrum[..., low:high]) ** 2, axis=-1)
    return np.asarray(np.sqrt(power / np.sum(taper**2)))


def channel_sigma(
    residual: FloatArray, peak: FloatArray, seen: BoolArray | None = None
) -> FloatArray:
    """Pool the noise over records, with growth with the response if significant.

    Args:
        residual: shape (n_records, n_channels, n_samples).
        peak: largest response, shape (n_records, n_channels).
        seen: records that count, shape (n_records,); None for all.

    Returns:
        Standard deviation, shape (n_records, n_channels), also of records that do not
        count.
    """
    used = np.ones(len(peak), dtype=bool) if seen is None else seen
    variance = high_band_sigma(residual[used]) ** 2
    n = residual.shape[-1]
    relative = np.sqrt(2.0 / ((RESIDUALS.noise_band[1] - RESIDUALS.noise_band[0]) * n))
    pooled = np.empty_like(peak)
    for c in range(variance.shape[1]):
        v, x = variance[:, c], peak[used, c] ** 2
        flat = float(np.median(v)) if v.max() > 3 * v.min() else float(v.mean())
        pooled[:, c] = flat
        if v.size < 4 or np.ptp(x) <= 0:
            continue
        weight = 1 / (relative * v)
        design = np.stack([np.ones_like(x), x], axis=1) * weight[:, None]
        (floor, slope), *_ = np.linalg.lstsq(design, v * weight, rcond=None)
        sd = np.sqrt(np.linalg.pinv(design.T @ design)[1, 1])
        if slope > 6 * sd and floor > 0:
            pooled[:, c] = floor + slope * peak[:, c] ** 2
    return np.sqrt(pooled)


def whitening_basis(columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return an orthonormal basis and the shrinkage that whitens along it.

    With covariance I + B B^T, multiplying the component along each left singular
    vector of B by 1/sqrt(1 + s^2) makes the residual white.

    Args:
        columns: B, already over sigma, shape (n_columns, n_rows).

    Returns:
        Basis, shape (n_kept, n_rows), and 1 - 1/sqrt(1 + s^2), shape (n_kept,).
    """
    gram = columns @ columns.T
    values, vectors = np.linalg.eigh(gram)
    keep = values > RESIDUALS.least_direction**2
    s = np.sqrt(values[keep])
    basis = (vectors[:, keep] / s).T @ columns
    return basis, 1.0 - 1.0 / np.sqrt(1.0 + s**2)


def whitening_of_all(
    columns: Sequence[FloatArray], ways: FloatArray, sd: FloatArray, rho: float
) -> tuple[FloatArray, FloatArray]:
    """Return the whitening of hits whose scatter is correlated.

    Args:
        columns: of force noise, over sigma, (any, n_rows) for each record.
        ways: of scatter, over sigma, shape (n_records, n_columns, n_rows).
        sd: of each hit and column, shape (n_records, n_columns).
        rho: correlation between successive hits [-].

    Returns:
        Basis of each record, shape (n_records, n_kept, n_rows), and the matrix that is
        to be subtracted from the components of all records, square, of size
        n_records * n_kept.
    """
    parts = []
    for own, way, s in zip(columns, ways, sd, strict=True):
        spread = way * s[:, None]
        basis, _ = whitening_basis(np.concatenate([own, spread]))
        parts.append((basis, basis @ own.T, basis @ spread.T))
    kept, (n, k) = max(len(p[0]) for p in parts), sd.shape
    basis = np.zeros((n, kept, ways.shape[2]))
    force = np.zeros((n * kept, n * kept))
    spread = np.zeros((n, kept, k))
    for i, (own, noise, hits) in enumerate(parts):
        basis[i, : len(own)] = own
        spread[i, : len(own)] = hits
        at = slice(i * kept, i * kept + len(own))
        force[at, at] = noise @ noise.T
    order = np.arange(n)
    between = rho ** np.abs(order[:, None] - order[None, :])
    common = np.einsum("iak,jbk,ij->iajb", spread, spread, between, optimize=True)
    covariance = force + common.reshape(n * kept, n * kept)
    values, vectors = np.linalg.eigh(covariance)
    lost = 1.0 - 1.0 / np.sqrt(1.0 + np.maximum(values, 0.0))
    return basis, (vectors * lost) @ vectors.T
