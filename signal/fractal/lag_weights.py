# SPDX-License-Identifier: MIT
"""Weights of the lags of a structure function: the Cholesky root of its covariance."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky
from scipy.linalg.lapack import dtrtrs

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.self_affine import SeenSurface

_JITTERS = (1e-9, 1e-7, 1e-5, 1e-3)
"""Variance added on the diagonal, as a share of it [-]; the first that suffices."""


@dataclass(frozen=True, slots=True, eq=False)
class Weights:
    """Weights of the lags.

    Attributes:
        reference: S to which the residuals are relative [m^2], shape (n_lags,).
        root: lower Cholesky root of the covariance of S over `reference` [-].
    """

    reference: FloatArray
    root: FloatArray

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the covariance of S."""
        size = np.diag(self.root) * self.reference
        return 2 * float(np.sum(np.log(size)))

    def whitened(self, gap: FloatArray) -> FloatArray:
        """Return relative gaps in units of their own scatter, shape unchanged [-].

        By LAPACK itself: scipy's `solve_triangular` takes longer to prepare the call
        than the few lags of a fit take to be solved.

        Args:
            gap: over `reference` [-], shape (n_lags,) or (n_lags, n_columns).

        Raises:
            LinAlgError: a gap is no number, or the root is singular.
        """
        white: FloatArray
        white, info = dtrtrs(self.root, gap, lower=True)
        if info or not np.isfinite(gap).all():
            raise LinAlgError("gaps of a fit are no numbers, or its root is singular")
        return white

    def backwards(self, white: FloatArray) -> FloatArray:
        """Return the weights of relative gaps in sums of whitened ones.

        Args:
            white: weights of the whitened ones, shape (n_lags, n_columns).
        """
        found: FloatArray = dtrtrs(self.root, white, lower=True, trans=1)[0]
        return found


def weigh(
    problem: FractalProblem, at: SeenSurface, *, scatter: FloatArray | None = None
) -> Weights:
    """Return the weights of a surface and its instrument.

    Args:
        problem: the structure function to fit.
        at: the surface and instrument.
        scatter: covariance of S to use instead of the one at `at`, shape (n, n) [-].
    """
    reference = problem.predicted(at)
    # Levelling may remove all of a poor start; the values are used instead.
    reference = np.where(reference > 0, reference, problem.estimate.value)
    own = problem.scatter(at) if scatter is None else scatter
    return Weights(reference, lower_root(own + problem.model_error(at)))


def lower_root(covariance: FloatArray) -> FloatArray:
    """Return the lower Cholesky root, with the least added variance required.

    On very smooth surfaces neighbouring lags are equal to more digits than the sums
    have; the added variance keeps their last digits out of the fit.
    """
    diagonal = np.diag(np.diag(covariance))
    for jitter in _JITTERS:
        try:
            return np.asarray(cholesky(covariance + jitter * diagonal, lower=True))
        except LinAlgError:
            continue
    return np.asarray(np.sqrt(diagonal))
