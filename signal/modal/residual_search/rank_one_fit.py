# SPDX-License-Identifier: MIT
"""Modes of rank one fitted to the lines around a peak.

The residue matrix of one mode is the product of its shape and its participation. With
that as a constraint two modes at one frequency are two, where residues fitted pair by
pair leave one pole with a residue of rank two.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.optimize import least_squares

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.modal.normal_equations import inverses
from jointbench.signal.modal.residual_search.peak_sums import PeakLines, sums_of_slopes

_EVALUATIONS = 100
# Step of numerical slopes, as a share of each parameter's scale.
_SLOPE_STEP = 1e-5
_RIDGE = 1e-12
# Values of a matrix of slopes above which its normal equations take its place.
_MOST_VALUES = 20_000_000
# Damping of a step, first and last; relative fall of chi-squared that ends a search.
_DAMPED, _STUCK, _SETTLED = 1e-3, 1e8, 1e-8


@dataclass(frozen=True, slots=True, eq=False)
class RankOneModes:
    """Modes at the optimum.

    Attributes:
        pole: [rad/s], shape (n_modes,).
        shape: of the rows, in the unit of a residue, shape (n_modes, n_rows).
        reference: participation with largest component 1, shape (n_modes, n_refs).
        cost: chi-squared of what is left [-].
        parameters: Re and Im of each pole over the width, then of each reference but
            its pivot.
    """

    pole: ComplexArray
    shape: ComplexArray
    reference: ComplexArray
    cost: float
    parameters: FloatArray


def fit_rank_one(
    peak: PeakLines, pole: ComplexArray, reference: ComplexArray
) -> RankOneModes:
    """Fit poles and references by variable projection; shapes are linear.

    Args:
        peak: the lines.
        pole: where the search begins [rad/s], shape (n_modes,).
        reference: likewise, shape (n_modes, n_references).
    """
    pivot, turned = _turned(reference)
    start = _packed(pole / peak.width, turned, pivot)

    def left(values: FloatArray) -> FloatArray:
        return _projected(peak, *_unpacked(peak, values, pivot))[1]

    def slopes(values: FloatArray) -> FloatArray:
        return _slopes(peak, *_unpacked(peak, values, pivot), pivot)

    if 2 * peak.response.size * start.size > _MOST_VALUES:
        values, cost = _by_sums(peak, start, pivot)
    else:
        found = least_squares(left, start, slopes, method="lm", max_nfev=_EVALUATIONS)
        values, cost = found.x, 2.0 * float(found.cost)
    poles, references = _unpacked(peak, values, pivot)
    # The search may have made another component the largest one.
    pivot, references = _turned(references)
    shape = _projected(peak, poles, references)[0]
    values = _packed(poles / peak.width, references, pivot)
    return RankOneModes(poles, shape, references, cost, values)


def _turned(reference: ComplexArray) -> tuple[IntArray, ComplexArray]:
    """Return which component of each reference is largest, and it scaled to 1 there."""
    pivot = np.argmax(np.abs(reference), axis=1)
    return pivot, reference / np.take_along_axis(reference, pivot[:, None], axis=1)


def _by_sums(
    peak: PeakLines, start: FloatArray, pivot: np.ndarray
) -> tuple[FloatArray, float]:
    """Search as Levenberg and Marquardt do, from sums alone.

    200 rows, 8 references and 2000 lines with 32 parameters are 1.6 GB of slopes, and
    MINPACK's factors of them take minutes; their sums take neither.
    """
    values, damped = start, _DAMPED
    gram, gradient, cost = sums_of_slopes(peak, *_unpacked(peak, values, pivot), pivot)
    for _ in range(_EVALUATIONS):
        scale = np.diag(gram)
        # A parameter that changes nothing stays where it is.
        scale = np.where(scale > 0.0, scale, scale.max())
        matrix = gram + damped * np.diag(scale)
        moved = values - scipy.linalg.solve(matrix, gradient, assume_a="pos")
        further = sums_of_slopes(peak, *_unpacked(peak, moved, pivot), pivot)
        fall = cost - further[2]
        if fall > 0.0:
            values, damped = moved, 0.1 * damped
            gram, gradient, cost = further
            if fall < _SETTLED * cost:
                break
        else:
            damped *= 10.0
            if damped > _STUCK:
                break
    return values, cost


def _packed(
    scaled: ComplexArray, reference: ComplexArray, pivot: np.ndarray
) -> FloatArray:
    free = np.ones(reference.shape, bool)
    free[np.arange(pivot.size), pivot] = False
    values = np.concatenate((scaled, reference[free]))
    return np.asarray(values.astype(complex)).view(np.float64).copy()


def _unpacked(
    peak: PeakLines, values: FloatArray, pivot: np.ndarray
) -> tuple[ComplexArray, ComplexArray]:
    numbers = np.ascontiguousarray(values).view(np.complex128)
    n_modes, n_references = pivot.size, peak.response.shape[1]
    reference = np.ones((n_modes, n_references), complex)
    free = np.ones(reference.shape, bool)
    free[np.arange(n_modes), pivot] = False
    reference[free] = numbers[n_modes:]
    return numbers[:n_modes] * peak.width, reference


def _projected(
    peak: PeakLines, pole: ComplexArray, reference: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """Solve for the shapes; return them and the whitened residual."""
    weight, scaled = _weighed(peak, _columns(peak, pole, reference))
    flat = peak.response.reshape(weight.shape[0], -1)
    data = np.concatenate((flat.real, flat.imag), axis=1) * weight
    found, left = _solved(scaled, data[:, :, None])
    shapes = np.ascontiguousarray(found[:, :, 0]).view(np.complex128)
    return np.asarray(shapes.T), left.ravel()


def _slopes(
    peak: PeakLines, pole: ComplexArray, reference: ComplexArray, pivot: np.ndarray
) -> FloatArray:
    """Return the slopes of the whitened residual, shape (n_residuals, n_parameters).

    Without the change of the pseudo-inverse, whose part of the gradient vanishes
    (Kaufman, BIT 15 (1975) 49-57).
    """
    shape = _projected(peak, pole, reference)[0]
    weight, scaled = _weighed(peak, _columns(peak, pole, reference))
    moved = _moved(peak, pole, reference, shape, pivot)
    both = np.concatenate((moved.real, moved.imag), axis=1) * weight[:, :, None]
    left = _solved(scaled, both)[1]
    return np.asarray(-left.reshape(-1, left.shape[2]))


def _weighed(peak: PeakLines, columns: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return one over the sd, and the columns of each row times it."""
    weight = np.tile((1.0 / peak.sd).reshape(peak.sd.shape[0], -1), 2)
    return weight, np.concatenate((columns.real, columns.imag)) * weight[:, :, None]


def _solved(scaled: FloatArray, data: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least-squares solution of each row, and what it leaves."""
    turned = scaled.transpose(0, 2, 1)
    found = inverses(turned @ scaled) @ (turned @ data)
    return found, data - scaled @ found


def _moved(
    peak: PeakLines,
    pole: ComplexArray,
    reference: ComplexArray,
    shape: ComplexArray,
    pivot: np.ndarray,
) -> ComplexArray:
    """Return the synthesis' slopes by the parameters at fixed shapes.

    Returns:
        Shape (n_rows, n_references n_lines, n_parameters).
    """
    power = peak.laplace**peak.derivatives
    inverse = 1.0 / (peak.laplace[:, None] - pole)
    mirrored = 1.0 / (peak.laplace[:, None] - pole.conj())
    residue = shape[:, :, None] * reference[:, None]
    parts: list[ComplexArray] = []

    def add(matrix: ComplexArray, own: ComplexArray, image: ComplexArray) -> None:
        """Add the slopes by Re and Im of a parameter, image that of its conjugate."""
        one = matrix[..., None] * (power * own)
        other = matrix.conj()[..., None] * (power * image)
        parts.extend((one + other, 1j * (one - other)))

    for number in range(pole.size):
        square = inverse[:, number] ** 2, mirrored[:, number] ** 2
        add(residue[number] * peak.width, *square)
    for number, column in np.ndindex(reference.shape):
        if column != pivot[number]:
            unit = np.zeros(residue.shape[1:], complex)
            unit[:, column] = shape[number]
            add(unit, inverse[:, number], mirrored[:, number])
    rows, columns, lines = parts[0].shape
    return np.stack(parts, axis=-1).reshape(rows, columns * lines, -1)


def _columns(
    peak: PeakLines, pole: ComplexArray, reference: ComplexArray
) -> ComplexArray:
    """Return responses to unit Re and Im of a shape, (n_refs n_lines, 2 n_modes)."""
    power = peak.laplace**peak.derivatives
    own = reference.T[:, None] * (power[:, None] / (peak.laplace[:, None] - pole))
    mirrored = power[:, None] / (peak.laplace[:, None] - pole.conj())
    image = reference.conj().T[:, None] * mirrored
    columns = np.stack((own + image, 1j * (own - image)), axis=-1)
    return np.asarray(columns.reshape(-1, 2 * pole.size))


def covariance(peak: PeakLines, modes: RankOneModes) -> tuple[FloatArray, FloatArray]:
    """Return the covariance of the poles, and the variance of all residues.

    Args:
        peak: the lines.
        modes: at the optimum.

    Returns:
        Covariance of (Re p, Im p) of each pole [rad^2/s^2], shape (n_modes, 2, 2), and
        slopes-propagated variance of Re and Im of each residue, shape
        (n_modes, n_rows, n_references, 2).
    """
    pivot = np.argmax(np.abs(modes.reference), axis=1)
    linear = np.ascontiguousarray(modes.shape.ravel()).view(np.float64)
    values = np.concatenate((modes.parameters, linear))
    size = float(np.abs(linear).max())
    scale = np.concatenate((np.ones(modes.parameters.size), np.full(linear.size, size)))

    def both(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        pole, reference = _unpacked(peak, at[: modes.parameters.size], pivot)
        shape = np.ascontiguousarray(at[modes.parameters.size :]).view(np.complex128)
        shape = shape.reshape(modes.shape.shape)
        return _whitened(peak, pole, shape, reference), _residues(shape, reference)

    here = both(values)
    slopes: list[list[FloatArray]] = [[], []]
    for number in range(values.size):
        moved = values.copy()
        moved[number] += _SLOPE_STEP * scale[number]
        for kept, now, before in zip(slopes, both(moved), here, strict=True):
            kept.append((now - before) / _SLOPE_STEP)
    gram = np.array(slopes[0]) @ np.array(slopes[0]).T
    norm = np.sqrt(np.diag(gram))
    ridge = _RIDGE * np.eye(norm.size)
    joint = np.linalg.inv(gram / np.outer(norm, norm) + ridge) / np.outer(norm, norm)
    n_modes = modes.pole.size
    index = np.arange(2 * n_modes).reshape(-1, 2)
    poles = joint[index[:, :, None], index[:, None, :]] * peak.width**2
    through = np.array(slopes[1])
    variance = np.einsum("pk,pq,qk->k", through, joint, through)
    shape = (n_modes, modes.shape.shape[1], modes.reference.shape[1], 2)
    return poles, np.maximum(variance, 0.0).reshape(shape)


def _whitened(
    peak: PeakLines, pole: ComplexArray, shape: ComplexArray, reference: ComplexArray
) -> FloatArray:
    columns = _columns(peak, pole, reference)
    numbers = np.ascontiguousarray(shape.T).view(np.float64)
    synthesis = (columns @ numbers.T).T.reshape(peak.response.shape) / peak.sd
    return np.concatenate((synthesis.real.ravel(), synthesis.imag.ravel()))


def _residues(shape: ComplexArray, reference: ComplexArray) -> FloatArray:
    residue = np.ascontiguousarray(shape[:, :, None] * reference[:, None])
    return residue.view(np.float64).ravel()
