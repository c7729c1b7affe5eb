# SPDX-License-Identifier: MIT
"""Imported hits that cannot be right: swapped columns, signs, g for m/s^2, the rate.

Each check compares the hits with what a hammer and a structure can do, and its line
names what to pass instead. None changes the data.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import STANDARD_GRAVITY
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.hits.pulse_duration import time_scale_words

PULSE_SHARE = 0.03
"""Share of samples above a tenth of the peak below which a record is a pulse [-]: a
hammer's pulse of 5 ms in a record of 0.17 s; a decay of 1 % damping has 40 periods."""
_RINGING_SHARE = 0.1
"""Share above which it is a decay, not a pulse [-]."""
_LONGER = 5.0
"""Times that a swinging force lasts longer than a pulse of a response, as no hit and
answer do: a decay in a long record is below the share [-]."""
_TENTH = 0.1
_SWING = 0.3
"""Largest opposite peak of a pulse, of its peak [-]: beyond it, it swings."""
_ONE_G = 0.04
"""Relative tolerance of a constant offset that is gravity [-]."""
_LARGEST_ACCELERATION = 2e5
"""[m/s^2]: 20,000 g; shock accelerometers of metal strikes end there."""
_MOST_SAMPLES = 2_000_000


@dataclass(frozen=True, slots=True)
class StruckMass:
    """Impulse of a hit over the velocity that it gives a point.

    Attributes:
        mass: [kg]; of the driving point, the mass that moves within the pulse.
        channel: of the response.
    """

    mass: float
    channel: str


def plausibility_words(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return what in recordings cannot be right, one line each with what to pass.

    Args:
        recordings: with or without judged hits, in SI units.

    Returns:
        Each finding once, for the first recording that shows it; none where all is
        plausible or where there is no force.
    """
    return (*time_scale_words(recordings), *channel_words(recordings))


def channel_words(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return what columns, signs and units make impossible, as `plausibility_words`."""
    found: list[str] = []
    seen: set[str] = set()
    for recording in recordings:
        for kind, words in _findings(recording):
            if kind not in seen:
                seen.add(kind)
                found.append(f"recording {recording.name!r}: {words}")
    return tuple(found)


def struck_mass(recording: Recording) -> StruckMass | None:
    """Return the impulse over the largest change of velocity during the hit.

    None without one force, without accelerations, or where the force is no pulse.
    """
    force = _only_force(recording)
    if force is None or not is_pulse(force):
        return None
    pulse = _pulse(force)
    impulse = float(np.abs(np.sum(force[pulse]))) / recording.sample_rate
    rows = recording.rows(Quantity.ACCELERATION)
    best: StruckMass | None = None
    for row in rows:
        motion = np.asarray(recording.samples[row][: force.size], np.float64)
        motion = motion - np.median(motion)
        change = abs(float(np.sum(motion[pulse]))) / recording.sample_rate
        if change > 0.0 and (best is None or impulse / change < best.mass):
            best = StruckMass(impulse / change, recording.channels[row].name)
    return best


def is_pulse(values: FloatArray) -> bool:
    """Return whether a record is quiet but for short pulses to one side."""
    return active_share(values) < PULSE_SHARE and not _swings(values)


def active_share(values: FloatArray) -> float:
    """Return the share of samples beyond a tenth of the peak [-]; 1 for a constant."""
    plain = np.abs(values - np.median(values))
    peak = float(plain.max(initial=0.0))
    return 1.0 if peak <= 0.0 else float(np.mean(plain > _TENTH * peak))


def points_down(values: FloatArray) -> bool:
    """Return whether the pulses of a record are negative."""
    plain = values - np.median(values)
    return bool(-plain.min(initial=0.0) > plain.max(initial=0.0) / _SWING)


def _rings(force: FloatArray, pulse: FloatArray) -> bool:
    """Return whether a force decays beside a pulse: long, or to both sides."""
    share = active_share(force)
    longer = share > _LONGER * active_share(pulse)
    return share > _RINGING_SHARE or (longer and _swings(force))


def _swings(values: FloatArray) -> bool:
    plain = values - np.median(values)
    ends = sorted((float(plain.max(initial=0.0)), float(-plain.min(initial=0.0))))
    return ends[0] > _SWING * ends[1]


def _findings(recording: Recording) -> Iterator[tuple[str, str]]:
    force = _only_force(recording)
    if force is None:
        return
    name = recording.channels[recording.rows(Quantity.FORCE)[0]].name
    responses = [
        (channel, np.asarray(recording.samples[row][: force.size], np.float64))
        for row, channel in enumerate(recording.channels)
        if channel.quantity is not Quantity.FORCE
    ]
    pulses = [
        (channel.name, values) for channel, values in responses if is_pulse(values)
    ]
    if pulses and _rings(force, pulses[0][1]):
        yield (
            "swapped",
            f"{name!r} rings down as a response does and {pulses[0][0]!r} is a short "
            "pulse as a force is; are the columns swapped? Exchange force and "
            "response in --columns",
        )
        return
    if active_share(force) < PULSE_SHARE and points_down(force):
        yield (
            "sign",
            f"the pulses of {name!r} are negative, and a hammer pushes; turn it round "
            "with a minus before its unit: 'force:-N'",
        )
    for channel, values in responses:
        yield from _of_acceleration(channel, values)
        yield from _of_driving_point(recording, force, channel, values)


def _of_acceleration(channel: Channel, values: FloatArray) -> Iterator[tuple[str, str]]:
    if channel.quantity is not Quantity.ACCELERATION:
        return
    peak = float(np.abs(values).max(initial=0.0))
    offset = abs(float(np.median(values)))
    in_g = channel.unit.strip() in ("g", "gn")
    if peak > _LARGEST_ACCELERATION and in_g:
        yield (
            "gravity",
            f"{channel.name!r} reaches {peak / STANDARD_GRAVITY:.3g} g, which no "
            "accelerometer measures; if its numbers are m/s^2, pass "
            "'acceleration:m/s^2'",
        )
    if in_g and abs(offset / STANDARD_GRAVITY**2 - 1.0) < _ONE_G:
        yield (
            "gravity",
            f"{channel.name!r} rests at {offset / STANDARD_GRAVITY:.3g} g; if that is "
            "gravity, its numbers are m/s^2: pass 'acceleration:m/s^2'",
        )
    if not in_g and abs(offset - 1.0) < _ONE_G and channel.sensitivity is None:
        yield (
            "gravity",
            f"{channel.name!r} rests at {offset:.3g} m/s^2; if that is gravity, its "
            "numbers are g: pass 'acceleration:g'",
        )


def _of_driving_point(
    recording: Recording, force: FloatArray, channel: Channel, values: FloatArray
) -> Iterator[tuple[str, str]]:
    """Check that a hit moves the struck point the way it pushes."""
    struck = recording.channels[recording.rows(Quantity.FORCE)[0]]
    here = channel.point and channel.point == struck.point
    turned = channel.direction and struck.direction not in ("", channel.direction)
    if not here or turned or channel.quantity is not Quantity.ACCELERATION:
        return
    if not is_pulse(force) or points_down(force):
        return
    pulse = _pulse(force)
    velocity = np.cumsum(values[pulse] - np.median(values)) / recording.sample_rate
    if float(np.sum(force[pulse] * velocity)) < 0.0:
        yield (
            "direction",
            f"{channel.name!r} at the struck point {channel.point} moves against the "
            "hit; if the sensor looks the other way, turn it round with a minus before "
            "its unit: 'acceleration:-m/s^2'",
        )


def _only_force(recording: Recording) -> FloatArray | None:
    rows = recording.rows(Quantity.FORCE)
    if len(rows) != 1:
        return None
    return np.asarray(recording.samples[rows[0]][:_MOST_SAMPLES], np.float64)


def _pulse(force: FloatArray) -> slice:
    """Return the samples around the largest pulse, down to a tenth of its peak."""
    plain = np.abs(force - np.median(force))
    at = int(np.argmax(plain))
    low = np.flatnonzero(plain < _TENTH * plain[at])
    before, after = low[low < at], low[low > at]
    first = int(before[-1]) if before.size else 0
    last = int(after[0]) + 1 if after.size else force.size
    return slice(first, last)
