# SPDX-License-Identifier: MIT
"""Prepare forces for the damped transform, with the end of their band tapered."""

import math
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.response_settings import RESPONSE

DAMPING_EXPONENT = RESPONSE.damping_exponent
PADDED = RESPONSE.transform_length
FADED = RESPONSE.faded_band


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """Prepared forces: their transform, and the time axis of the response.

    Attributes:
        spectrum: damped transform of the gated force, shape (n_records, n_lines).
        s: Laplace variable of the lines [rad/s], shape (n_lines,).
        growth: exp(a t), shape (n_samples,).
        hit: body that was hit, shape (n_records,).
        sample_rate: [Hz].
        damping: a [1/s].
        conditions: of each record.
        taper: of the nonlinear part near the Nyquist frequency, shape (n_lines,).
        padded: length of the transforms [samples], even.
    """

    spectrum: ComplexArray
    s: ComplexArray
    growth: FloatArray
    hit: IntArray
    sample_rate: float
    damping: float
    conditions: HitConditions
    taper: FloatArray
    padded: int


def prepare_excitation(
    force: FloatArray, hit: IntArray, sample_rate: float, conditions: HitConditions
) -> Excitation:
    """Transform the forces once.

    Args:
        force: [N], zero before the hit, shape (n_records, n_samples).
        hit: body that was hit, shape (n_records,).
        sample_rate: [Hz].
        conditions: of each record.
    """
    n = force.shape[1]
    padded = 2 * scipy.fft.next_fast_len(math.ceil(PADDED * n / 2), real=True)
    damping = DAMPING_EXPONENT * sample_rate / padded
    time = np.arange(n) / sample_rate
    spectrum = scipy.fft.rfft(force * np.exp(-damping * time), padded, axis=1)
    frequency = np.asarray(np.fft.rfftfreq(padded, 1 / sample_rate), dtype=float)
    spectrum *= _end_of_band(frequency / sample_rate, FADED)
    return Excitation(
        spectrum=spectrum,
        s=damping + 2j * np.pi * frequency,
        growth=np.exp(damping * time),
        hit=hit,
        sample_rate=sample_rate,
        damping=damping,
        conditions=conditions,
        taper=pass_band_end(frequency / sample_rate),
        padded=padded,
    )


def pass_band_end(frequency: FloatArray) -> FloatArray:
    """Return the gain of an anti-alias filter of which only the pass band is known.

    Args:
        frequency: over the sample rate [-].
    """
    return _end_of_band(frequency, 0.5 - RESPONSE.pass_band)


def _end_of_band(frequency: FloatArray, width: float) -> FloatArray:
    """Return half a cosine that falls from 1 to 0 over the end of the band."""
    edge = (0.5 - frequency) / width
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(edge, 0, 1)))
