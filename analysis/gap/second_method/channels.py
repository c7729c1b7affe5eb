# SPDX-License-Identifier: MIT
"""Channels of the second route: filters and faults as functions of time."""

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.fft
from scipy.interpolate import CubicSpline

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.second_method.laws import values_by_name
from jointbench.analysis.gap.second_method.second_method_settings import (
    SECOND_METHOD,
)

Values = Mapping[str, float]
AT_SAMPLES = ("saturation", "hum")
"""Faults of the converter, after its filter; all others are before it."""


def anti_alias(
    signal: FloatArray, excitation: Excitation, points: int = SECOND_METHOD.force_points
) -> FloatArray:
    """Take what lies above the pass band out of a signal between the samples.

    Args:
        signal: from rest, shape (..., n_fine).
        excitation: its taper is the filter.
        points: of the signal per sample.

    Returns:
        The same, shape (..., n_fine).
    """
    count = signal.shape[-1]
    rate = excitation.sample_rate * points
    growth = np.exp(excitation.damping * np.arange(count) / rate)
    long, lines = excitation.padded * points, excitation.taper.size
    spectrum = scipy.fft.rfft(signal / growth, long, axis=-1)
    spectrum[..., :lines] *= excitation.taper
    spectrum[..., lines:] = 0.0
    return np.asarray(scipy.fft.irfft(spectrum, long, axis=-1)[..., :count] * growth)


def through_channels(
    signal: FloatArray, actions: Sequence[Action], sample_rate: float
) -> FloatArray:
    """Pass signals through the linear faults of their channels.

    Args:
        signal: `force_points` points per sample, shape (n_records, n_channels, n_fine).
        actions: effects; those not on channels are passed over.
        sample_rate: of the samples [Hz].

    Returns:
        The same, shape as `signal`.

    Raises:
        UsageError: an effect has no second route.
    """
    out = signal.copy()
    step = 1.0 / (sample_rate * SECOND_METHOD.force_points)
    for action in actions:
        name, p = action.entry.effect.name, values_by_name(action)
        if action.kind != "channel" or name in AT_SAMPLES:
            continue
        rows = slice(None) if action.index < 0 else [action.index]
        if name == "cross_talk":
            other = np.delete(out, action.index, axis=1).sum(axis=1)
            out[:, action.index] += p["frac"] * other
        elif name == "gain_error":
            out[:, rows] *= 1.0 + p["frac"]
        elif name == "polarity":
            out[:, rows] *= 1.0 - 2.0 * p["flip"]
        elif name == "delay":
            out[:, rows] = _later(out[:, rows], p["tau"], step)
        elif name == "sensor_lowpass":
            out[:, rows] = _lagging(out[:, rows], p["tau"], step)
        else:
            raise UsageError(
                f"effect {name!r} has no second route; write what it does to a "
                "signal in jointbench.analysis.gap.second_method.channels"
            )
    return out


def _later(signal: FloatArray, delay: float, step: float) -> FloatArray:
    """Return the signal of `delay` seconds ago; it was 0 before it began."""
    time = step * np.arange(signal.shape[-1])
    asked = time - delay
    moved = CubicSpline(time, signal, axis=-1)(np.clip(asked, 0.0, time[-1]))
    return np.where((asked >= 0.0) & (asked <= time[-1]), moved, 0.0)


def _lagging(signal: FloatArray, tau: float, step: float) -> FloatArray:
    """Solve tau y' + y = signal, exactly for the cubic spline through the points."""
    if tau <= 0.0:
        return signal
    from scipy.signal import lfilter  # slow to import, rarely needed

    time = step * np.arange(signal.shape[-1])
    pieces = CubicSpline(time, signal, axis=-1).c
    left = np.exp(-step / tau)
    moment, gained = 1.0 - left, np.zeros_like(pieces[0])
    for power, coefficient in enumerate(pieces[::-1]):
        if power:
            moment = step**power - power * tau * moment
        gained += coefficient * moment
    start = np.zeros((1, *gained.shape[1:]))
    out = lfilter([1.0], [1.0, -left], np.concatenate([start, gained]), axis=0)
    return np.moveaxis(np.asarray(out), 0, -1)


def through_converter(
    samples: FloatArray,
    actions: Sequence[Action],
    sample_rate: float,
    measured: FloatArray | None,
) -> FloatArray:
    """Add what happens to samples: flat tops, and hum at its own phase.

    Args:
        samples: shape (n_records, n_channels, n_samples).
        actions: effects.
        sample_rate: [Hz].
        measured: records from which hum takes its phase, shape as `samples`; without
            them the phase is 0.

    Returns:
        The same, shape as `samples`.
    """
    out = samples.copy()
    for action in actions:
        name, p = action.entry.effect.name, values_by_name(action)
        rows = slice(None) if action.index < 0 else [action.index]
        if name == "saturation" and p["inverse_limit"] > 0.0:
            limit = 1.0 / p["inverse_limit"]
            out[:, rows] = np.maximum(np.minimum(out[:, rows], limit), -limit)
        elif name == "hum":
            seen = None if measured is None else measured[:, rows] - out[:, rows]
            time = np.arange(out.shape[-1]) / sample_rate
            out[:, rows] += p["amp"] * _line(2 * np.pi * p["freq"] * time, seen)
    return out


def _line(angle: FloatArray, seen: FloatArray | None) -> FloatArray:
    """Return a line of amplitude 1 at the phase that fits best, by least squares."""
    if seen is None:
        return np.cos(angle)
    pair = np.stack([np.cos(angle), np.sin(angle)])
    weights = np.linalg.solve(pair @ pair.T, pair @ seen[..., None])
    unit = weights / np.maximum(np.linalg.norm(weights, axis=-2, keepdims=True), 1e-300)
    return np.asarray((unit * pair).sum(axis=-2))
