# SPDX-License-Identifier: MIT
"""Noise of the channels and of the force, and how it is whitened."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS

FORCE_SHAPES = RESIDUALS.force_directions


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """Expected noise of a residual.

    Attributes:
        sigma: white noise of each record and channel, shape (n_records, n_channels).
        force_sigma: white noise of the force [N].
        scatter: relative sd from hit to hit, of gain and of joint stiffness [-].
    """

    sigma: FloatArray
    force_sigma: float
    scatter: tuple[float, ...]


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


def channel_sigma(residual: FloatArray, peak: FloatArray) -> FloatArray:
    """Pool the noise over records, with growth with the response if significant.

    Args:
        residual: shape (n_records, n_channels, n_samples).
        peak: largest response, shape (n_records, n_channels).

    Returns:
        Standard deviation, shape (n_records, n_channels).
    """
    variance = high_band_sigma(residual) ** 2
    n = residual.shape[-1]
    relative = np.sqrt(2.0 / ((RESIDUALS.noise_band[1] - RESIDUALS.noise_band[0]) * n))
    pooled = np.empty_like(variance)
    for c in range(variance.shape[1]):
        v, x = variance[:, c], peak[:, c] ** 2
        flat = float(np.median(v)) if v.max() > 3 * v.min() else float(v.mean())
        pooled[:, c] = flat
        if v.size < 4 or np.ptp(x) <= 0:
            continue
        weight = 1 / (relative * v)
        design = np.stack([np.ones_like(x), x], axis=1) * weight[:, None]
        (floor, slope), *_ = np.linalg.lstsq(design, v * weight, rcond=None)
        sd = np.sqrt(np.linalg.pinv(design.T @ design)[1, 1])
        if slope > 6 * sd and floor > 0:
            pooled[:, c] = floor + slope * x
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
