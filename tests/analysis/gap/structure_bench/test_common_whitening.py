# SPDX-License-Identifier: MIT
"""Whitening for errors that all records have in common, against a dense covariance."""

import numpy as np

from jointbench.analysis.gap.structure_bench.whitening import common_whitening


def test_what_all_records_have_in_common_becomes_white() -> None:
    """The squared length is the chi2 of the dense covariance."""
    rng = np.random.default_rng(515)
    errors = rng.normal(size=(3, 4, 2, 11))
    rows = rng.normal(size=(3, 5, 2, 11))
    flat = errors.transpose(1, 0, 2, 3).reshape(4, -1)
    covariance = np.eye(flat.shape[1]) + flat.T @ flat
    before = rows.transpose(1, 0, 2, 3).reshape(5, -1)
    expected = before @ np.linalg.solve(covariance, before.T)
    common_whitening(errors)(rows)
    white = rows.transpose(1, 0, 2, 3).reshape(5, -1)
    np.testing.assert_allclose(white @ white.T, expected, rtol=1e-9, atol=1e-9)
