# SPDX-License-Identifier: MIT
"""Find the hammer hits of a recording and their segments.

The trigger is the one of a bench analyser, run on recorded samples: the force rises
through a level, and it must fall well below that level before it can fire again.
`hit_verdicts` then judges whether each hit may enter an average.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Hit, Quantity, Recording, Verdict
from jointbench.signal.hits.hit_verdicts import HitLimits, Judged, judge, noise_level


@dataclass(frozen=True, slots=True)
class HitCriteria:
    """How hits are found and judged.

    Attributes:
        trigger_level: force that must be reached [N], or None for the automatic level
            (the larger of `noise_factor` noise sd and `peak_fraction` of the peak).
        pretrigger: time kept before the trigger [s]; less if the record starts later.
        dead_time: time after a trigger in which a second pulse is a bounce of the same
            hit, not a hit of its own [s].
        rearm_fraction: the force must fall below this share of the level to re-arm [-].
        noise_factor: automatic level in standard deviations of the force noise [-].
        peak_fraction: automatic level as a share of the largest force [-].
        minimum_length: shortest useful time from trigger to end of segment [s], or None
            for half the median of the recording.
        limits: limits of the verdicts.
    """

    trigger_level: float | None = None
    pretrigger: float = 0.01
    dead_time: float = 0.1
    rearm_fraction: float = 0.5
    noise_factor: float = 8.0
    peak_fraction: float = 0.05
    minimum_length: float | None = None
    limits: HitLimits = field(default_factory=HitLimits)


def find_hits(recording: Recording, criteria: HitCriteria | None = None) -> Recording:
    """Find the hammer hits of a recording and judge each of them.

    Args:
        recording: one force channel and at least one response; earlier hits are
            replaced.
        criteria: trigger and limits; None for the defaults.

    Returns:
        The same recording with `hits`, in order of time. A segment runs from the
        pre-trigger of its hit to the pre-trigger of the next one, or to the end.

    Raises:
        NoHitFound: no force sample rises through the trigger level.
        ChannelMissing: there is not exactly one force channel.
    """
    criteria = criteria or HitCriteria()
    row = recording.row(Quantity.FORCE)
    force = recording.samples[row]
    force = force - np.median(force)
    level = _trigger_level(force, criteria, recording.name)
    dead = round(criteria.dead_time * recording.sample_rate)
    triggers = trigger_indices(
        force, level=level, rearm=criteria.rearm_fraction * level, dead=dead
    )
    if not triggers and force[0] >= level:
        raise NoHitFound(
            f"recording {recording.name!r} begins inside the pulse ({force[0]:.4g} N "
            f"at its first sample, trigger level {level:.4g} N); record again with a "
            "pre-trigger, so that the force starts from zero"
        )
    if not triggers:
        raise NoHitFound(
            f"recording {recording.name!r}: no force sample rises through "
            f"{level:.4g} N (largest {force.max():.4g} N); lower the trigger level"
        )
    bounds = _segments(triggers, criteria, recording)
    judged = judge(
        recording,
        force,
        bounds,
        limits=criteria.limits,
        shortest=_shortest(bounds, criteria, recording.sample_rate),
    )
    done = step("find_hits", trigger_level=level, hits=len(bounds))
    return replace(
        recording,
        hits=tuple(
            _hit(recording, row, b, j) for b, j in zip(bounds, judged, strict=True)
        ),
        provenance=(*recording.provenance, done),
    )


def accepted_hits(recording: Recording) -> tuple[Hit, ...]:
    """Return the hits whose verdict is OK."""
    return tuple(hit for hit in recording.hits if hit.verdict is Verdict.OK)


def trigger_indices(
    force: FloatArray, *, level: float, rearm: float, dead: int
) -> tuple[int, ...]:
    """Find where the force rises through a level, with hysteresis.

    Args:
        force: samples [N], shape (n,).
        level: fires at sample i if ``force[i - 1] < level <= force[i]`` [N].
        rearm: the force must have been below this since the last firing [N].
        dead: samples after a firing in which nothing can fire.

    Returns:
        Indices of the firing samples, ascending.
    """
    crossings = np.flatnonzero((force[:-1] < level) & (force[1:] >= level)) + 1
    fired: list[int] = []
    armed, looked = True, 0
    for crossing in crossings.tolist():
        armed = armed or bool((force[looked:crossing] < rearm).any())
        looked = crossing
        if fired and (not armed or crossing - fired[-1] <= dead):
            continue
        fired.append(crossing)
        armed = False
    return tuple(fired)


def _trigger_level(force: FloatArray, criteria: HitCriteria, name: str) -> float:
    if criteria.trigger_level is not None:
        return criteria.trigger_level
    peak, valley = float(force.max()), float(force.min())
    if peak < -0.5 * valley:
        raise NoHitFound(
            f"recording {name!r}: the force swings to {valley:.4g} N but only to "
            f"{peak:+.4g} N; a hammer pushes, so change the sign of the force channel"
        )
    noise = noise_level(force)
    level = max(criteria.noise_factor * noise, criteria.peak_fraction * peak)
    if not 0.0 < level <= peak:
        raise NoHitFound(
            f"recording {name!r}: the largest force, {peak:.4g} N, does not stand out "
            f"of the noise ({noise:.4g} N sd); hit harder or set a trigger level"
        )
    return level


def _segments(
    triggers: Sequence[int], criteria: HitCriteria, recording: Recording
) -> tuple[tuple[int, int, int], ...]:
    """Return (start, trigger, stop) of each hit."""
    before = round(criteria.pretrigger * recording.sample_rate)
    starts = [max(0, trigger - before) for trigger in triggers]
    stops = [*starts[1:], recording.samples.shape[1]]
    return tuple(zip(starts, triggers, stops, strict=True))


def _shortest(
    bounds: Sequence[tuple[int, int, int]], criteria: HitCriteria, sample_rate: float
) -> int:
    """Return the least number of samples after a trigger for a block."""
    if criteria.minimum_length is not None:
        return round(criteria.minimum_length * sample_rate)
    return int(0.5 * np.median([stop - trigger for _, trigger, stop in bounds]))


def _hit(
    recording: Recording, row: int, bounds: tuple[int, int, int], judged: Judged
) -> Hit:
    start, trigger, stop = bounds
    return Hit(
        start=start,
        trigger=trigger,
        stop=stop,
        point=recording.channels[row].point,
        peak_force=judged.peak_force,
        verdict=judged.verdict,
        measure=judged.measure,
        reason=judged.reason,
    )
