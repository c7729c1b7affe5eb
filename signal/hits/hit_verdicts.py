# SPDX-License-Identifier: MIT
"""Verdict on a hammer hit: whether it may enter an average, a number and a reason.

The worst defect is checked first: an overloaded signal is wrong, a double hit has zeros
    in its force spectrum, a late one is cut short, a weak one is only noisy.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.records.recordings import Recording, Verdict

# The median absolute deviation of normal noise is this fraction of its sd.
_MAD_OF_NORMAL = 0.6745
# Crests below this many sd are not distinguished from noise.
_NOISE_CREST = 6.0


@dataclass(frozen=True, slots=True)
class HitLimits:
    """Limits of the verdicts.

    Attributes:
        overload_fraction: share of a channel's range that counts as overload [-].
        flat_samples: equal consecutive extreme samples that count as clipping.
        double_ratio: second force peak over the main one [-]; raised where the noise of
            the force would reach it.
        weak_ratio: peak force over the median peak of the recording [-].
        weak_force: smallest useful peak force [N], or None.
        ladder_ratio: peak force over the softest repeated level of a campaign of
            several levels [-]: a ladder step struck once may be lower.
    """

    overload_fraction: float = 0.98
    flat_samples: int = 3
    double_ratio: float = 0.05
    weak_ratio: float = 1.0 / 3.0
    weak_force: float | None = None
    ladder_ratio: float = 0.1


@dataclass(frozen=True, slots=True)
class Judged:
    """Result of `judge` for one hit, with the fields of `Hit`."""

    peak_force: float
    verdict: Verdict
    measure: float
    reason: str


def judge(
    recording: Recording,
    force: FloatArray,
    bounds: Sequence[tuple[int, int, int]],
    *,
    limits: HitLimits,
    shortest: int,
) -> tuple[Judged, ...]:
    """Judge every hit of a recording.

    Args:
        recording: all channels.
        force: the force without its offset [N], shape (n_samples,).
        bounds: (start, trigger, stop) of each hit, sample indices.
        limits: see `HitLimits`.
        shortest: least number of samples from trigger to stop.

    Returns:
        One verdict per hit, in the same order.
    """
    peaks = [float(force[trigger:stop].max()) for _, trigger, stop in bounds]
    usual = float(np.median(peaks))
    floor = _NOISE_CREST * noise_level(force) if bounds else 0.0
    return tuple(
        _overload(recording, bound, limits, peak)
        or _double(recording, force, bound, max(limits.double_ratio, floor / peak))
        or _late(recording, bound, shortest, peak)
        or _weak(usual, limits, peak)
        or _good(recording, force, bound, peak)
        for bound, peak in zip(bounds, peaks, strict=True)
    )


def second_peak(force: FloatArray, trigger: int) -> tuple[float, int]:
    """Measure the second pulse of a hit.

    A second contact is a rise of the force after it has fallen. A ringing transducer
    or filter rises as well, but it swings as far below zero next to each crest, and a
    hammer cannot pull: that swing is subtracted. The main peak may be either pulse.

    Args:
        force: segment of one hit without offset [N], shape (n,).
        trigger: index of the trigger in it.

    Returns:
        The second peak as a fraction of the main one [-], and how many samples after
        (or, negative, before) the main peak it is.
    """
    main = trigger + int(np.argmax(force[trigger:]))
    width = max(4, _pulse_samples(force, main))
    after, where_after = _largest_rise(force[main:], width)
    before, where_before = _largest_rise(force[trigger : main + 1][::-1], width)
    if before > after:
        return float(before / force[main]), -where_before
    return float(after / force[main]), where_after


def longest_flat_top(samples: FloatArray) -> int:
    """Count the samples of the longest clipped crest or trough.

    Only runs at the extreme value count, and only if the signal leaves them by more
    than two quantisation steps: a smooth crest of a coarse converter is flat too, but
    leaves by one step.

    Args:
        samples: one channel, shape (n,).

    Returns:
        The length of the run, 1 where nothing is clipped.
    """
    high, low = float(samples.max()), float(samples.min())
    largest = max(high, -low)
    runs = [
        run
        for sign, top in ((1.0, high), (-1.0, -low))
        if top > 0.3 * largest
        for run in _runs_at(samples, sign, top)
    ]
    if not runs:
        return 1
    # A step between neighbours is a difference of two levels: the resolution is no
    # larger. Only a run that this leaves open needs all levels in order.
    steps = np.abs(np.diff(samples))
    nearest = float(np.min(steps, where=steps > 0.0, initial=np.inf))
    clipped = [length for length, drop in runs if drop > 2.0 * nearest]
    longer = [run for run in runs if run[0] > max(clipped, default=1)]
    if longer:
        resolution = float(np.diff(np.unique(samples)).min())
        clipped += [length for length, drop in longer if drop > 2.0 * resolution]
    return max(clipped, default=1)


def noise_level(samples: FloatArray) -> float:
    """Estimate the sd of the noise between sparse pulses, same unit as `samples`."""
    centred = samples - np.median(samples)
    np.abs(centred, out=centred)
    return float(np.median(centred, overwrite_input=True)) / _MAD_OF_NORMAL


def _runs_at(samples: FloatArray, sign: float, top: float) -> list[tuple[int, float]]:
    """Return the runs at an extreme that are left on a side, and how far there.

    Args:
        samples: one channel, shape (n,).
        sign: 1 for the maximum, -1 for the minimum.
        top: the extreme times `sign`.

    Returns:
        Length of two or more and the larger drop beside it, for each run.
    """
    edge = sign * (top - 1e-9 * abs(top))
    at = np.flatnonzero(samples >= edge if sign > 0.0 else samples <= edge)
    starts = np.flatnonzero(np.diff(at, prepend=-2) > 1)
    found = []
    for first, past in zip(starts, [*starts[1:], at.size], strict=True):
        begin, end = int(at[first]), int(at[past - 1]) + 1
        sides = [sign * samples[i] for i in (begin - 1, end) if 0 <= i < samples.size]
        if end - begin > 1 and sides:
            found.append((end - begin, float(top - min(sides))))
    return found


def _pulse_samples(force: FloatArray, main: int) -> int:
    """Return the length of the pulse around `main` above a tenth of its peak."""
    low = force < 0.1 * force[main]
    before = np.flatnonzero(low[:main])
    after = np.flatnonzero(low[main:])
    first = int(before[-1]) if before.size else 0
    past = main + int(after[0]) if after.size else force.size
    return past - first


def _largest_rise(force: FloatArray, width: int) -> tuple[float, int]:
    """Return the largest rise after a fall from ``force[0]``, and where it peaks."""
    valley = np.clip(np.minimum.accumulate(force), 0.0, None)
    rise = force - valley
    crests = np.flatnonzero((rise[1:-1] > 0.0) & _is_crest(force)) + 1
    # Small crests of noise are skipped.
    crests = crests[rise[crests] > 0.005 * force[0]]
    best, where = 0.0, 0
    for crest in crests:
        beside = force[max(0, crest - 2 * width) : crest + 2 * width + 1]
        net = float(rise[crest] + min(0.0, float(beside.min())))
        if net > best:
            best, where = net, int(crest)
    return best, where


def _is_crest(force: FloatArray) -> BoolArray:
    crest: BoolArray = (force[1:-1] >= force[:-2]) & (force[1:-1] > force[2:])
    return crest


def _overload(
    recording: Recording, bound: tuple[int, int, int], limits: HitLimits, peak: float
) -> Judged | None:
    start, _, stop = bound
    for row, channel in enumerate(recording.channels):
        samples = recording.samples[row, start:stop]
        largest = max(float(samples.max()), -float(samples.min()))
        if channel.range is not None:
            share = largest / channel.range
            if share >= limits.overload_fraction:
                return Judged(
                    peak,
                    Verdict.OVERLOAD,
                    share,
                    f"channel {channel.name!r} reaches {100 * share:.1f} % of its "
                    f"range {channel.range:g} (limit "
                    f"{100 * limits.overload_fraction:g} %)",
                )
        flat = longest_flat_top(samples)
        if flat >= limits.flat_samples:
            return Judged(
                peak,
                Verdict.OVERLOAD,
                float(flat),
                f"channel {channel.name!r} is clipped: {flat} equal consecutive "
                f"samples at its extreme {largest:.4g} (limit {limits.flat_samples})",
            )
    return None


def _double(
    recording: Recording,
    force: FloatArray,
    bound: tuple[int, int, int],
    limit: float,
) -> Judged | None:
    start, trigger, stop = bound
    peak = float(force[trigger:stop].max())
    ratio, samples = second_peak(force[start:stop], trigger - start)
    if ratio < limit:
        return None
    between = 1e3 * samples / recording.sample_rate
    return Judged(
        peak,
        Verdict.DOUBLE,
        ratio,
        f"second force peak is {100 * ratio:.1f} % of the main one, "
        f"{abs(between):.2f} ms {'after' if samples > 0 else 'before'} it "
        f"(limit {100 * limit:.3g} %)",
    )


def _late(
    recording: Recording, bound: tuple[int, int, int], shortest: int, peak: float
) -> Judged | None:
    _, trigger, stop = bound
    if stop - trigger >= shortest:
        return None
    length = (stop - trigger) / recording.sample_rate
    return Judged(
        peak,
        Verdict.LATE,
        length,
        f"only {length:.4g} s follow the trigger, a block needs "
        f"{shortest / recording.sample_rate:.4g} s",
    )


def _weak(usual: float, limits: HitLimits, peak: float) -> Judged | None:
    ratio = peak / usual
    if ratio < limits.weak_ratio:
        return Judged(
            peak,
            Verdict.WEAK,
            ratio,
            f"peak force {peak:.4g} N is {100 * ratio:.1f} % of the median peak "
            f"{usual:.4g} N (limit {100 * limits.weak_ratio:.0f} %)",
        )
    if limits.weak_force is not None and peak < limits.weak_force:
        return Judged(
            peak,
            Verdict.WEAK,
            peak / limits.weak_force,
            f"peak force {peak:.4g} N is below the limit {limits.weak_force:g} N",
        )
    return None


def _good(
    recording: Recording, force: FloatArray, bound: tuple[int, int, int], peak: float
) -> Judged:
    start, trigger, stop = bound
    ratio, _ = second_peak(force[start:stop], trigger - start)
    return Judged(
        peak,
        Verdict.OK,
        ratio,
        f"single clean pulse of {peak:.4g} N (second peak {100 * ratio:.2f} %)",
    )
