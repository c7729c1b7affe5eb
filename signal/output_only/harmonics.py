# SPDX-License-Identifier: MIT
"""Detect sines that look like modes: a rotating spindle leaves undamped lines.

Through a filter as narrow as the mode, a resonance driven by noise has a fluctuating
envelope (its power is exponentially distributed); that of a sine is constant.
"""

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Recording, response_rows

# Variance over squared mean of the power: 1 for noise, 0 for a sine.
_STEADY = 0.35
# Width of the filter in half-power half-widths, and its least width in lines: fewer
# hold too few independent envelopes.
_WIDTHS = 4.0
_LEAST_LINES = 40


def sine_like(recording: Recording, pole: ComplexArray) -> BoolArray:
    """Return which poles belong to a steady sine.

    Args:
        recording: its responses are used.
        pole: [rad/s], shape (n_modes,).

    Returns:
        True where the envelope of the strongest response is constant, shape (n_modes,).
    """
    spread = envelope_spread(recording, pole)
    return np.asarray(spread < _STEADY)


def envelope_spread(recording: Recording, pole: ComplexArray) -> FloatArray:
    """Return variance over squared mean of the power around each pole [-].

    Args:
        recording: its responses are used.
        pole: [rad/s], shape (n_modes,).

    Returns:
        About 1 for a resonance in noise, 0 for a sine; shape (n_modes,).

    Source:
        Bendat and Piersol, Random Data (2010), sec. 13.3 (envelope of narrow-band
        noise).
    """
    samples = recording.samples[list(response_rows(recording))]
    spectrum = scipy.fft.rfft(samples, axis=1)
    pitch = recording.sample_rate / samples.shape[1]
    return np.array([_spread(spectrum, pitch, p) for p in pole], np.float64)


def _spread(spectrum: ComplexArray, pitch: float, pole: complex) -> float:
    centre = round(abs(pole) / (2.0 * np.pi) / pitch)
    width = _WIDTHS * abs(pole.real) / (2.0 * np.pi) / pitch
    half = max(_LEAST_LINES, round(width)) // 2
    lines = spectrum[:, max(1, centre - half) : centre + half + 1]
    loudest = lines[int(np.argmax(np.sum(np.abs(lines) ** 2, axis=1)))]
    power = np.abs(scipy.fft.ifft(loudest)) ** 2
    mean = float(power.mean())
    return float(power.var() / mean**2) if mean > 0.0 else 1.0
