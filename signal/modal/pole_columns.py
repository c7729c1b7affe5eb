# SPDX-License-Identifier: MIT
"""Columns of the modal model: of residues, of poles, and of the residual terms.

The model, with s = j omega + added decay rate and q = 0, 1, 2 for receptance, mobility
and accelerance, is

    H(s) = s^q [ sum_r R_r / (s - p_r) + conj(R_r) / (s - conj(p_r))
                 + lower / s^2 + lower' / s + upper + upper' s + ... s^6 ]

so that residues are those of receptance for any kind of FRF, free of the window's
damping. The residual terms have real coefficients: mass below the band, stiffness above
it, and how that stiffness softens and is damped towards the modes above. With only the
two terms of the textbooks, strong modes beyond the band bias the damping of those
within.

Every array of columns lies in memory column by column: sums over lines take no copy.
"""

from weakref import WeakKeyDictionary

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.normal_equations import stacked

# Powers of s of the residual terms, in addition to the derivative of the FRF's kind.
_RESIDUAL_POWERS = (-2, -1, 0, 1, 2, 3, 4, 5, 6)
_ORTHONORMAL: WeakKeyDictionary[FrfLines, ComplexArray] = WeakKeyDictionary()
"""Columns of the residual terms: they depend on the lines alone, and a search asks for
them once for every set of poles that it looks at."""


def modal_basis(lines: FrfLines, pole: ComplexArray) -> ComplexArray:
    """Return the model's columns: two for each pole, then the residual terms.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n_modes,).

    Returns:
        Shape (n_lines, 2 n_modes + 9).
    """
    terms, size = _residual_terms(lines), 2 * pole.size
    rows = np.empty((size + terms.shape[1], lines.laplace.size), complex)
    rows[size:] = terms.T
    _fill_modes(lines, pole, rows[:size], rows[:0])
    return rows.T


def basis_and_slopes(lines: FrfLines, pole: ComplexArray) -> ComplexArray:
    """Return the columns of `modal_basis`, then d/dp of the two columns of each pole.

    Returns:
        Shape (n_lines, 4 n_modes + 9).
    """
    terms, size = _residual_terms(lines), 2 * pole.size
    rows = np.empty((2 * size + terms.shape[1], lines.laplace.size), complex)
    rows[size : size + terms.shape[1]] = terms.T
    _fill_modes(lines, pole, rows[:size], rows[size + terms.shape[1] :])
    return rows.T


def modal_columns(lines: FrfLines, pole: ComplexArray) -> ComplexArray:
    """Return the columns of Re and Im of each residue, shape (n_lines, 2 n_modes)."""
    rows = np.empty((2 * pole.size, lines.laplace.size), complex)
    _fill_modes(lines, pole, rows, rows[:0])
    return rows.T


def modal_size(lines: FrfLines, pole: ComplexArray) -> int:
    """Return how many columns `modal_basis` has for these poles."""
    offset = lines.end is not None and lines.end.sees_offset
    return 2 * pole.size + len(_RESIDUAL_POWERS) + offset


def beside(*parts: ComplexArray) -> ComplexArray:
    """Return columns side by side, each of shape (n_lines, n)."""
    return np.concatenate([part.T for part in parts]).T


def _fill_modes(
    lines: FrfLines, pole: ComplexArray, columns: ComplexArray, slopes: ComplexArray
) -> None:
    """Fill the rows of residues, and those of poles unless there are none."""
    q = lines.derivatives
    inverse = np.empty(0, complex)
    left = change = np.zeros_like(pole)
    if lines.end is not None:
        inverse = lines.end.inverse
        share, change = lines.end.shares(pole)
        left = pole**q * share
        change = pole**q * change + (q * pole ** (q - 1) * share if q else 0.0)
    modes = (pole, left, change)
    _fill(  # type: ignore[no-untyped-call]
        lines.laplace, lines.laplace**q, inverse, modes, columns, slopes
    )


@compiled(nogil=True)
def _fill(  # type: ignore[no-untyped-def]
    laplace, power, inverse, modes, columns, slopes
):
    """Fill the rows of each mode.

    Args:
        laplace: s of the lines [rad/s], shape (n_lines,).
        power: s^q, same shape.
        inverse: 1 over the force [1/N], same shape; empty without an end of the record.
        modes: pole [rad/s], what its decay holds at the end [N], and the derivative of
            that with respect to the pole, shape (n_modes,) each.
        columns: receives what residues of 1 and 1j add.
        slopes: receives their derivatives with respect to the pole, or has no rows.
    """
    pole, left, change = modes
    for i in range(pole.size):
        one, other = pole[i], np.conj(pole[i])
        for k in range(laplace.size):
            above, moved, beyond, returned = power[k], 0.0j, power[k], 0.0j
            if inverse.size:
                above, moved = above - left[i] * inverse[k], change[i] * inverse[k]
                beyond = beyond - np.conj(left[i]) * inverse[k]
                returned = np.conj(change[i]) * inverse[k]
            near = _reciprocal(laplace[k] - one)  # type: ignore[no-untyped-call]
            far = _reciprocal(laplace[k] - other)  # type: ignore[no-untyped-call]
            own, mirrored = above * near, beyond * far
            columns[2 * i, k] = own + mirrored
            apart = own - mirrored
            columns[2 * i + 1, k] = complex(-apart.imag, apart.real)
            if slopes.size:
                own, mirrored = (own - moved) * near, (mirrored - returned) * far
                slopes[2 * i, k] = own + mirrored
                apart = own - mirrored
                slopes[2 * i + 1, k] = complex(-apart.imag, apart.real)


@compiled(nogil=True, error_model="numpy")
def _reciprocal(value):  # type: ignore[no-untyped-def]
    size = value.real * value.real + value.imag * value.imag
    return complex(value.real / size, -value.imag / size)


def _residual_terms(lines: FrfLines) -> ComplexArray:
    """Return columns that span the residual terms, orthonormal over the lines.

    Plain powers of s are nearly collinear.
    """
    known = _ORTHONORMAL.get(lines)
    if known is None:
        s = lines.laplace
        scale, power = np.abs(s[s.size // 2]), s**lines.derivatives
        terms = [(s / scale) ** k * power for k in _RESIDUAL_POWERS]
        if lines.end is not None and lines.end.sees_offset:
            terms.append(lines.end.offset())
        rows = stacked(np.array([t / np.linalg.norm(t) for t in terms]).T)
        known = np.asfortranarray(_unstacked(np.linalg.qr(rows)[0]))
        _ORTHONORMAL[lines] = known
    return known


def _unstacked(rows: FloatArray) -> ComplexArray:
    """Undo `stacked`."""
    half = rows.shape[0] // 2
    return np.asarray(rows[:half] + 1j * rows[half:])
