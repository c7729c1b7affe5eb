# SPDX-License-Identifier: MIT
"""Whitened residuals of values, and of values that are only known from below."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.special

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import JointRows


@dataclass(frozen=True, slots=True, eq=False)
class ValueResiduals:
    """How differences of logarithms become residuals.

    Attributes:
        rows: measured values.
        whitener: inverse root of their covariance, 0 for values known from below,
            shape (n_rows, n_rows).
        bound_sd: width of the likelihood of values known from below, shape (n_rows,).
    """

    rows: JointRows
    whitener: FloatArray
    bound_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "whitener", "bound_sd")

    def residual(self, raw: FloatArray) -> FloatArray:
        """Return the residual of predicted minus measured ln, shape (n_rows,)."""
        found, bound = self.whitener @ raw, self.rows.bound
        if bound.any():
            z = self._above(raw)
            # A bound that is exceeded by far costs nothing.
            found[bound] = np.sqrt(-2.0 * scipy.special.log_ndtr(z))
        return np.asarray(found)

    def slopes(self, raw: FloatArray, slopes: FloatArray) -> FloatArray:
        """Return the slopes of the residual from those of ln, shape (n_rows, n)."""
        found, bound = self.whitener @ slopes, self.rows.bound
        if bound.any():
            z = self._above(raw)
            log_phi = scipy.special.log_ndtr(z)
            density = np.exp(-0.5 * z**2 - 0.5 * np.log(2.0 * np.pi) - log_phi)
            root = np.maximum(np.sqrt(-2.0 * log_phi), 1e-12)
            down = -density / root / self.bound_sd[bound]
            found[bound] = down[:, None] * slopes[bound]
        return np.asarray(found)

    def _above(self, raw: FloatArray) -> FloatArray:
        """Return how far predictions lie above bounds of 95 % [sd]."""
        bound = self.rows.bound
        return np.asarray(raw[bound] / self.bound_sd[bound] + CONTACT.bound_z)


def value_residuals(rows: JointRows) -> ValueResiduals:
    """Return what whitens the values of a joint.

    Args:
        rows: values with their covariance.
    """
    found = np.zeros_like(rows.covariance)
    seen = np.flatnonzero(~rows.bound)
    root = np.linalg.cholesky(rows.covariance[np.ix_(seen, seen)])
    inverse = scipy.linalg.solve_triangular(root, np.eye(seen.size), lower=True)
    found[np.ix_(seen, seen)] = inverse
    own = np.sqrt(np.diag(rows.covariance))
    return ValueResiduals(rows, found, np.hypot(own, CONTACT.bound_sd))


def plain_residuals(rows: JointRows) -> ValueResiduals:
    """Return residuals that are differences of logarithms, bounds included.

    Args:
        rows: none of which is a bound.
    """
    return ValueResiduals(rows, np.eye(rows.value.size), np.ones(rows.value.size))
