# SPDX-License-Identifier: MIT
"""Uncertainty of residues and mode shapes, with the errors of the poles.

The error of a residue has a part at fixed poles, independent from FRF to FRF, and a
part from the error of the poles, common to all FRFs. A complex error e is carried as
E|e|^2 and E e^2, which a complex factor c turns into |c|^2 E|e|^2 and c^2 E e^2.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.refined_pole_covariance import Linearised, RefinedPoles


@dataclass(frozen=True, slots=True, eq=False)
class _Noise:
    """E|e|^2 and E e^2 of complex errors, of equal shape."""

    power: FloatArray
    pseudo: ComplexArray

    def turned(self, factor: ComplexArray) -> "_Noise":
        """Return the moments of factor times the error."""
        return _Noise(np.abs(factor) ** 2 * self.power, factor**2 * self.pseudo)

    def sum(self) -> "_Noise":
        """Return the moments of the sum of independent errors over the last axis."""
        return _Noise(self.power.sum(axis=-1), self.pseudo.sum(axis=-1))

    def sd(self) -> ComplexArray:
        """Return sd of real and imaginary part as one complex number."""
        real, imag = self.power + self.pseudo.real, self.power - self.pseudo.real
        parts = np.sqrt(np.maximum(0.5 * np.array([real, imag]), 0.0))
        return np.asarray(parts[0] + 1j * parts[1])


def residue_uncertainty(
    poles: RefinedPoles, residues: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Propagate the noise of the lines to residues and shapes, to first order.

    Args:
        poles: refined, with their linearisation.
        residues: shape (n_modes, n_outputs, n_inputs).

    Returns:
        Sd of residues, same shape, and of shapes with largest component 1, shape
        (n_modes, n_outputs): of the real part, and of the imaginary part as imaginary
        part, times the root of each mode's inflation.
    """
    n_modes, n_outputs, n_inputs = residues.shape
    noise = _residue_noise(poles.linearised, residues.shape)
    slope = poles.linearised.residue_slope
    # Computational poles follow the modes: only their errors are used.
    slope = slope[:, : 2 * n_modes].reshape(n_outputs, n_inputs, n_modes, 2, -1)
    slope = slope.transpose(2, 0, 1, 3, 4)
    moved = np.asarray(slope[:, :, :, 0] + 1j * slope[:, :, :, 1])
    joint = poles.linearised.poles
    inflation = np.sqrt(poles.inflation)
    residues_sd = _together(noise, moved, joint) * inflation[:, None, None]
    shapes_sd = [
        _shape_sd(residues[i], _Noise(noise.power[i], noise.pseudo[i]), moved[i], joint)
        for i in range(n_modes)
    ]
    shaped = np.array(shapes_sd).reshape(n_modes, n_outputs)
    return residues_sd, np.asarray(shaped * inflation[:, None])


def _residue_noise(linearised: Linearised, shape: tuple[int, int, int]) -> _Noise:
    """Return the noise of each residue at fixed poles, shape as residues."""
    n_modes, n_outputs, n_inputs = shape
    index = np.arange(2 * n_modes).reshape(-1, 2)
    blocks = linearised.residue_noise[:, index[:, :, None], index[:, None, :]]
    blocks = blocks.reshape(n_outputs, n_inputs, n_modes, 2, 2)
    blocks = blocks.transpose(2, 0, 1, 3, 4)
    real, imag, both = blocks[..., 0, 0], blocks[..., 1, 1], blocks[..., 0, 1]
    return _Noise(real + imag, np.asarray(real - imag + 2j * both))


def _together(noise: _Noise, moved: ComplexArray, joint: FloatArray) -> ComplexArray:
    """Return the sd from noise at fixed poles and from errors of the poles."""
    through = moved @ joint
    power = np.sum(through * moved.conj(), axis=-1).real
    pseudo = np.sum(through * moved, axis=-1)
    return _Noise(noise.power + power, noise.pseudo + pseudo).sd()


def _shape_sd(
    residue: ComplexArray, noise: _Noise, moved: ComplexArray, joint: FloatArray
) -> ComplexArray:
    """Return the sd of the shape of one residue matrix, shape (n_outputs,).

    With R = shape drive^T and the shape 1 at output k, to first order
    d shape_o = sum_i conj(drive_i) (dR_oi - shape_o dR_ki) / |drive|^2.
    """
    left, scale, right = np.linalg.svd(residue, full_matrices=False)
    largest = int(np.argmax(np.abs(left[:, 0])))
    unit = left[largest, 0]
    shape, drive = left[:, 0] / unit, scale[0] * right[0] * unit
    factor = drive.conj() / np.sum(np.abs(drive) ** 2)
    own = noise.turned(np.broadcast_to(factor, residue.shape)).sum()
    reference = _Noise(
        own.power[largest : largest + 1], own.pseudo[largest : largest + 1]
    )
    shared = reference.turned(-shape)
    carried = np.einsum("i,oip->op", factor, moved)
    carried = carried - shape[:, None] * carried[largest]
    total = _Noise(own.power + shared.power, own.pseudo + shared.pseudo)
    sd = _together(total, np.asarray(carried), joint)
    sd[largest] = 0.0
    return sd
