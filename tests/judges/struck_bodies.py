# SPDX-License-Identifier: MIT
"""Free bodies that are struck point by point, and their FRFs with scatter.

The motion is that of all dense modes of the body's matrices; a record lasts until it
has decayed, so its spectrum is that of the modes times that of the force. Noise is
added to the accelerations in time; FRFs are ratios of transforms, averaged over hits.
Nothing is shared with the reduction or with the coupling.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock

_PULSE = 0.8e-3


@dataclass(frozen=True, slots=True)
class Hammering:
    """How a body is measured.

    Attributes:
        hits: at each point.
        decibel: rms of a response over that of its noise [dB].
        rate: of samples [Hz].
        count: of samples of a record.
        damping: ratio of all elastic modes [-].
    """

    hits: int = 5
    decibel: float = 60.0
    rate: float = 4096.0
    count: int = 8192
    damping: float = 0.005


def dense_modes(
    stiffness: FloatArray, mass: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return all natural frequencies [rad/s] and mass-normalised shapes of a body."""
    value, shapes = scipy.linalg.eigh(stiffness, mass)
    omega = np.sqrt(np.maximum(value, 0.0))
    # What is left of rigid motions is rounding.
    omega[omega < 1e-3 * omega[10]] = 0.0
    return omega, shapes


def struck(
    name: str,
    modes: tuple[FloatArray, FloatArray],
    rows: FloatArray,
    how: Hammering,
    random: np.random.Generator,
) -> FrfBlock:
    """Strike every row of a body and return its FRFs as an average over hits."""
    omega, shapes = modes
    seen = rows @ shapes
    frequency = np.fft.rfftfreq(how.count, 1.0 / how.rate)
    line = 2.0 * np.pi * frequency
    force = np.fft.rfft(_pulse(how))
    swing = omega[:, None] ** 2 - line**2 + 2j * how.damping * omega[:, None] * line
    swing[omega == 0.0] = np.where(line > 0, -(line**2), -1.0)
    count = rows.shape[0]
    found = np.zeros((how.hits, count, count, frequency.size), complex)
    level = 10.0 ** (-how.decibel / 20.0)
    for point in range(count):
        clean = np.fft.irfft((seen * seen[point]) @ (-(line**2) / swing) * force)
        for hit in range(how.hits):
            noise = random.standard_normal(clean.shape)
            size = level * np.sqrt(np.mean(clean**2, axis=1))[:, None]
            found[hit, :, point] = np.fft.rfft(clean + size * noise) / force
    keep = (frequency >= 40.0) & (frequency <= 1200.0)
    scale = -1.0 / (2.0 * np.pi * frequency[keep]) ** 2
    found = found[..., keep] * scale
    variance = np.var(found, axis=0, ddof=1) / how.hits
    # Few hits scatter: neighbouring lines share their noise level.
    smooth = np.apply_along_axis(
        lambda row: np.convolve(row, np.ones(25) / 25.0, "same"), 2, variance
    )
    return FrfBlock(name, frequency[keep], found.mean(axis=0), smooth)


def _pulse(how: Hammering) -> FloatArray:
    time = np.arange(how.count) / how.rate
    inside = (time > 0.002) & (time < 0.002 + _PULSE)
    return np.where(inside, np.sin(np.pi * (time - 0.002) / _PULSE), 0.0)
