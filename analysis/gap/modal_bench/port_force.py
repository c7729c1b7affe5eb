# SPDX-License-Identifier: MIT
"""Force of the laws at a port, integrated along the motion of a modal base."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.force_integration import (
    COULOMB,
    CURVES,
    LANES,
    QUADRATIC_DAMPING,
    integrate_link_force,
)
from jointbench.analysis.gap.response.packed_laws import pack_laws
from jointbench.analysis.gap.response.response_settings import RESPONSE

_MOVING = (COULOMB, QUADRATIC_DAMPING, CURVES)


def port_force(
    excitation: Excitation,
    motion: ComplexArray,
    compliance: tuple[ComplexArray, ComplexArray],
    laws: Sequence[Law],
    oversampling: int,
) -> ComplexArray:
    """Return the damped spectrum of the force of all laws at a port.

    Args:
        excitation: time axis and Laplace line of the transforms.
        motion: linear motion across the port [m s], damped spectrum, shape
            (n_records, n_lines).
        compliance: poles [rad/s] and doubled residues [m/N rad/s] of the port's own
            compliance, each of shape (n_modes,).
        laws: that act there together.
        oversampling: steps of the time integration per sample.
    """
    fine = _between_samples(excitation, motion, laws, oversampling)
    force = _integrated(excitation, fine, compliance, laws, oversampling)
    if oversampling >= RESPONSE.extrapolated_steps and all(
        law.kind != COULOMB for law in laws
    ):
        half = _integrated(
            excitation, fine[:, ::2], compliance, laws, oversampling // 2
        )
        force = (4.0 * force - half) / 3.0
    return np.asarray(force * excitation.taper)


def _between_samples(
    excitation: Excitation, x: ComplexArray, laws: Sequence[Law], oversampling: int
) -> FloatArray:
    """Return motion, and speed if a law needs it, (1 or 2, n_steps, n_columns)."""
    count = excitation.growth.size * oversampling
    moving = any(law.kind in _MOVING for law in laws)
    spectra = [x, x * excitation.s] if moving else [x]
    gain = oversampling * _growth(excitation, oversampling)
    motions = np.zeros((len(spectra), count, -(-len(x) // LANES) * LANES))
    for motion_of, y in zip(motions, spectra, strict=True):
        rows = scipy.fft.irfft(y, excitation.padded * oversampling, axis=1)
        motion_of[:, : len(x)] = (rows[:, :count] * gain).T
    return motions


def _growth(excitation: Excitation, oversampling: int) -> FloatArray:
    count = excitation.growth.size * oversampling
    dt = 1 / (excitation.sample_rate * oversampling)
    return np.asarray(np.exp(excitation.damping * dt * np.arange(count)))


def _integrated(
    excitation: Excitation,
    motions: FloatArray,
    compliance: tuple[ComplexArray, ComplexArray],
    laws: Sequence[Law],
    oversampling: int,
) -> ComplexArray:
    motions = np.ascontiguousarray(motions)
    records = excitation.hit.size
    poles, residues = (np.tile(c[:, None], (1, records)) for c in compliance)
    dt = 1 / (excitation.sample_rate * oversampling)
    packed = pack_laws(laws)
    try:
        force = integrate_link_force(
            motions[0], motions[-1], poles, residues, dt, packed, len(motions) > 1
        )
    except ZeroDivisionError:  # compiled code reports an overflow as such
        return np.full((records, excitation.taper.size), np.nan + 0j)
    damped = force.T[:records] / _growth(excitation, oversampling)
    spectrum = scipy.fft.rfft(damped, excitation.padded * oversampling, axis=1)
    return np.asarray(spectrum[:, : excitation.taper.size] / oversampling)
