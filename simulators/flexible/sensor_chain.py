# SPDX-License-Identifier: MIT
"""From accelerations to counts: filter, noise, mains, offset, range."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.simulators.flexible.hit_records import SAMPLE_RATE, SAMPLES
from jointbench.simulators.measuring.converter import AntiAlias

OVERSAMPLING = 8
"""Steps of the structure in a sample."""
FULL_SCALE = 10.0
"""Range of every input [V]."""
COUNT = FULL_SCALE / 2**23
"""Volts per count of a converter with 24 bits, sign included."""
_CONVERTER = AntiAlias(
    oversampling=OVERSAMPLING, pass_band=0.43, stop_band=0.5, attenuation=100.0
)
RECORD_STEPS = SAMPLES * OVERSAMPLING + _CONVERTER.half_length + OVERSAMPLING
"""Steps from which `sampled` makes one record."""
_HAMMER = 2.25e-3  # [V/N]
_ACCELEROMETER = 0.1 / 9.80665  # [V s^2/m]
_HARMONICS = (1.0, 0.3)  # first and third of the mains, over the first


@dataclass(frozen=True, slots=True)
class InputNoise:
    """Noise of all inputs in one campaign.

    Attributes:
        force: white noise of the hammer [N].
        acceleration: white noise of each accelerometer [m/s^2].
        mains: amplitude over the white noise [-].
        mains_frequency: [Hz].
        offset: standard deviation of the offsets [V].
    """

    force: float
    acceleration: float
    mains: float
    mains_frequency: float
    offset: float


def sampled(force: FloatArray, signals: FloatArray) -> FloatArray:
    """Return force and signals of one hit through the anti-alias filter.

    Args:
        force: at every step [N], shape (n,).
        signals: at every step [m/s^2], shape (n_sensors, n).

    Returns:
        Shape (1 + n_sensors, SAMPLES); the filter is centred.
    """
    both = np.vstack((force, signals))
    half = _CONVERTER.half_length
    size = scipy.fft.next_fast_len(both.shape[1] + 2 * half, real=True)
    spectrum = scipy.fft.rfft(both, size) * scipy.fft.rfft(_CONVERTER.taps(), size)
    whole = scipy.fft.irfft(spectrum, size)[:, half:]
    return np.asarray(whole[:, : SAMPLES * OVERSAMPLING : OVERSAMPLING])


def digitised(
    physical: FloatArray, noise: InputNoise, time: float, rng: np.random.Generator
) -> IntArray:
    """Return the counts of one record.

    Args:
        physical: force [N] and accelerations [m/s^2], shape (n_channels, n).
        noise: of the inputs.
        time: of the record [s], to which the phase of the mains refers.
        rng: source of the noise.
    """
    scale = sensitivities(physical.shape[0])
    white = np.full(physical.shape[0], noise.acceleration)
    white[0] = noise.force
    moments = time + np.arange(physical.shape[1]) / SAMPLE_RATE
    turn = 2 * np.pi * noise.mains_frequency * moments
    first, third = _HARMONICS
    hum = first * np.sin(turn) + third * np.sin(3 * turn)
    values = physical + white[:, None] * rng.standard_normal(physical.shape)
    values += noise.mains * white[:, None] * hum
    offset = noise.offset * (1 + 0.02 * rng.standard_normal(white.size))
    volts = values * scale[:, None] + offset[:, None]
    top = round(FULL_SCALE / COUNT)
    counts = np.clip(np.round(volts / COUNT), -top, top - 1)
    return np.asarray(counts, dtype=np.int32)


def sensitivities(channels: int) -> FloatArray:
    """Return the sensitivity of the hammer [V/N] and of accelerometers [V s^2/m]."""
    found = np.full(channels, _ACCELEROMETER)
    found[0] = _HAMMER
    return found
