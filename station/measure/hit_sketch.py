# SPDX-License-Identifier: MIT
"""What a view draws of a hit and of the average after it, as an event."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.signal.frf.frf import Frf
from jointbench.station.measure.running_average import mean_coherence
from jointbench.station.measure.stored_cut import HitCut
from jointbench.station.session_events.view_events import HitAveraged

_STEPS = 128  # of an FRF over its band
_PULSE_STEPS = 64
_PULSE = 6e-3  # [s] of the force that is drawn
_BEFORE = 1e-3  # [s] of it before the trigger


def hit_averaged(
    hit: int,
    counts: tuple[int, int],
    cut: HitCut,
    frf: Frf | None,
    *,
    channels: Sequence[Channel],
    sample_rate: float,
    trial: bool = False,
) -> HitAveraged:
    """Return the event of an average after a hit.

    Args:
        hit: number of the hit, from 0.
        counts: good hits so far and wanted.
        cut: samples of the hit.
        frf: average so far, None without any.
        channels: of the rows of the cut.
        sample_rate: [Hz].
        trial: whether it is a trial hit.
    """
    row = next(i for i, c in enumerate(channels) if c.quantity is Quantity.FORCE)
    first = max(0, cut.trigger - round(_BEFORE * sample_rate))
    count = max(_PULSE_STEPS, round(_PULSE * sample_rate))
    pulse = cut.samples[row, first : first + count]
    sketch = HitAveraged(
        hit=hit,
        good=counts[0],
        wanted=counts[1],
        trial=trial,
        pulse=_rounded(_in_steps(pulse, _PULSE_STEPS, np.max), 2),
        pulse_time=pulse.size / sample_rate,
    )
    return sketch if frf is None else _with_frf(sketch, frf, channels)


def _with_frf(
    sketch: HitAveraged, frf: Frf, channels: Sequence[Channel]
) -> HitAveraged:
    low, high = frf.usable_band or (float(frf.frequency[0]), float(frf.frequency[-1]))
    inside = (frf.frequency >= low) & (frf.frequency <= high)
    names = [c.name for c in channels if c.quantity.is_motion]
    curves, phases, coherences = {}, {}, {}
    for row, name in enumerate(names):
        size = 20 * np.log10(np.abs(frf.response[row, 0, inside]) + 1e-12)
        curves[name] = _rounded(_in_steps(size, _STEPS, np.max), 1)
        phases[name] = _phase(frf.response[row, 0, inside], _STEPS)
        if frf.coherence is not None:
            values = frf.coherence[row, 0, inside]
            coherences[name] = _rounded(_in_steps(values, _STEPS, np.min), 3)
    return HitAveraged(
        hit=sketch.hit,
        good=sketch.good,
        wanted=sketch.wanted,
        trial=sketch.trial,
        pulse=sketch.pulse,
        pulse_time=sketch.pulse_time,
        band=[float(low), float(high)],
        frf=curves,
        phase=phases,
        coherence=coherences,
        mean_coherence=mean_coherence(frf),
    )


def _phase(response: ComplexArray, steps: int) -> list[float]:
    """Return the phase where the magnitude is largest within each step [deg]."""
    if response.size == 0:
        return []
    edges = np.linspace(0, response.size, min(steps, response.size) + 1).astype(int)
    peaks = [a + int(np.argmax(np.abs(response[a:b]))) for a, b in pairwise(edges)]
    return _rounded(np.degrees(np.angle(response[peaks])).tolist(), 0)


def _in_steps(
    values: FloatArray, steps: int, of: Callable[[FloatArray], float]
) -> list[float]:
    """Return one value of each of `steps` parts: peaks and dips stay visible."""
    if values.size == 0:
        return []
    edges = np.linspace(0, values.size, min(steps, values.size) + 1).astype(int)
    return [float(of(values[a:b])) for a, b in pairwise(edges)]


def _rounded(values: Sequence[float], digits: int) -> list[float]:
    return [round(value, digits) for value in values]
