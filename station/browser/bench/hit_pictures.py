# SPDX-License-Identifier: MIT
"""What a screen draws of one hit: pulse, force spectrum, responses."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.session_events.hit_events import HitJudged

_BEFORE, _PULSE = 1e-3, 6e-3  # [s] of the force before the trigger, and in all
_PULSE_POINTS = 300
_SPECTRUM = 0.05  # [s] of the force that the spectrum is taken of
_SPECTRUM_POINTS = 200
_FLOOR = -60.0  # [dB] below which a spectrum is not drawn
_RESPONSE_BINS = 240
_MOST_DIGITS = 20  # of a value far below any signal


def hit_picture(
    hit: HitJudged,
    samples: FloatArray,
    channels: Sequence[Mapping[str, Any]],
    sample_rate: float,
) -> dict[str, Any]:
    """Return a hit as JSON types.

    Args:
        hit: as judged.
        samples: of its record, SI units, shape (n_channels, n).
        channels: rows of the head of the recording.
        sample_rate: [Hz].

    Returns:
        ``pulse`` (time [ms], force [N]), ``spectrum`` (frequency [Hz], level [dB re
        its maximum]) and ``responses`` by channel (time [ms], smallest and largest
        value of each bin).
    """
    row = next((i for i, c in enumerate(channels) if c["quantity"] == "force"), 0)
    edge = hit.trigger - hit.start
    force = samples[row] - np.median(samples[row])
    others = [i for i in range(len(channels)) if i != row]
    drawn = _responses(samples[others], edge, sample_rate)
    return {
        "hit": hit.number,
        "pulse": _pulse(force, edge, sample_rate),
        "spectrum": _spectrum(force, edge, sample_rate),
        "responses": {
            str(channels[i]["name"]): response
            for i, response in zip(others, drawn, strict=True)
        },
    }


def _pulse(force: FloatArray, edge: int, rate: float) -> list[list[float]]:
    first = max(0, edge - round(_BEFORE * rate))
    shown = force[first : first + round(_PULSE * rate)]
    step = max(1, shown.size // _PULSE_POINTS)
    time = (np.arange(shown.size) + first - edge) / rate * 1e3
    return [time[::step].round(4).tolist(), shown[::step].round(3).tolist()]


def _spectrum(force: FloatArray, edge: int, rate: float) -> list[list[float]]:
    first = max(0, edge - round(_BEFORE * rate))
    pulse = force[first : first + round(_SPECTRUM * rate)]
    size = np.abs(np.fft.rfft(pulse))
    frequency = np.arange(size.size, dtype=np.float64) * (rate / pulse.size)
    top = float(size.max())
    if top == 0.0:
        return [[], []]
    level = np.maximum(20 * np.log10(np.maximum(size / top, 1e-9)), _FLOOR)
    step = max(1, level.size // _SPECTRUM_POINTS)
    count = level.size // step
    highest = level[: count * step].reshape(count, step).max(axis=1)
    drawn = frequency[: count * step : step]
    return [drawn.round(2).tolist(), highest.round(2).tolist()]


def _responses(values: FloatArray, edge: int, rate: float) -> list[list[list[float]]]:
    """Return time and extremes of each response, shape of ``values`` (n, samples)."""
    per_bin = max(1, values.shape[1] // _RESPONSE_BINS)
    count = values.shape[1] // per_bin
    parts = values[:, : count * per_bin].reshape(values.shape[0], count, per_bin)
    time = ((np.arange(count) * per_bin - edge) / rate * 1e3).round(3).tolist()
    level = np.median(values, axis=1)
    low, high = parts.min(axis=2), parts.max(axis=2)
    return [
        [time, *_to_digits(np.stack([low[i], high[i]]) - level[i])]
        for i in range(values.shape[0])
    ]


def _to_digits(values: FloatArray) -> list[list[float]]:
    """Return values with five digits of the largest, more than a plot resolves."""
    largest = float(np.abs(values).max(initial=0.0))
    digits = 4 - math.floor(math.log10(largest)) if largest else 0
    rounded: list[list[float]] = values.round(min(digits, _MOST_DIGITS)).tolist()
    return rounded
