# SPDX-License-Identifier: MIT
"""What a screen draws of one hit: pulse, force spectrum, responses."""

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
    return {
        "hit": hit.number,
        "pulse": _pulse(force, edge, sample_rate),
        "spectrum": _spectrum(force, edge, sample_rate),
        "responses": {
            str(channel["name"]): _response(samples[i], edge, sample_rate)
            for i, channel in enumerate(channels)
            if i != row
        },
    }


def _pulse(force: FloatArray, edge: int, rate: float) -> list[list[float]]:
    first = max(0, edge - round(_BEFORE * rate))
    shown = force[first : first + round(_PULSE * rate)]
    step = max(1, shown.size // _PULSE_POINTS)
    time = (np.arange(shown.size) + first - edge) / rate * 1e3
    return [_rounded(time[::step], 4), _rounded(shown[::step], 3)]


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
    return [_rounded(frequency[: count * step : step], 2), _rounded(highest, 2)]


def _response(values: FloatArray, edge: int, rate: float) -> list[list[float]]:
    per_bin = max(1, values.size // _RESPONSE_BINS)
    count = values.size // per_bin
    parts = (values[: count * per_bin] - np.median(values)).reshape(count, per_bin)
    time = (np.arange(count) * per_bin - edge) / rate * 1e3
    return [
        _rounded(time, 3),
        [float(f"{v:.4g}") for v in parts.min(axis=1)],
        [float(f"{v:.4g}") for v in parts.max(axis=1)],
    ]


def _rounded(values: FloatArray, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]
