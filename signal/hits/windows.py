# SPDX-License-Identifier: MIT
"""Force and exponential windows for hammer hits.

The force window keeps the pulse and drops the noise after it. The signal before the
pulse is noise, or the structure still ringing from the last hit. It is dropped from all
channels, except for the few samples into which anti-alias filters smear the pulse. The
exponential window is used only where the response has not decayed at the end of its
block; force and response are both multiplied by it, so that the estimate is exactly H(s
+ decay rate): a pole moves by the decay rate, and moving it back removes the damping
added.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.acquisition.records.recordings import (
    Hit,
    Quantity,
    Recording,
    response_rows,
)
from jointbench.acquisition.records.stored_samples import remembered
from jointbench.signal.hits.find_hits import accepted_hits

# The pulse ends where the force falls below this share of its peak.
_PULSE_END = 0.05
# Pulse lengths kept at full weight: filter ringing belongs to the force.
_PULSES_KEPT = 10
_SAMPLES_KEPT = 64
# Samples kept before the trigger, or this share of the pulse if that is longer.
_LEAD_SAMPLES = 16
_LEAD_PULSES = 0.25
# Mean square of half a cosine from 1 to 0.
_TAPER_POWER = 3.0 / 8.0
# Samples before a hit that give the offset of its force, at least and at most.
_LEAST_QUIET, _MOST_QUIET = 16, 4096
# A response that ends above this share of its start has not decayed; an exponential
# window brings it down to it, and the fit of modes holds what is left.
_DECAYED = 0.03


@dataclass(frozen=True, slots=True)
class HammerWindow:
    """Windows of one measurement.

    Attributes:
        force_width: time after the trigger in which the force is kept whole [s], then
            tapered to zero over half as long; None for no force window.
        decay_rate: rate of the exponential window on all channels [1/s], or None.
        lead: all channels are set to zero up to this long before the trigger [s]; None
            keeps everything.
        reason: why these windows were chosen.
    """

    force_width: float | None = None
    decay_rate: float | None = None
    lead: float | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class WindowRequest:
    """Requested windows; None chooses from the hits, 0 uses no window.

    Attributes:
        force_width: time after the trigger in which the force is kept whole [s].
        decay_rate: rate of the exponential window on all channels [1/s].
        lead: time kept before the trigger [s].
    """

    force_width: float | None = None
    decay_rate: float | None = None
    lead: float | None = None


def requested_window(
    recordings: Sequence[Recording], request: WindowRequest
) -> HammerWindow:
    """Return the common window of several recordings, with requested values applied.

    Args:
        recordings: with hits found; those without an accepted hit are ignored.
        request: values not chosen from the hits.
    """
    chosen = join_windows([choose_window(r) for r in recordings if accepted_hits(r)])
    given = {
        name: value or None
        for name in ("force_width", "decay_rate", "lead")
        if (value := getattr(request, name)) is not None
    }
    if not given:
        return chosen
    words = ", ".join(f"{name} by request" for name in given)
    return replace(chosen, **given, reason=f"{words}; {chosen.reason}")


@remembered
def choose_window(recording: Recording) -> HammerWindow:
    """Choose the windows from the accepted hits of a recording.

    Args:
        recording: with hits found.

    Returns:
        A force window of ten pulse lengths, and an exponential window only if a
        response still rings at the end of the shortest block.
    """
    hits = accepted_hits(recording)
    if not hits:
        return HammerWindow(reason="no accepted hit")
    pulse = max(_pulse_length(recording, hit) for hit in hits)
    width = max(_PULSES_KEPT * pulse, _SAMPLES_KEPT) / recording.sample_rate
    lead = max(_LEAD_SAMPLES, round(_LEAD_PULSES * pulse)) / recording.sample_rate
    length = min(hit.stop - hit.start for hit in hits)
    left = max(left_at_end(recording, hit, length) for hit in hits)
    why = (
        f"pulse of {1e3 * pulse / recording.sample_rate:.3g} ms; response ends at "
        f"{100 * left:.2g} % of its start (limit {100 * _DECAYED:g} %)"
    )
    if left <= _DECAYED:
        return HammerWindow(width, None, lead, why + ", no exponential window")
    rate = float(np.log(left / _DECAYED)) * recording.sample_rate / length
    return HammerWindow(
        width, rate, lead, f"{why}, exponential window of {rate:.4g} 1/s"
    )


def join_windows(windows: Sequence[HammerWindow]) -> HammerWindow:
    """Return the common window: the widest force window, the fastest decay."""
    widths = [w.force_width for w in windows if w.force_width is not None]
    rates = [w.decay_rate for w in windows if w.decay_rate is not None]
    reasons = dict.fromkeys(w.reason for w in windows if w.reason)
    leads = [w.lead for w in windows if w.lead is not None]
    return HammerWindow(
        max(widths, default=None),
        max(rates, default=None),
        max(leads, default=None),
        " | ".join(reasons),
    )


def apply_window(
    window: HammerWindow,
    force: FloatArray,
    response: FloatArray,
    *,
    trigger: int,
    sample_rate: float,
    offset: float | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Remove offsets from one hit's segment and window it.

    Args:
        window: what to apply.
        force: [N], shape (n,).
        response: SI units, shape (n_responses, n).
        trigger: index of the trigger in the segment.
        sample_rate: [Hz].
        offset: of the force [N]; None for its mean before the trigger.

    Returns:
        Force without its offset and response without its mean over the
        segment (which changes line 0 only), both windowed; new arrays.
    """
    on_force, on_response = window_weights(window, force.size, trigger, sample_rate)
    force = force - (quiet_mean(force, trigger) if offset is None else offset)
    response = response - response.mean(axis=1, keepdims=True)
    return force * on_force, response * on_response


@lru_cache(maxsize=4)
def window_weights(
    window: HammerWindow, count: int, trigger: int, sample_rate: float
) -> tuple[FloatArray, FloatArray]:
    """Return what a window multiplies force and responses with, shape (n,) each.

    Args:
        window: what to apply.
        count: samples of the segment.
        trigger: index of the trigger in the segment.
        sample_rate: [Hz].

    Returns:
        Weights of the force and of the responses, read-only.
    """
    time = (np.arange(count) - trigger) / sample_rate
    both = np.ones(count)
    if window.lead is not None:
        both *= time >= -window.lead
    if window.decay_rate is not None:
        both *= np.exp(-window.decay_rate * time)
    force = both
    if window.force_width is not None:
        force = both * _keep_then_taper(time, window.force_width)
    return read_only(force), read_only(both)


def force_offset(recording: Recording, hit: Hit) -> float:
    """Return the offset of the force channel at a hit [N].

    All of the quiet force before a hit counts, not that of its segment alone: the
    offset is multiplied by the length of the force window, and its error bends the
    lowest lines of all FRFs of a reference. The samples into which filters smear the
    pulse are left out.

    Args:
        recording: holds the hit.
        hit: which.

    Returns:
        Mean from half-way since the previous trigger; where that leaves too few
        samples, `quiet_mean` of the segment.
    """
    return _quiet_moments(recording, hit)[0]


def force_variance(recording: Recording, hit: Hit) -> float:
    """Return the variance of the quiet force before a hit [N^2]; 0 if too short."""
    return _quiet_moments(recording, hit)[1]


@remembered
def _quiet_moments(recording: Recording, hit: Hit) -> tuple[float, float]:
    """Return mean and variance of the force before a hit."""
    row = recording.row(Quantity.FORCE)
    earlier = [h.trigger for h in recording.hits if h.trigger < hit.trigger]
    between = (max(earlier) + hit.trigger + 1) // 2 if earlier else 0
    first = max(between, hit.trigger - _MOST_QUIET)
    last = hit.trigger - _LEAD_SAMPLES
    if last - first < _LEAST_QUIET:
        trigger = hit.trigger - hit.start
        start = recording.samples[row, hit.start : hit.trigger]
        return quiet_mean(start, trigger), 0.0
    quiet = recording.samples[row, first:last]
    return float(quiet.mean()), float(quiet.var(ddof=1))


def kept_samples(window: HammerWindow, sample_rate: float) -> float:
    """Return the sum of squared weights of a force window after the trigger [-]."""
    width = sample_rate * (window.force_width or 0.0)
    return width * (1.0 + 0.5 * _TAPER_POWER)


def quiet_mean(force: FloatArray, trigger: int) -> float:
    """Return the mean force before the pulse [N]; its last quarter is left out."""
    quiet = force[: max(1, (3 * trigger) // 4)]
    return float(quiet.mean())


def _keep_then_taper(time: FloatArray, width: float) -> FloatArray:
    """Return 1 up to `width`, then half a cosine down to 0 at 1.5 `width`."""
    beyond = np.clip((time - width) / (0.5 * width), 0.0, 1.0)
    window: FloatArray = 0.5 * (1.0 + np.cos(np.pi * beyond))
    return window


def _pulse_length(recording: Recording, hit: Hit) -> int:
    """Return the samples from the trigger to the end of the pulse."""
    force = recording.samples[recording.row(Quantity.FORCE), hit.start : hit.stop]
    trigger = hit.trigger - hit.start
    force = force - quiet_mean(force, trigger)
    peak = trigger + int(np.argmax(force[trigger:]))
    low = np.flatnonzero(force[peak:] < _PULSE_END * force[peak])
    return peak + (int(low[0]) if low.size else 0) - trigger + 1


def left_at_end(recording: Recording, hit: Hit, length: int | None = None) -> float:
    """Return the rms of the last tenth over that of the first, largest response.

    A last tenth at the level of the middle is a noise floor, not a ringing structure:
    it counts as decayed unless it exceeds half the level of the start.

    Args:
        recording: of the hit.
        hit: its segment.
        length: of the block in samples, None for the whole segment.
    """
    stop = hit.stop if length is None else min(hit.start + length, hit.stop)
    return _left_at(recording, hit.trigger, stop)


@remembered
def _left_at(recording: Recording, trigger: int, stop: int) -> float:
    """Return what is left at `stop` of the responses to a hit at `trigger`."""
    tenth = max(1, (stop - trigger) // 10)
    found = 0.0
    for row in response_rows(recording):
        samples = recording.samples[row, trigger:stop]
        mean = samples.mean()
        start, middle, end = (
            float(np.sqrt(np.mean((samples[first : first + tenth] - mean) ** 2)))
            for first in (0, 4 * tenth, samples.size - tenth)
        )
        start = start or 1.0
        floor = end > 0.9 * middle and end < 0.5 * start
        found = max(found, 0.0 if floor else end / start)
    return found
