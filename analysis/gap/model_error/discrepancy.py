# SPDX-License-Identifier: MIT
"""Discrepancy between model and records: coherent, incoherent, and its whitening.

The coherent part is an error of the response function that all records of a hit point
share: unknown modes, wrong masses, gains. It is linear, so that its spectrum follows
that of the force. The incoherent part differs from record to record.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.model_error.spectral_frame import SpectralFrame


@dataclass(frozen=True, slots=True, eq=False)
class Discrepancy:
    """Relative size of the discrepancy.

    Attributes:
        coherent: over the response, squared [-], (n_points, n_channels, n_bands).
        incoherent: over the response, squared [-], shape (n_channels, n_bands).
    """

    coherent: FloatArray
    incoherent: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Whitening:
    """Weights that make a residual with a given discrepancy white.

    Attributes:
        frame: lines and bands.
        weight: of each line, shape (n_records, n_channels, n_lines).
        common: direction of the coherent error over the records of each hit point, of
            unit length for each channel and line, same shape.
        removed: share of that direction that is removed, same shape.
        strength: squared length of the coherent error for a discrepancy of 1, same
            shape.
    """

    frame: SpectralFrame
    weight: FloatArray
    common: ComplexArray
    removed: FloatArray
    strength: FloatArray

    def component(self, spectrum: ComplexArray) -> ComplexArray:
        """Return the coherent component of weighted spectra, for each record."""
        along = np.conj(self.common) * spectrum
        out = np.empty_like(along)
        for rows in points_of(self.frame):
            out[rows] = along[rows].sum(axis=0)
        return out

    def white(self, spectrum: ComplexArray) -> ComplexArray:
        """Return a spectrum over sigma, whitened; of the same shape."""
        weighted = self.weight * spectrum
        return np.asarray(
            weighted - self.common * self.removed * self.component(weighted)
        )


def points_of(frame: SpectralFrame) -> list[IntArray]:
    """Return the records of each hit point."""
    return [np.flatnonzero(frame.point == p) for p in range(int(frame.point.max()) + 1)]


def no_discrepancy(frame: SpectralFrame) -> Discrepancy:
    """Return a discrepancy of zero."""
    points = int(frame.point.max()) + 1
    channels, bands = frame.signal.shape[1:]
    return Discrepancy(np.zeros((points, channels, bands)), np.zeros((channels, bands)))


def whitening(frame: SpectralFrame, found: Discrepancy) -> Whitening:
    """Return the whitening of a discrepancy."""
    variance = 1.0 + found.incoherent * frame.signal
    weight = np.where(frame.counted, 1.0 / np.sqrt(variance), 0.0)[..., frame.band]
    size = np.sqrt(_transfer(frame))[..., frame.band]
    direction = size * weight * frame.force[:, None, :] / frame.sigma[:, :, None]
    strength = np.empty(direction.shape)
    for rows in points_of(frame):
        strength[rows] = np.sum(np.abs(direction[rows]) ** 2, axis=0)
    common = direction / np.sqrt(np.maximum(strength, 1e-300))
    coherent = found.coherent[frame.point][..., frame.band]
    removed = 1.0 - 1.0 / np.sqrt(1.0 + coherent * strength)
    return Whitening(frame, weight, common, removed, strength)


def _transfer(frame: SpectralFrame) -> FloatArray:
    """Return the squared response per unit force, (n_records, n_channels, n_bands).

    It is that of the hit point: the mean over its records.
    """
    force = frame.in_bands(np.abs(frame.force) ** 2)[:, None, :]
    response = frame.signal * frame.sigma[:, :, None] ** 2 * frame.counted
    out = np.zeros(frame.signal.shape)
    for rows in points_of(frame):
        counted = (force * frame.counted)[rows].sum(axis=0)
        out[rows] = response[rows].sum(axis=0) / np.maximum(counted, 1e-300)
    return out


def estimate_discrepancy(frame: SpectralFrame, spectrum: ComplexArray) -> Discrepancy:
    """Estimate the discrepancy from the residual of a fit.

    Args:
        frame: lines and bands.
        spectrum: of the residual over sigma, shape (n_records, n_channels, n_lines).
    """
    found = no_discrepancy(frame)
    for _ in range(MODEL_ERROR_SETTINGS.noise_rounds):
        found = _again(frame, spectrum, found)
    return found


def _again(
    frame: SpectralFrame, spectrum: ComplexArray, found: Discrepancy
) -> Discrepancy:
    """Return the estimate of one more round."""
    at = whitening(frame, found)
    weighted = at.weight * spectrum
    component = at.component(weighted)
    coherent = np.zeros_like(found.coherent)
    for p, rows in enumerate(points_of(frame)):
        excess = frame.in_bands(np.abs(component[rows[0]]) ** 2) - 1.0
        strength = frame.in_bands(at.strength[rows[0]])
        coherent[p] = np.maximum(excess, 0.0) / np.maximum(strength, 1e-300)
        coherent[p] *= frame.counted[rows].any(axis=0)
    rest = weighted - at.common * component
    leverage = frame.in_bands(np.abs(at.common) ** 2)
    left = frame.in_bands(np.abs(rest) ** 2) / np.maximum(1.0 - leverage, 1e-3)
    variance = left * (1.0 + found.incoherent * frame.signal)
    share = (variance - 1.0) / np.maximum(frame.signal, 1e-300)
    informed = frame.counted & (leverage < MODEL_ERROR_SETTINGS.largest_leverage)
    share = np.where(informed, share, np.nan)
    with np.errstate(all="ignore"):
        filled = np.where(informed.any(axis=0), _median(share), 0.0)
    return Discrepancy(coherent, np.maximum(filled, 0.0))


def _median(share: FloatArray) -> FloatArray:
    """Return the median over the informed records; 0 where there is none."""
    empty = np.isnan(share).all(axis=0)
    return np.asarray(np.nanmedian(np.where(empty, 0.0, share), axis=0))
