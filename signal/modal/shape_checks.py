# SPDX-License-Identifier: MIT
"""Checks of mode shapes: MAC, modal phase collinearity and mean phase deviation."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import ShapeError


@dataclass(frozen=True, slots=True, eq=False)
class ShapeChecks:
    """Similarity of shapes, and how close each is to a real mode.

    Attributes:
        mac: of each pair, shape (n_modes, n_modes).
        collinearity: MPC of each [-], 1 for a real mode, shape (n_modes,).
        deviation: MPD of each [rad], 0 for a real mode, shape (n_modes,).
        phase: mean phase of each [rad], between -pi/2 and pi/2, shape (n_modes,).
    """

    mac: FloatArray
    collinearity: FloatArray
    deviation: FloatArray
    phase: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "mac", "collinearity", "deviation", "phase")


def check_shapes(shapes: ComplexArray) -> ShapeChecks:
    """Calculate MAC, MPC and MPD of shapes.

    Args:
        shapes: shape (n_modes, n_outputs).

    Returns:
        The checks; with a single output all are 1 or 0 and carry no information.
    """
    return ShapeChecks(
        mac_matrix(shapes, shapes),
        phase_collinearity(shapes),
        phase_deviation(shapes),
        mean_phase(shapes),
    )


def mac_matrix(one: ComplexArray, other: ComplexArray) -> FloatArray:
    """Return the modal assurance criterion of each shape with each other.

    Args:
        one: shape (n, n_outputs).
        other: shape (m, n_outputs).

    Returns:
        Between 0 and 1, shape (n, m); 0 where a shape is zero throughout.

    Raises:
        ShapeError: different numbers of outputs.

    Source:
        Allemang and Brown, IMAC 1 (1982) 110.
    """
    if one.ndim != 2 or other.ndim != 2 or one.shape[1] != other.shape[1]:
        raise ShapeError(
            f"shapes of {one.shape} and {other.shape} cannot be compared; give "
            "(modes, outputs) with the same outputs"
        )
    together = np.abs(one.conj() @ other.T) ** 2
    lengths = np.outer(np.sum(np.abs(one) ** 2, axis=1), np.sum(np.abs(other) ** 2, 1))
    return np.asarray(together / np.where(lengths > 0.0, lengths, 1.0))


def phase_collinearity(shapes: ComplexArray) -> FloatArray:
    """Return the modal phase collinearity: how nearly a shape is one line.

    The spread of the components in the complex plane has two principal values; for a
    real mode, rotated by any phase, the smaller is zero.

    Args:
        shapes: shape (n_modes, n_outputs).

    Returns:
        ((l1 - l2) / (l1 + l2))^2 [-], shape (n_modes,).

    Source:
        Pappa, Elliott and Schenk, J. Guidance, Control and Dynamics 16 (1993) 860.
    """
    real, imaginary = shapes.real, shapes.imag
    rr, ii = np.sum(real**2, axis=1), np.sum(imaginary**2, axis=1)
    cross = np.sum(real * imaginary, axis=1)
    apart, total = (rr - ii) ** 2 + 4.0 * cross**2, rr + ii
    return np.asarray(apart / np.where(total > 0.0, total, 1.0) ** 2)


def mean_phase(shapes: ComplexArray) -> FloatArray:
    """Return the phase of the straight line closest to a shape.

    Args:
        shapes: shape (n_modes, n_outputs).

    Returns:
        Between -pi/2 and pi/2 [rad], shape (n_modes,).
    """
    return np.asarray(0.5 * np.angle(np.sum(shapes**2, axis=1)))


def phase_deviation(shapes: ComplexArray) -> FloatArray:
    """Return the mean phase deviation from that line, weighted by amplitude.

    Args:
        shapes: shape (n_modes, n_outputs).

    Returns:
        0 to pi/2 [rad], shape (n_modes,).

    Source:
        Heylen, Lammens and Sas, Modal Analysis Theory and Testing (1997), A.6.
    """
    turned = shapes * np.exp(-1j * mean_phase(shapes))[:, None]
    size = np.abs(turned)
    angle = np.arctan2(np.abs(turned.imag), np.abs(turned.real))
    total = np.sum(size, axis=1)
    return np.asarray(np.sum(size * angle, axis=1) / np.where(total > 0.0, total, 1.0))


def real_shapes(shapes: ComplexArray) -> FloatArray:
    """Return the real modes nearest to complex ones.

    Args:
        shapes: shape (n_modes, n_outputs).

    Returns:
        Rotated to their mean phase, imaginary part left out, largest component 1, shape
        (n_modes, n_outputs).
    """
    turned = (shapes * np.exp(-1j * mean_phase(shapes))[:, None]).real
    largest = np.argmax(np.abs(turned), axis=1)[:, None]
    unit = np.take_along_axis(turned, largest, axis=1)
    return np.asarray(turned / np.where(unit != 0.0, unit, 1.0))
