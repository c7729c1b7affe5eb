# SPDX-License-Identifier: MIT
"""Whitening of hits of one point where the modal table is uncertain.

The errors of the table E are the same in all hits of a point, the directions W are each
hit's own: the rows x of a point over sigma have the covariance A + W'W, A = I + E'E.
With orthonormal rows Q that span E, the inverse root of A is I - Q'NQ for each channel,
and that of the whole follows from the small matrix W A^-1 W'. Nothing is stored that is
as large as all directions of all hits.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class PointWhitening:
    """Inverse root of the covariance of all records of a point.

    Attributes:
        directions: derivatives W by directions of unit sd, over sigma, shape
            (n_records, n_directions, n_channels, n_samples).
        basis: Q of the errors of the table, shape (n_records, n, n_samples).
        taken: N of each channel, shape (n_channels, n, n).
        within: directions in the basis, WQ', shape
            (n_records, n_directions, n_channels, n).
        inner: W A^-1 W', shape (n_all_directions, n_all_directions).
        removed: what the inverse root of the whole takes of W A^-1, of that shape.
        twice: 2N - NN, which A^-1 takes where its root takes N.
    """

    directions: SlopeArray
    basis: SlopeArray
    taken: FloatArray
    within: FloatArray
    inner: FloatArray
    removed: FloatArray
    twice: FloatArray

    def found(self, rows: FloatArray) -> FloatArray:
        """Return the most likely directions of rows, (n_records, n_directions).

        Args:
            rows: model minus measurement over sigma, shape
                (n_records, n_channels, n_samples).
        """
        one = rows[:, None]
        right = self._against(one, self._in_basis(one))[:, 0]
        found = -np.linalg.solve(np.eye(len(right)) + self.inner, right)
        return np.asarray(found.reshape(len(rows), -1))

    def whiten(self, rows: SlopeArray) -> None:
        """Whiten rows over sigma in place, (n_records, n, n_channels, n_samples)."""
        known = self._in_basis(rows)
        moved = self.removed @ self._against(rows, known)
        known -= (moved.T @ self._within).reshape(known.shape)
        known = _of_channels(self.taken, known).astype(rows.dtype)
        moved = moved.reshape(len(rows), -1, rows.shape[1]).astype(rows.dtype)
        for r in range(len(rows)):
            flat = self.directions[r].reshape(moved.shape[1], -1)
            rows[r] -= (moved[r].T @ flat).reshape(rows[r].shape)
            rows[r] -= known @ self.basis[r]

    def stored_as(self, rows: SlopeArray) -> "PointWhitening":
        """Return the whitening with its large arrays as rows are stored.

        Their products are then in that precision, and sums over records in double.
        """
        if rows.dtype == np.float64:
            return self
        directions, basis = (
            one.astype(np.float32) for one in (self.directions, self.basis)
        )
        return replace(self, directions=directions, basis=basis)

    @property
    def _within(self) -> FloatArray:
        """All directions in the basis, shape (n_all_directions, n_channels * n)."""
        return self.within.reshape(len(self.inner), -1)

    def _in_basis(self, rows: SlopeArray) -> FloatArray:
        """Return Q times rows, shape (n, n_channels, n_basis)."""
        _, count, channels, _ = rows.shape
        found = np.zeros((count, channels, self.basis.shape[1]))
        for row, basis in zip(rows, self.basis, strict=True):
            found += row @ basis.T
        return found

    def _against(self, rows: SlopeArray, known: FloatArray) -> FloatArray:
        """Return W A^-1 times rows, shape (n_all_directions, n).

        Args:
            rows: over sigma, shape (n_records, n, n_channels, n_samples).
            known: Q times them.
        """
        _, count, _, _ = rows.shape
        found = np.concatenate(
            [
                d.reshape(len(d), -1) @ row.reshape(count, -1).T
                for d, row in zip(self.directions, rows, strict=True)
            ]
        )
        twice = _of_channels(self.twice, known).reshape(count, -1)
        return np.asarray(found - self._within @ twice.T)


def _of_channels(matrices: FloatArray, known: FloatArray) -> FloatArray:
    """Return the product of the matrix of each channel, (n_channels, n, n), with rows.

    Args:
        matrices: symmetric.
        known: rows in the basis, shape (n_rows, n_channels, n).
    """
    return np.asarray((known.transpose(1, 0, 2) @ matrices).transpose(1, 0, 2))


@dataclass(frozen=True, slots=True, eq=False)
class TableWhitening:
    """Inverse root of the covariance of all records, by point.

    Attributes:
        records: of each point.
        points: their whitenings.
    """

    records: tuple[IntArray, ...]
    points: tuple[PointWhitening, ...]

    def __call__(self, rows: SlopeArray) -> None:
        """Whiten rows of records, shape (n_records, n, n_rows), in place."""
        step = STRUCTURE.columns_at_once
        for own, whole in zip(self.records, self.points, strict=True):
            point = whole.stored_as(rows)
            for first in range(0, rows.shape[1], step):
                some = slice(first, first + step)
                part = rows[own, some]
                block = part.reshape(*part.shape[:2], *point.directions.shape[2:])
                point.whiten(block)
                rows[own, some] = part

    def found(self, rows: FloatArray) -> FloatArray:
        """Return the most likely directions, shape (n_records, n_directions).

        Args:
            rows: model minus measurement over sigma, shape
                (n_records, n_channels, n_samples).
        """
        found = np.empty((len(rows), self.points[0].directions.shape[1]))
        for own, point in zip(self.records, self.points, strict=True):
            found[own] = point.found(rows[own])
        return found


def point_whitening(
    directions: FloatArray, errors: FloatArray, sd: FloatArray
) -> PointWhitening:
    """Return the whitening of the records of a point.

    Args:
        directions: derivatives by directions of unit sd, over sigma, shape
            (n_records, n_directions, n_channels, n_samples).
        errors: responses of unit error of the table, over the part of sigma that
            depends on the record, shape (n_records, n_errors, n_samples).
        sd: of these errors in each channel, over the other part, shape
            (n_channels, n_errors).
    """
    largest = np.maximum(sd.max(axis=0), STRUCTURE.least_direction)
    flat = (errors * largest[:, None]).transpose(1, 0, 2).reshape(largest.size, -1)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    kept = values > STRUCTURE.least_variance
    values, vectors = values[kept], vectors[:, kept]
    root = np.sqrt(values)
    basis = (vectors / root).T @ flat
    taken = np.stack([_taken((one / largest)[:, None] * vectors * root) for one in sd])
    return _whitening(directions, basis, taken)


def free_whitening(directions: FloatArray, errors: FloatArray) -> PointWhitening:
    """Return the whitening of the records of a point for errors of any size.

    Args:
        directions: as in `point_whitening`.
        errors: responses of unit error of the table, over the part of sigma that
            depends on the record, shape (n_records, n_errors, n_samples).
    """
    flat = errors.transpose(1, 0, 2).reshape(errors.shape[1], -1)
    size = np.linalg.norm(flat, axis=1)
    flat = flat[size > 0.0] / size[size > 0.0, None]
    values, vectors = np.linalg.eigh(flat @ flat.T)
    kept = values > MODAL_TABLE.free_rank * values[-1]
    basis = (vectors[:, kept] / np.sqrt(values[kept])).T @ flat
    taken = np.tile(np.eye(len(basis)), (directions.shape[2], 1, 1))
    return _whitening(directions, basis, taken)


def _whitening(
    directions: FloatArray, basis: FloatArray, taken: FloatArray
) -> PointWhitening:
    """Return the whitening with a basis of the errors, shape (n, n_rows)."""
    records, count, _, length = directions.shape
    basis = basis.reshape(len(basis), records, length).transpose(1, 0, 2)
    basis = np.ascontiguousarray(basis)
    within = np.stack([d @ q.T for d, q in zip(directions, basis, strict=True)])
    twice = 2.0 * taken - taken @ taken
    inner = -np.einsum(
        "rdca,cab,secb->rdse",
        within,
        twice,
        within,
        optimize=True,
    )
    for r, own in enumerate(directions):
        flat = own.reshape(count, -1)
        inner[r, :, r] += flat @ flat.T
    inner = inner.reshape(records * count, -1)
    removed = _removed(inner)
    return PointWhitening(directions, basis, taken, within, inner, removed, twice)


def _taken(rows: FloatArray) -> FloatArray:
    """Return N of the covariance I + R'R, so that its inverse root is I - N."""
    values, vectors = np.linalg.eigh(rows.T @ rows)
    share = 1.0 - 1.0 / np.sqrt(1.0 + np.maximum(values, 0.0))
    return np.asarray((vectors * share) @ vectors.T)


def _removed(inner: FloatArray) -> FloatArray:
    """Return M, so that I - W'MW is the inverse root of I + W'W, from WW'."""
    values, vectors = np.linalg.eigh(inner)
    values = np.maximum(values, STRUCTURE.least_direction)
    share = (1.0 - 1.0 / np.sqrt(1.0 + values)) / values
    return np.asarray((vectors * share) @ vectors.T)
