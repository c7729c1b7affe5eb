# SPDX-License-Identifier: MIT
"""HitWhitening of hits whose landing point, tilt and gain are known with a sd only.

With the derivatives W of a record by its directions u ~ N(0, 1) over sigma, its
residual has the covariance I + W W'. Multiplied by the inverse root of that, the
residual is white, and the directions need no coordinates of their own in the fit.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class HitWhitening:
    """Inverse root of the covariance of each record.

    Attributes:
        basis: orthonormal directions, shape (n_records, n_directions, n_rows).
        taken: share of each that is removed, shape (n_records, n_directions).
    """

    basis: FloatArray
    taken: FloatArray

    def __call__(self, rows: SlopeArray) -> None:
        """Whiten rows of records, shape (n_records, n, n_rows), in place."""
        for row, basis, taken in zip(rows, self.basis, self.taken, strict=True):
            row -= ((row @ basis.T) * taken) @ basis


@dataclass(frozen=True, slots=True, eq=False)
class HumWhitening:
    """Inverse root of the covariance of each channel, with what is left of its hum.

    Attributes:
        basis: orthonormal directions of all channels, shape (n_directions, n_samples).
        taken: share of each that is removed, shape (n_records, n_channels,
            n_directions).
    """

    basis: FloatArray
    taken: FloatArray

    def __call__(self, rows: SlopeArray) -> None:
        """Whiten rows over sigma in place, (n_records, ..., n_channels, n_samples)."""
        for row, taken in zip(rows, self.taken, strict=True):
            row -= ((row @ self.basis.T) * taken) @ self.basis


@dataclass(frozen=True, slots=True, eq=False)
class CommonWhitening:
    """Inverse root of the covariance of all records together.

    Attributes:
        basis: orthonormal directions, shape (n_records, n_directions, n_rows).
        taken: share of each that is removed, shape (n_directions,).
    """

    basis: FloatArray
    taken: FloatArray

    def __call__(self, rows: SlopeArray) -> None:
        """Whiten rows in place, (n_records, n, n_channels, n_samples)."""
        flat = rows.reshape(*rows.shape[:2], -1)
        pairs = tuple(zip(flat, self.basis, strict=True))
        along = np.sum([row @ basis.T for row, basis in pairs], axis=0) * self.taken
        # Record by record: of all together, rows would be copied.
        for row, basis in pairs:
            row -= along @ basis


def common_whitening(scaled: FloatArray) -> CommonWhitening:
    """Return the whitening for directions that all records have in common.

    Args:
        scaled: derivatives by directions of unit sd, white otherwise, shape
            (n_records, n_directions, n_channels, n_samples); the basis takes its
            place.
    """
    flat = scaled.reshape(*scaled.shape[:2], -1)
    values, vectors = np.linalg.eigh(np.sum([one @ one.T for one in flat], axis=0))
    kept = values > STRUCTURE.least_variance
    values, vectors = values[kept], vectors[:, kept]
    basis = flat[:, : values.size]
    for one, found in zip(flat, basis, strict=True):
        found[:] = (vectors / np.sqrt(values)).T @ one
    return CommonWhitening(basis, 1.0 - 1.0 / np.sqrt(1.0 + values))


def hum_whitening(hum: FloatArray, noise: FloatArray) -> HumWhitening:
    """Return the whitening for what is left of offset and hum.

    Args:
        hum: directions of unit sd over the noise, shape (n_directions, n_samples).
        noise: over sigma, shape (n_records, n_channels).
    """
    _, size, basis = np.linalg.svd(hum, full_matrices=False)
    values = (noise[:, :, None] * size) ** 2
    return HumWhitening(basis, 1.0 - 1.0 / np.sqrt(1.0 + values))


def whitening_of(scaled: FloatArray) -> HitWhitening:
    """Return the whitening for directions.

    Args:
        scaled: derivatives by directions of unit sd, over sigma, shape
            (n_records, n_directions, n_rows).
    """
    values, vectors = np.linalg.eigh(scaled @ scaled.transpose(0, 2, 1))
    values = np.maximum(values, 0.0)
    root = np.sqrt(np.maximum(values, STRUCTURE.least_direction))
    basis = (vectors.transpose(0, 2, 1) @ scaled) / root[:, :, None]
    taken = 1.0 - 1.0 / np.sqrt(1.0 + values)
    return HitWhitening(basis, np.where(values > STRUCTURE.least_direction, taken, 0.0))


def directions_found(scaled: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the most likely directions of each record, shape (n_records, n).

    Args:
        scaled: as in `whitening_of`.
        residual: model minus measurement over sigma at u = 0, (n_records, n_rows).

    Returns:
        u in units of its sd.
    """
    inner = np.eye(scaled.shape[1]) + scaled @ scaled.transpose(0, 2, 1)
    right = np.einsum("rdn,rn->rd", scaled, residual)
    return np.asarray(-np.linalg.solve(inner, right[:, :, None])[:, :, 0])
