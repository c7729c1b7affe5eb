# SPDX-License-Identifier: MIT
"""Duration of the force pulse; if it cannot be a hammer's, the time unit is wrong."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Quantity, Recording, Samples

SHORTEST_PULSE, LONGEST_PULSE = 10e-6, 50e-3
"""Half-height duration of a hammer's force pulse [s]: a steel tip on a needle hammer to
a sledge with the softest tip. Real tips on a 0.1 to 1 kg hammer give 0.1 to 5 ms."""
_QUIET = 0.02
"""Median force over its peak below which a record is made of pulses [-]."""
_BLOCK = 2**17
"""Samples that are looked at together."""
_WHOLE = 2**20
"""Samples of a record up to which it is read whole."""
_STRETCHES, _STRETCH = 64, 4096
"""Stretches of a longer record that state its force at rest, and their samples."""


def time_scale_words(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Report force pulses that are not a hammer's: the unit of time may be wrong.

    Args:
        recordings: with or without judged hits.

    Returns:
        One sentence on the first such recording; none where all pulses can be a
        hammer's, or the force is no pulse.
    """
    strange = [
        (recording, duration)
        for recording in recordings
        if (duration := pulse_duration(recording)) is not None
        and not SHORTEST_PULSE <= duration <= LONGEST_PULSE
    ]
    if not strange:
        return ()
    recording, duration = strange[0]
    unit, other = ("s", "ms") if duration > LONGEST_PULSE else ("ms", "s")
    more = f" (and {len(strange) - 1} more)" if len(strange) > 1 else ""
    words = (
        f"recording {recording.name!r}{more}: the force pulse lasts "
        f"{1e3 * duration:.3g} ms at half its height, a hammer's lasts "
        f"{1e3 * SHORTEST_PULSE:g} to {1e3 * LONGEST_PULSE:g} ms; "
    )
    if any("rate_stated" in dict(done.detail) for done in recording.provenance):
        return (
            f"{words}is the rate right? It was given as {recording.sample_rate:.6g} "
            "Hz: import it again with another --rate",
        )
    return (
        f"{words}is its time in "
        f"{other}, not {unit}? At {recording.sample_rate:.6g} Hz sample rate all "
        f"frequencies are off by as much; import it again with 'time:{other}'",
    )


def pulse_duration(recording: Recording) -> float | None:
    """Return how long the largest force pulse exceeds half its height [s].

    None without one force channel, or where the force is no pulse.
    """
    rows = recording.rows(Quantity.FORCE)
    if len(rows) != 1:
        return None
    if recording.samples.shape[1] > _WHOLE:
        width = _long_pulse_width(recording.samples, rows[0])
    else:
        width = _pulse_width(recording.samples[rows[0]])
    return None if width is None else width / recording.sample_rate


def _pulse_width(samples: FloatArray) -> float | None:
    """Return the samples for which the largest pulse exceeds half its peak."""
    force = samples - np.median(samples)
    at = int(np.argmax(force))
    peak = float(force[at])
    if peak <= 0.0 or float(np.median(np.abs(force))) > _QUIET * peak:
        return None
    return _width_around(force, at)


def _long_pulse_width(samples: Samples, row: int) -> float | None:
    """Return `_pulse_width` of a record that is read block by block.

    The force at rest is that of stretches spread over all of it, which gives the median
    of noise to 0.3 % of its standard deviation.
    """
    count = samples.shape[1]
    starts = np.linspace(0, count - _STRETCH, _STRETCHES).astype(int).tolist()
    some = np.concatenate([samples[row, s : s + _STRETCH] for s in starts])
    rest = float(np.median(some))
    at, top = 0, -np.inf
    for first in range(0, count, _BLOCK):
        block = samples[row, first : first + _BLOCK]
        here = int(np.argmax(block))
        if block[here] > top:
            at, top = first + here, float(block[here])
    peak = top - rest
    if peak <= 0.0 or float(np.median(np.abs(some - rest))) > _QUIET * peak:
        return None
    begin = max(0, at - _BLOCK // 2)
    around = samples[row, begin : at + _BLOCK // 2]
    return _width_around(around - rest, at - begin)


def _width_around(force: FloatArray, at: int) -> float | None:
    """Return the samples for which the force exceeds half its peak at index `at`."""
    peak = float(force[at])
    low = np.flatnonzero(force < 0.5 * peak)
    before, after = low[low < at], low[low > at]
    if before.size == 0 or after.size == 0:
        return None
    return _crossing(force, int(after[0]), -1, peak) - _crossing(
        force, int(before[-1]), 1, peak
    )


def _crossing(force: FloatArray, outside: int, inwards: int, peak: float) -> float:
    """Return where the force passes half the peak, between two samples."""
    low, high = force[outside], force[outside + inwards]
    return outside + inwards * float((0.5 * peak - low) / (high - low))
