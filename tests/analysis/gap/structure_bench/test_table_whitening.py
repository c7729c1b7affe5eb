# SPDX-License-Identifier: MIT
"""Whitening of hits of a point with common errors, against dense covariances."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_bench.table_whitening import (
    PointWhitening,
    TableWhitening,
    free_whitening,
    point_whitening,
)

RECORDS, DIRECTIONS, CHANNELS, SAMPLES, ERRORS = 3, 2, 2, 11, 4


@pytest.fixture
def drawn() -> tuple[PointWhitening, FloatArray]:
    """Return a whitening of random errors, and the dense covariance."""
    rng = np.random.default_rng(498)
    own = rng.normal(size=(RECORDS, DIRECTIONS, CHANNELS, SAMPLES))
    errors = rng.normal(size=(RECORDS, ERRORS, SAMPLES))
    sd = rng.uniform(0.5, 2.0, size=(CHANNELS, ERRORS))
    size = RECORDS * CHANNELS * SAMPLES
    covariance = np.eye(size)
    for r in range(RECORDS):
        for d in range(DIRECTIONS):
            one = np.zeros((RECORDS, CHANNELS, SAMPLES))
            one[r] = own[r, d]
            covariance += np.outer(one, one)
    for c in range(CHANNELS):
        for k in range(ERRORS):
            one = np.zeros((RECORDS, CHANNELS, SAMPLES))
            one[:, c] = sd[c, k] * errors[:, k]
            covariance += np.outer(one, one)
    return point_whitening(own, errors, sd), covariance


def test_what_has_the_covariance_of_the_errors_becomes_white(
    drawn: tuple[PointWhitening, FloatArray],
) -> None:
    """The squared length is the chi2 of the dense covariance."""
    point, covariance = drawn
    rng = np.random.default_rng(499)
    rows = rng.normal(size=(RECORDS, 20, CHANNELS, SAMPLES))
    flat = rows.transpose(1, 0, 2, 3).reshape(20, -1)
    expected = flat @ np.linalg.solve(covariance, flat.T)
    point.whiten(rows)
    white = rows.transpose(1, 0, 2, 3).reshape(20, -1)
    np.testing.assert_allclose(white @ white.T, expected, rtol=1e-9, atol=1e-9)


def test_directions_of_hits_are_found_beside_common_errors(
    drawn: tuple[PointWhitening, FloatArray],
) -> None:
    """They are those of the posterior mean of the dense problem."""
    point, covariance = drawn
    rng = np.random.default_rng(500)
    rows = rng.normal(size=(RECORDS, CHANNELS, SAMPLES))
    expected = np.empty((RECORDS, DIRECTIONS))
    weighed = np.linalg.solve(covariance, rows.ravel())
    for r in range(RECORDS):
        for d in range(DIRECTIONS):
            one = np.zeros(rows.shape)
            one[r] = point.directions[r, d]
            expected[r, d] = -one.ravel() @ weighed
    np.testing.assert_allclose(point.found(rows), expected, rtol=1e-9)


def test_points_are_whitened_apart(drawn: tuple[PointWhitening, FloatArray]) -> None:
    """Records of one point in another order, beside a second one."""
    point, _ = drawn
    first, second = np.array([0, 2, 4]), np.array([1, 3, 5])
    whole = TableWhitening((first, second), (point, point))
    rng = np.random.default_rng(501)
    rows = rng.normal(size=(2 * RECORDS, 3, CHANNELS * SAMPLES))
    alone = rows[second].reshape(RECORDS, 3, CHANNELS, SAMPLES)
    whole(rows)
    point.whiten(alone)
    np.testing.assert_allclose(rows[second], alone.reshape(RECORDS, 3, -1))
    residual = rng.normal(size=(2 * RECORDS, CHANNELS, SAMPLES))
    np.testing.assert_allclose(
        whole.found(residual)[first], point.found(residual[first])
    )


def test_rows_in_single_precision_are_whitened_as_those_in_double(
    drawn: tuple[PointWhitening, FloatArray],
) -> None:
    """Slopes are stored so; those of a point keep their type and its rounding."""
    point, _ = drawn
    whole = TableWhitening((np.arange(RECORDS),), (point,))
    rows = np.random.default_rng(520).normal(size=(RECORDS, 9, CHANNELS * SAMPLES))
    single = rows.astype(np.float32)
    whole(rows)
    whole(single)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, rows, atol=3e-6)


def test_errors_of_any_size_are_taken_out_whole() -> None:
    """What is left has the chi2 of directions beside what no error explains."""
    rng = np.random.default_rng(501)
    own = rng.normal(size=(RECORDS, DIRECTIONS, CHANNELS, SAMPLES))
    errors = rng.normal(size=(RECORDS, ERRORS, SAMPLES))
    errors[:, -1] = 3.0 * errors[:, 0]  # a response that two errors make
    size = RECORDS * CHANNELS * SAMPLES
    spanned, moved = [], []
    for c in range(CHANNELS):
        for k in range(ERRORS - 1):
            one = np.zeros((RECORDS, CHANNELS, SAMPLES))
            one[:, c] = errors[:, k]
            spanned.append(one.ravel())
    for r in range(RECORDS):
        for d in range(DIRECTIONS):
            one = np.zeros((RECORDS, CHANNELS, SAMPLES))
            one[r] = own[r, d]
            moved.append(one.ravel())
    q = np.linalg.qr(np.transpose(spanned))[0]
    left = np.eye(size) - q @ q.T
    w = left @ np.transpose(moved)
    rows = rng.normal(size=(RECORDS, 1, CHANNELS, SAMPLES))
    y = left @ rows[:, 0].ravel()
    expected = y @ np.linalg.solve(np.eye(size) + w @ w.T, y)
    rows += 1e4 * errors[:, None, None, 1]
    free_whitening(own, errors).whiten(rows)
    assert np.sum(rows**2) == pytest.approx(expected, rel=1e-6)
