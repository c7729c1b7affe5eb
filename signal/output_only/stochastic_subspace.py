# SPDX-License-Identifier: MIT
"""Covariance-driven stochastic subspace identification of poles.

Correlations at positive lags are C A^(lag - 1) G of a linear system. Stacked in a
block Hankel matrix they factor into observability and controllability; the shift of
the observability gives A, its first rows give the shapes. One singular value
decomposition and one QR factorisation serve all orders.

Source:
    Peeters and De Roeck, Mechanical Systems and Signal Processing 13 (1999) 855.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.modal.lscf import OrderPoles


def subspace_poles(
    correlation: FloatArray,
    orders: Sequence[int],
    *,
    sample_rate: float,
    band: tuple[float, float],
    scale: FloatArray | None = None,
) -> tuple[OrderPoles, ...]:
    """Return the poles of the models of several orders.

    Args:
        correlation: lags from zero upward, shape (n_lags, n_outputs, n_references).
        orders: states of the model, ascending; two for each mode.
        sample_rate: one lag is one sample [Hz].
        band: poles outside it are left out [Hz].
        scale: of each output, for the shapes, shape (n_outputs,); None for ones.

    Returns:
        For each order its poles in the band with positive damping and their shapes,
        of unit length.
    """
    n_outputs = correlation.shape[1]
    observability = _observability(correlation, max(orders))
    upper, lower = observability[:-n_outputs], observability[n_outputs:]
    orthogonal, triangle = scipy.linalg.qr(upper, mode="economic")
    shifted = orthogonal.T @ lower
    # The inverse of a triangle nests: its leading blocks serve the lower orders.
    inverse = scipy.linalg.solve_triangular(triangle, np.eye(triangle.shape[0]))
    size = np.ones(n_outputs) if scale is None else scale
    return tuple(
        _order_poles(
            order,
            inverse[:order, :order] @ shifted[:order, :order],
            observability[:n_outputs, :order] * size[:, None],
            sample_rate,
            band,
        )
        for order in orders
    )


def most_states(correlation: FloatArray) -> int:
    """Return the largest order that these lags can carry."""
    n_lags, n_outputs, n_references = correlation.shape
    rows = n_lags // 2
    return int(min((rows - 1) * n_outputs, rows * n_references))


def _observability(correlation: FloatArray, order: int) -> FloatArray:
    """Return the leading left factor of the block Hankel matrix of lags 1, 2, ..."""
    n_lags, n_outputs, n_references = correlation.shape
    rows = n_lags // 2
    lag = 1 + np.arange(rows)[:, None] + np.arange(rows)
    blocks = correlation[lag].transpose(0, 2, 1, 3)
    hankel = blocks.reshape(rows * n_outputs, rows * n_references)
    # Left vectors only: a symmetric eigenproblem of the smaller side.
    if rows * n_outputs <= rows * n_references:
        values, vectors = _leading(hankel @ hankel.T, order)
        return np.asarray(vectors * np.maximum(values, 0.0) ** 0.25)
    values, vectors = _leading(hankel.T @ hankel, order)
    fourth_root = np.maximum(values, np.finfo(float).tiny) ** 0.25
    return np.asarray(hankel @ vectors / fourth_root)


def _leading(square: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Return the largest eigenvalues of a symmetric matrix, largest first."""
    size = square.shape[0]
    values, vectors = scipy.linalg.eigh(
        square, subset_by_index=(size - order, size - 1)
    )
    return values[::-1], vectors[:, ::-1]


def _order_poles(
    order: int,
    transition: FloatArray,
    observation: FloatArray,
    sample_rate: float,
    band: tuple[float, float],
) -> OrderPoles:
    roots, vectors = np.linalg.eig(transition)
    roots = np.asarray(roots, complex)
    safe = np.where(np.abs(roots) > 1e-12, roots, 1e-12)
    pole = np.asarray(sample_rate * np.log(safe), complex)
    frequency = np.abs(pole) / (2.0 * np.pi)
    kept = (pole.imag > 0.0) & (pole.real < 0.0)
    kept &= (frequency >= band[0]) & (frequency <= band[1])
    chosen = np.flatnonzero(kept)
    chosen = chosen[np.argsort(frequency[chosen])]
    shape = (observation @ vectors[:, chosen]).T
    length = np.linalg.norm(shape, axis=1, keepdims=True)
    unit = shape / np.where(length > 0.0, length, 1.0)
    return OrderPoles(order, pole[chosen], np.asarray(unit, complex))
