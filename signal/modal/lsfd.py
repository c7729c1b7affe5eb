# SPDX-License-Identifier: MIT
"""Residues of known poles by weighted linear least squares (LSFD), and their FRF."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
)
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.normal_equations import (
    combined,
    correlations,
    gram_matrices,
    inverses,
)
from jointbench.signal.modal.pole_columns import modal_basis


@dataclass(frozen=True, slots=True, eq=False)
class LinearFit:
    """Residues and residual terms of every FRF, and their covariance.

    Attributes:
        coefficients: Re and Im of each residue, pole by pole, then the residual terms,
            shape (n_frf, 2 n_modes + 9); residual terms on orthonormal columns.
        synthesis: the fitted FRF, shape (n_frf, n_lines).
        significance: increase of chi-squared if a mode were left out, summed over FRFs,
            shape (n_modes,).
    """

    coefficients: FloatArray
    synthesis: ComplexArray
    significance: FloatArray

    def of_modes(self, n_modes: int) -> "LinearFit":
        """Return the fit with only its first poles as modes."""
        return replace(self, significance=self.significance[:n_modes])

    def residues(self) -> ComplexArray:
        """Return receptance residues, shape (n_modes, n_frf)."""
        modal = self.coefficients[:, : 2 * self.significance.size]
        return np.asarray((modal[:, ::2] + 1j * modal[:, 1::2]).T)


def fit_residues(
    lines: FrfLines,
    pole: ComplexArray,
    variance: FloatArray,
    *,
    real_modes: bool = False,
) -> LinearFit:
    """Fit residues and residual terms to every FRF.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n_modes,).
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        real_modes: residues purely imaginary, as for proportional damping: half the
            unknowns, and a bias for other damping.

    Returns:
        The fit, its synthesis on the same lines, and the weight of each mode in it.

    Source:
        Heylen, Lammens and Sas, Modal Analysis Theory and Testing (1997), A.3.3.
    """
    basis = modal_basis(lines, pole)
    used = np.ones(basis.shape[1], bool)
    if real_modes:
        used[: 2 * pole.size : 2] = False
    solved, inverse = _solved(lines, basis[:, used], variance)
    n_frf, size = variance.shape[0], basis.shape[1]
    coefficients = np.zeros((n_frf, size))
    coefficients[:, used] = solved
    whole = np.tile(np.eye(size), (n_frf, 1, 1))
    whole[np.ix_(np.arange(n_frf), used, used)] = inverse
    significance = wald_significance(coefficients, whole, pole.size)
    return LinearFit(coefficients, combined(coefficients, basis), significance)


def pole_significance(
    lines: FrfLines, pole: ComplexArray, variance: FloatArray
) -> FloatArray:
    """Return the significance that `fit_residues` states, without its synthesis."""
    return wald_significance(
        *_solved(lines, modal_basis(lines, pole), variance), pole.size
    )


def _solved(
    lines: FrfLines, columns: ComplexArray, variance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the coefficients of columns in every FRF, and their covariance."""
    weight = 2.0 / variance
    inverse = inverses(gram_matrices(columns, weight))
    right = correlations(columns, weight * lines.response)
    return (inverse @ right[:, :, None])[:, :, 0], inverse


def wald_significance(
    coefficients: FloatArray, inverse: FloatArray, n_modes: int
) -> FloatArray:
    """Return the chi-squared of each residue against zero, summed over FRFs.

    Args:
        coefficients: residues first, shape (n_frf, n).
        inverse: covariance, residues first, shape (n_frf, n, n).
        n_modes: number of residues.

    Returns:
        Shape (n_modes,).
    """
    pairs = coefficients[:, : 2 * n_modes].reshape(coefficients.shape[0], n_modes, 2)
    index = np.arange(2 * n_modes).reshape(n_modes, 2)
    blocks = inverse[:, index[:, :, None], index[:, None, :]]
    solved = np.linalg.solve(blocks, pairs[..., None])[..., 0]
    return np.asarray(np.sum(pairs * solved, axis=(0, 2)))
