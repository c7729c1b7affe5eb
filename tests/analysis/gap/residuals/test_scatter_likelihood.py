# SPDX-License-Identifier: MIT
"""Restricted likelihood of scatter, against the same in extended precision."""

import mpmath
import numpy as np
import pytest

from jointbench.analysis.gap.residuals.scatter_likelihood import (
    CompressedRecords,
    weigh,
)


def _reference(
    records: CompressedRecords, variance: np.ndarray, rho: float
) -> tuple[float, float]:
    """Return log determinant and chi2 from the covariance itself, 120 digits."""
    n, k = variance.shape
    with mpmath.workdps(120):
        covariance = mpmath.eye(n * k)
        along = mpmath.matrix(records.along.ravel().tolist())
        for i in range(n):
            for j in range(n):
                size = np.sqrt(variance[i] * variance[j]) * rho ** abs(i - j)
                left = mpmath.matrix(records.factor[i].tolist())
                right = mpmath.matrix(records.factor[j].tolist())
                block = left * mpmath.diag(size.tolist()) * right.T
                for a in range(k):
                    for b in range(k):
                        covariance[i * k + a, j * k + b] += block[a, b]
        inverse = covariance**-1
        chi2 = (along.T * inverse * along)[0] + float(records.beside.sum())
        return float(mpmath.log(mpmath.det(covariance))), float(chi2)


@pytest.mark.parametrize("rho", [0.0, 0.6])
@pytest.mark.parametrize("steep", [1.0, 1e11])
def test_weigh_holds_where_derivatives_are_steep(rho: float, steep: float) -> None:
    """A joint near divergence has derivatives of 1e11 noises along one direction."""
    rng = np.random.default_rng(5)
    factor = rng.standard_normal((4, 3, 3))
    factor[:, :, 0] *= steep
    records = CompressedRecords(factor, rng.standard_normal((4, 3)), np.ones(4))
    variance = np.full((4, 3), 0.5)

    weighed = weigh(records, variance, rho)

    log_determinant, chi2 = _reference(records, variance, rho)
    assert weighed.log_determinant == pytest.approx(log_determinant, rel=1e-6)
    assert weighed.chi2 == pytest.approx(chi2, rel=1e-3)
