# SPDX-License-Identifier: MIT
"""Complex modes of a structure with local dampers, overdamped ones included.

Dampers at joints are not proportional to stiffness or mass: modes are complex, and some
do not oscillate. The receptance is a sum over all poles, of either kind.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData

# Imaginary part of a pole relative to its size, below which it does not oscillate.
_REAL = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class PoleSet:
    """A receptance as a sum over poles.

    H(s) = sum w_r c_r b_r / (s - pole_r) + residual, where poles that oscillate are
    taken together with their conjugates.

    Attributes:
        poles: with an imaginary part >= 0, by size [1/s], shape (n_poles,).
        outputs: c, shape (n_outputs, n_poles).
        inputs: b, shape (n_poles, n_inputs).
        shapes: motion of the coordinates, shape (n_coordinates, n_poles).
        residual: static flexibility of poles that are left out [m/N], shape (n_outputs,
            n_inputs).
    """

    poles: ComplexArray
    outputs: ComplexArray
    inputs: ComplexArray
    shapes: ComplexArray
    residual: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "poles", "outputs", "inputs", "shapes", "residual")

    @property
    def oscillates(self) -> BoolArray:
        """Whether each pole has a conjugate, shape (n_poles,)."""
        return np.asarray(self.poles.imag > 0.0)

    @property
    def natural_frequency(self) -> FloatArray:
        """Size of each pole over 2 pi [Hz], shape (n_poles,)."""
        return np.asarray(np.abs(self.poles) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> FloatArray:
        """Damping ratio of each pole [-]; one for those that do not oscillate."""
        return np.asarray(-self.poles.real / np.abs(self.poles))

    def lowest(self, count: int) -> "PoleSet":
        """Return the `count` smallest poles; the others remain as static flexibility.

        Args:
            count: of poles.
        """
        if count >= self.poles.size:
            return self
        left = np.s_[count:]
        static = _static(self.poles[left], self.outputs[:, left], self.inputs[left])
        return PoleSet(
            self.poles[:count],
            self.outputs[:, :count],
            self.inputs[:count],
            self.shapes[:, :count],
            self.residual + static,
        )

    def receptance(self, frequency: FloatArray) -> ComplexArray:
        """Return the receptance on lines.

        Args:
            frequency: [Hz], shape (n_lines,).

        Returns:
            [m/N], shape (n_outputs, n_inputs, n_lines).
        """
        s = 2j * np.pi * frequency
        direct = 1.0 / (s[:, None] - self.poles)
        mirror = np.where(self.oscillates, 1.0 / (s[:, None] - self.poles.conj()), 0.0)
        both = np.einsum("or,ri,lr->oil", self.outputs, self.inputs, direct)
        both += np.einsum(
            "or,ri,lr->oil", self.outputs.conj(), self.inputs.conj(), mirror
        )
        return np.asarray(both + self.residual[:, :, None])


def _static(
    poles: ComplexArray, outputs: ComplexArray, inputs: ComplexArray
) -> FloatArray:
    """Return the static flexibility of poles and their conjugates."""
    weight = np.where(poles.imag > 0.0, 2.0, 1.0) / -poles
    return np.asarray(np.einsum("or,r,ri->oi", outputs, weight, inputs).real)


def viscous_loss(eigenvalue: FloatArray, loss: FloatArray) -> FloatArray:
    """Return viscous damping with the loss of structural damping at each mode.

    Structural damping has no causal form in time. Each undamped mode gets the viscous
    damping with the same loss at its own natural frequency.

    Args:
        eigenvalue: of the undamped modes [1/s^2], shape (n,).
        loss: phi' (eta K) phi [1/s^2], shape (n, n).

    Returns:
        Damping of each mode [1/s], shape (n,).

    Source:
        Ewins, Modal Testing (2000), sec. 2.4.
    """
    safe = np.where(eigenvalue > 0.0, eigenvalue, np.inf)
    return np.asarray(np.diag(loss) / np.sqrt(safe))


def solve_poles(
    eigenvalue: FloatArray, damping: FloatArray, outputs: FloatArray, inputs: FloatArray
) -> PoleSet:
    """Find all poles of a structure that no rigid motion is left to.

    Args:
        eigenvalue: of the undamped modes, whose coordinates are used here [1/s^2],
            shape (n,).
        damping: C in these coordinates, viscous, of any kind [1/s], shape (n, n).
        outputs: rows of the outputs, shape (n_outputs, n).
        inputs: rows of the inputs, shape (n_inputs, n).

    Returns:
        The poles, by size.

    Raises:
        BadData: a motion without stiffness is left.

    Source:
        Ewins, Modal Testing (2000), sec. 2.7: the state matrix and its inverse
        eigenvectors, which also holds for poles of equal size.
    """
    if not eigenvalue.min() > 0.0:
        raise BadData(
            "the machine can move without strain (a body floats): hold it by a "
            "support, or give every joint a stiffness"
        )
    omega, size = np.sqrt(eigenvalue), eigenvalue.size
    # States are omega times displacement, and velocity: both of the size of velocity.
    state = np.zeros((2 * size, 2 * size))
    state[:size, size:] = np.diag(omega)
    state[size:, :size] = -np.diag(omega)
    state[size:, size:] = -damping
    pole, vector = np.linalg.eig(state)
    load = np.zeros((2 * size, inputs.shape[0]))
    load[size:] = inputs.T
    left = np.linalg.solve(vector, load)
    shape = vector[:size] / omega[:, None]
    pole = np.where(np.abs(pole.imag) > _REAL * np.abs(pole), pole, pole.real + 0j)
    kept = np.flatnonzero(pole.imag >= 0.0)
    kept = kept[np.argsort(np.abs(pole[kept]), kind="stable")]
    none = np.zeros((outputs.shape[0], inputs.shape[0]))
    return PoleSet(
        pole[kept],
        np.asarray(outputs @ shape[:, kept], complex),
        np.asarray(left[kept], complex),
        np.asarray(shape[:, kept], complex),
        none,
    )
