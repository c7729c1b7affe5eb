# SPDX-License-Identifier: MIT
"""Residues of known poles by weighted linear least squares (LSFD), and their FRF.

The model, with s = j omega + added decay rate and q = 0, 1, 2 for receptance, mobility
and accelerance, is

    H(s) = s^q [ sum_r R_r / (s - p_r) + conj(R_r) / (s - conj(p_r))
                 + lower / s^2 + lower' / s + upper + upper' s + ... s^6 ]

so that residues are always those of receptance, whatever was measured, and the window's
damping never enters them. The residual terms have real coefficients: mass below the
band, stiffness above it, and how that stiffness softens and is damped towards the modes
above. Two terms only, as the textbooks have it, let strong modes beyond the band bias
the damping of those within.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.frf import Frf

# Powers of s of the residual terms, beside the derivative of the FRF's kind.
_RESIDUAL_POWERS = (-2, -1, 0, 1, 2, 3, 4, 5, 6)
_RIDGE = 1e-13


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """The lines of an FRF that are being fitted.

    Attributes:
        laplace: s of each line [rad/s], shape (n_lines,).
        response: FRF, one row for each pair of output and input, shape
            (n_frf, n_lines).
        derivatives: q of the FRF's kind.
    """

    laplace: ComplexArray
    response: ComplexArray
    derivatives: int


@dataclass(frozen=True, slots=True, eq=False)
class LinearFit:
    """Residues and residual terms of every FRF, and how well they are known.

    Attributes:
        coefficients: Re and Im of each residue, pole by pole, then the residual terms,
            shape (n_frf, 2 n_modes + 9).
        synthesis: the fitted FRF, shape (n_frf, n_lines).
        significance: chi-squared lost if a mode were left out, summed over FRFs,
            shape (n_modes,).
    """

    coefficients: FloatArray
    synthesis: ComplexArray
    significance: FloatArray

    def residues(self) -> ComplexArray:
        """Return receptance residues, shape (n_modes, n_frf)."""
        modal = self.coefficients[:, : 2 * self.significance.size]
        return np.asarray((modal[:, ::2] + 1j * modal[:, 1::2]).T)


def measured_width(lines: Lines, pole: ComplexArray) -> FloatArray:
    """Return half the half-power width of each peak as measured [rad/s].

    The exponential window's decay rate is part of it.
    """
    return np.asarray(np.abs(pole.real - lines.laplace[0].real))


def lines_of(frf: Frf, keep: BoolArray) -> Lines:
    """Take the kept lines of an FRF.

    Args:
        frf: any kind.
        keep: True for the lines to fit, shape (n_lines,).

    Returns:
        The lines with one row a pair of output and input, inputs varying fastest.
    """
    laplace = np.asarray(2j * np.pi * frf.frequency[keep] + frf.added_decay_rate)
    response = frf.response[:, :, keep].reshape(-1, laplace.size)
    return Lines(laplace, response, frf.kind.derivatives)


def modal_basis(lines: Lines, pole: ComplexArray) -> ComplexArray:
    """Return the model's columns: two for each pole, then the residual terms.

    Args:
        lines: what is fitted.
        pole: [rad/s], shape (n_modes,).

    Returns:
        Shape (n_lines, 2 n_modes + 9).
    """
    s = lines.laplace
    own, mirrored = (1.0 / (s[:, None] - p) for p in (pole, pole.conj()))
    columns = np.empty((s.size, modal_size(pole)), complex)
    columns[:, 0 : 2 * pole.size : 2] = own + mirrored
    columns[:, 1 : 2 * pole.size : 2] = 1j * (own - mirrored)
    # Scaled to the middle of the band, so that all columns are of one size.
    scale = np.abs(s[s.size // 2])
    for i, power in enumerate(_RESIDUAL_POWERS):
        columns[:, 2 * pole.size + i] = (s / scale) ** power
    return np.asarray(columns * (s**lines.derivatives)[:, None])


def modal_size(pole: ComplexArray) -> int:
    """Return how many columns `modal_basis` has for these poles."""
    return 2 * pole.size + len(_RESIDUAL_POWERS)


def stacked(values: ComplexArray) -> FloatArray:
    """Return real and imaginary parts one below the other, as real rows."""
    return np.concatenate((values.real, values.imag))


def unstacked(rows: FloatArray) -> ComplexArray:
    """Undo `stacked`."""
    half = rows.shape[0] // 2
    return np.asarray(rows[:half] + 1j * rows[half:])


def solve_gram(gram: FloatArray, right: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Solve normal equations after scaling them to a unit diagonal.

    Args:
        gram: symmetric, shape (n, n).
        right: shape (n,) or (n, k).

    Returns:
        The solution, shaped as `right`, and the inverse of `gram`.
    """
    diagonal = np.sqrt(np.diag(gram))
    scale = 1.0 / np.where(diagonal > 0.0, diagonal, 1.0)
    scaled = gram * np.outer(scale, scale) + _RIDGE * np.eye(scale.size)
    inverse = scipy.linalg.pinvh(scaled) * np.outer(scale, scale)
    return inverse @ right, inverse


def fit_residues(lines: Lines, pole: ComplexArray, variance: FloatArray) -> LinearFit:
    """Fit residues and residual terms to every FRF.

    Args:
        lines: what is fitted.
        pole: [rad/s], shape (n_modes,).
        variance: E|error|^2 of each line, shape (n_frf, n_lines).

    Returns:
        The fit, its synthesis on the same lines, and the weight of each mode in it.

    Source:
        Heylen, Lammens and Sas, Modal Analysis Theory and Testing (1997), A.3.3.
    """
    basis = modal_basis(lines, pole)
    columns = stacked(basis)
    coefficients = np.empty((lines.response.shape[0], basis.shape[1]))
    significance = np.zeros(pole.size)
    for i, (response, noise) in enumerate(zip(lines.response, variance, strict=True)):
        weight = np.tile(np.sqrt(2.0 / noise), 2)
        weighted = columns * weight[:, None]
        right = weighted.T @ (stacked(response) * weight)
        coefficients[i], inverse = solve_gram(weighted.T @ weighted, right)
        significance += _wald(coefficients[i], inverse, pole.size)
    return LinearFit(coefficients, coefficients @ basis.T, significance)


def _wald(coefficients: FloatArray, inverse: FloatArray, n_modes: int) -> FloatArray:
    """Return the chi-squared of each residue against zero, shape (n_modes,)."""
    pairs = coefficients[: 2 * n_modes].reshape(n_modes, 2)
    index = np.arange(2 * n_modes).reshape(n_modes, 2)
    blocks = inverse[index[:, :, None], index[:, None, :]]
    solved = np.linalg.solve(blocks, pairs[:, :, None])[:, :, 0]
    return np.asarray(np.sum(pairs * solved, axis=1))
