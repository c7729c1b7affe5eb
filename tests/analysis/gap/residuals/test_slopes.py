# SPDX-License-Identifier: MIT
"""Sums over slopes that are stored in single precision, against sums in double."""

import numpy as np
import pytest

from jointbench.analysis.gap.residuals.slopes import (
    SlopeArray,
    along_columns,
    curvature,
    linear_change,
    squared_norms,
)


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_sums_are_those_of_double_precision(
    precision: type[np.float32] | type[np.float64],
) -> None:
    """More rows than are taken at once; two columns that hardly differ.

    Along their difference the curvature is a millionth of that along each: summed in
    single precision it is hardly there.
    """
    rng = np.random.default_rng(517)
    exact = rng.normal(size=(3, 100_001))
    exact[1] = exact[0] + 1e-3 * exact[1]
    slopes: SlopeArray = exact.astype(precision).T
    stored = slopes.astype(np.float64)
    rows, step = rng.normal(size=len(slopes)), rng.normal(size=3)
    np.testing.assert_allclose(curvature(slopes), stored.T @ stored, rtol=1e-11)
    across = np.array([1.0, -1.0, 0.0])
    seen = across @ curvature(slopes) @ across
    np.testing.assert_allclose(seen, np.sum((stored @ across) ** 2), rtol=1e-6)
    np.testing.assert_allclose(squared_norms(slopes), np.sum(stored**2, axis=0))
    np.testing.assert_allclose(along_columns(slopes, rows), stored.T @ rows, rtol=1e-9)
    np.testing.assert_allclose(linear_change(slopes, step), stored @ step, atol=1e-12)
