# SPDX-License-Identifier: MIT
"""Spectra of the nonlinear forces at the ports of a modal base."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.port_forces import (
    PortLaw,
    PortModes,
    filled_lanes,
    need_velocity,
    port_forces,
)
from jointbench.analysis.gap.response.response_settings import RESPONSE


def force_spectra(
    excitation: Excitation,
    motion: ComplexArray,
    modes: PortModes,
    laws: Sequence[PortLaw],
    oversampling: int,
) -> ComplexArray:
    """Return damped spectra of the forces at the ports, up to the pass band.

    Args:
        excitation: time axis and Laplace line of the transforms.
        motion: of the ports without the laws [m s], damped spectra, shape
            (n_ports, n_records, n_lines).
        modes: between the ports.
        laws: at least one for each port.
        oversampling: steps of the time integration per sample.

    Returns:
        Shape of the motion; not finite if the motion diverges.
    """
    fine = _between_samples(excitation, motion, need_velocity(laws), oversampling)
    try:
        forces, halved = port_forces(
            fine,
            modes,
            1.0 / (excitation.sample_rate * oversampling),
            laws,
            extrapolated=oversampling >= RESPONSE.extrapolated_steps,
        )
    except ZeroDivisionError:  # compiled code reports an overflow as such
        return np.full(motion.shape, np.nan + 0j)
    records = motion.shape[1]
    spectra = _spectra(excitation, forces, records, oversampling)
    if halved is not None:
        coarse = _spectra(excitation, halved, records, oversampling // 2)
        spectra = (4.0 * spectra - coarse) / 3.0
    return np.asarray(spectra * excitation.taper)


def _between_samples(
    excitation: Excitation, motion: ComplexArray, moving: bool, oversampling: int
) -> FloatArray:
    """Return motions, and speeds if needed, (1 or 2, n_ports, n_steps, n_columns)."""
    ports, records, _ = motion.shape
    count = excitation.growth.size * oversampling
    spectra = [motion, motion * excitation.s] if moving else [motion]
    gain = oversampling * _growth(excitation, oversampling)
    rows = np.zeros((len(spectra), ports, count, filled_lanes(records)))
    for row, y in zip(rows, spectra, strict=True):
        x = scipy.fft.irfft(y, excitation.padded * oversampling, axis=-1)
        row[:, :, :records] = (x[..., :count] * gain).transpose(0, 2, 1)
    return rows


def _growth(excitation: Excitation, oversampling: int) -> FloatArray:
    """Return exp(a t) at `oversampling` steps per sample."""
    count = excitation.growth.size * oversampling
    dt = 1.0 / (excitation.sample_rate * oversampling)
    return np.asarray(np.exp(excitation.damping * dt * np.arange(count)))


def _spectra(
    excitation: Excitation, forces: FloatArray, records: int, oversampling: int
) -> ComplexArray:
    """Return damped spectra of forces in time, (n_ports, n_records, n_lines)."""
    rows = forces[:, :, :records].transpose(0, 2, 1)
    damped = rows / _growth(excitation, oversampling)
    spectrum = scipy.fft.rfft(damped, excitation.padded * oversampling, axis=-1)
    return np.asarray(spectrum[..., : excitation.taper.size] / oversampling)
