# SPDX-License-Identifier: MIT
"""The benchmark case: eight modes with a 0.8 % pair, 40 outputs, 2 inputs, 4096 lines.

Two more modes stand beyond the band. Noise is complex and white, of an rms that is a
share of the rms of each FRF over the lines.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf, FrfKind

FREQUENCY = np.array(
    [48.7, 112.0, 166.5, 240.0, 310.7, 455.0, 458.5, 720.0, 1500.0, 2300.0]
)
DAMPING = np.array([1.2, 0.8, 1.0, 0.6, 0.9, 0.7, 1.1, 1.5, 1.0, 1.0]) / 100.0
WITHIN = 8
DRIVES = (39, 13)
# Shapes are mildly complex: this sd of phase [rad], drawn once from this seed.
_PHASE_SD, _PHASE_SEED = 0.03, 0


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """Exact FRF of the structure, and what is to be found.

    Attributes:
        frequency: lines [Hz], shape (n_lines,).
        exact: accelerance, shape (n_outputs, n_inputs, n_lines).
        natural_frequency: of the modes in the band [Hz], shape (8,).
        damping_ratio: of them [-], shape (8,).
        residues: of receptance, shape (8, n_outputs, n_inputs).
    """

    frequency: FloatArray
    exact: ComplexArray
    natural_frequency: FloatArray
    damping_ratio: FloatArray
    residues: ComplexArray

    def noisy(self, decibel: float, seed: int, *, known: bool = False) -> Frf:
        """Return the FRF with noise that far below its rms.

        Args:
            decibel: rms of each FRF over that of its noise [dB].
            seed: of the noise.
            known: whether the record states the noise.
        """
        rms = np.sqrt(np.mean(np.abs(self.exact) ** 2, axis=2, keepdims=True))
        sd = rms * 10.0 ** (-decibel / 20.0)
        parts = np.random.default_rng(seed).normal(size=(2, *self.exact.shape))
        variance = np.broadcast_to(sd**2, self.exact.shape).copy() if known else None
        return Frf(
            self.frequency,
            self.exact + sd * (parts[0] + 1j * parts[1]) / np.sqrt(2.0),
            FrfKind.ACCELERANCE,
            variance=variance,
        )


def benchmark_case(
    n_outputs: int = 40, n_lines: int = 4096, inputs: Sequence[int] = DRIVES
) -> Case:
    """Return the case; other numbers of outputs, lines and inputs for cost curves."""
    place = np.linspace(0.02, 1.0, n_outputs)[:, None]
    mode = np.arange(FREQUENCY.size)
    shape = np.sin((mode + 0.5) * np.pi * 0.97 * place + 0.3 * mode)
    phase = np.random.default_rng(_PHASE_SEED).normal(0.0, _PHASE_SD, shape.shape)
    shape = shape * np.exp(1j * phase)
    drives = shape[[min(d, n_outputs - 1) for d in inputs]]
    omega = 2.0 * np.pi * FREQUENCY
    residue = shape[:, None] * drives / (2j * omega)
    pole = omega * (-DAMPING + 1j * np.sqrt(1.0 - DAMPING**2))
    frequency = np.linspace(0.0, 1000.0, n_lines)
    s = 2j * np.pi * frequency
    exact = residue @ (1.0 / (s - pole[:, None]))
    exact += residue.conj() @ (1.0 / (s - pole.conj()[:, None]))
    return Case(
        frequency,
        exact * s**2,
        FREQUENCY[:WITHIN],
        DAMPING[:WITHIN],
        np.moveaxis(residue, 2, 0)[:WITHIN],
    )
