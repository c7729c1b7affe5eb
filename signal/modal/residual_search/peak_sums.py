# SPDX-License-Identifier: MIT
"""The lines around a peak, and sums over them that a fit of rank-one modes needs.

Residuals and slopes of such a fit are combinations of few functions of the line: the
data, and the partial fractions of the poles and their squares. So their products are
sums of products of these functions, whose number does not grow with the parameters.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.modal.normal_equations import (
    correlations,
    gram_matrices,
    inverses,
)


@dataclass(frozen=True, slots=True, eq=False)
class PeakLines:
    """The lines around a peak, without the modes that stand apart from it.

    Attributes:
        laplace: s of each line [rad/s], shape (n_lines,).
        response: shape (n_rows, n_references, n_lines).
        sd: standard deviation of the error of real and of imaginary part, same shape.
        derivatives: of the FRF's kind.
        width: half the half-power width of the mode that is examined [rad/s].
    """

    laplace: ComplexArray
    response: ComplexArray
    sd: FloatArray
    derivatives: int
    width: float


def sums_of_slopes(
    peak: PeakLines, pole: ComplexArray, reference: ComplexArray, pivot: IntArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return J'J, J'r and r'r of a fit of rank-one modes whose shapes are solved for.

    Args:
        peak: the lines.
        pole: of the modes [rad/s], shape (n_modes,).
        reference: participation, shape (n_modes, n_references).
        pivot: the component of each reference that is held, shape (n_modes,).

    Returns:
        For the whitened residual r and its slopes J by the parameters of `RankOneModes`
        with the change of the projection left out: shapes (n, n), (n,) and a number.

    Source:
        Kaufman, BIT 15 (1975) 49-57.
    """
    n_rows, n_references, n_lines = peak.response.shape
    columns = _functions(peak, pole)
    weight = (1.0 / peak.sd**2).reshape(-1, n_lines)
    flat = peak.response.reshape(-1, n_lines)
    pairs = (n_rows, n_references)
    gram = gram_matrices(columns, weight).reshape(*pairs, -1, columns.shape[1])
    data = correlations(columns, flat * weight).reshape(*pairs, -1)
    linear = _linear_coefficients(reference)
    across = gram @ linear
    inverse = inverses(np.sum(linear.transpose(0, 2, 1) @ across, axis=1))
    onto = np.einsum("qkc,rqk->rc", linear, data)
    found = (inverse @ onto[:, :, None])[:, :, 0]
    cost = float(np.sum(np.abs(flat) ** 2 * weight) - np.sum(found * onto))
    shape = np.ascontiguousarray(found).view(np.complex128)
    moved = _moved_coefficients(peak.width, shape, reference, pivot)
    size = moved.shape[-1]
    stacked = moved.reshape(-1, size)
    full = stacked.T @ (gram @ moved).reshape(-1, size)
    shared = np.sum(across.transpose(0, 1, 3, 2) @ moved, axis=1)
    taken = np.sum(shared.transpose(0, 2, 1) @ inverse @ shared, axis=0)
    slope = stacked.T @ data.ravel() - np.einsum("rcp,rc->p", shared, found)
    return full - taken, -slope, cost


def _functions(peak: PeakLines, pole: ComplexArray) -> ComplexArray:
    """Return the functions of the line, as they are and times i, (n_lines, 8 n_modes).

    In turn: partial fractions of the poles, of their conjugates, and both squared.
    """
    power = (peak.laplace**peak.derivatives)[:, None]
    own = 1.0 / (peak.laplace[:, None] - pole)
    image = 1.0 / (peak.laplace[:, None] - pole.conj())
    functions = power * np.hstack((own, image, own**2, image**2))
    return np.asarray(np.hstack((functions, 1j * functions)))


def _as_pairs(own: ComplexArray, image: ComplexArray) -> FloatArray:
    """Return coefficients of Re and Im of a parameter from those of its functions.

    Args:
        own: coefficients of a unit parameter, its functions third to last but one,
            shape (..., n_functions, n).
        image: those of its conjugate.

    Returns:
        Real coefficients of the functions and of i times these, shape
        (..., 2 n_functions, 2 n).
    """
    both = np.stack((own + image, 1j * (own - image)), axis=-1)
    both = both.reshape(*own.shape[:-1], -1)
    return np.concatenate((both.real, both.imag), axis=-2)


def _linear_coefficients(reference: ComplexArray) -> FloatArray:
    """Return coefficients of unit Re and Im of shapes, (n_refs, 8 n_modes, 2 n)."""
    n_modes, n_references = reference.shape
    own = np.zeros((n_references, 4 * n_modes, n_modes), complex)
    image, index = own.copy(), np.arange(n_modes)
    own[:, index, index] = reference.T
    image[:, n_modes + index, index] = reference.T.conj()
    return _as_pairs(own, image)


def _moved_coefficients(
    width: float, shape: ComplexArray, reference: ComplexArray, pivot: IntArray
) -> FloatArray:
    """Return coefficients of the synthesis' slopes by the parameters.

    Returns:
        Shape (n_rows, n_references, 8 n_modes, n_parameters).
    """
    n_modes, n_references = reference.shape
    free = [(m, q) for m, q in np.ndindex(reference.shape) if q != pivot[m]]
    size = (shape.shape[0], n_references, 4 * n_modes, n_modes + len(free))
    own, image, index = np.zeros(size, complex), np.zeros(size, complex), range(n_modes)
    for m in index:
        residue = width * shape[:, m, None] * reference[m]
        own[:, :, 2 * n_modes + m, m] = residue
        image[:, :, 3 * n_modes + m, m] = residue.conj()
    for place, (m, q) in enumerate(free, start=n_modes):
        own[:, q, m, place] = shape[:, m]
        image[:, q, n_modes + m, place] = shape[:, m].conj()
    return _as_pairs(own, image)
