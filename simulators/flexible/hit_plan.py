# SPDX-License-Identifier: MIT
"""Hits of a campaign: points, levels and torques, aim, tilt, pulses and bad hits."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.flexible_specimen import BodyPlace, Vector
from jointbench.simulators.flexible.hit_records import (
    PRETRIGGER,
    SAMPLE_RATE,
    BadHit,
    HitRecord,
)
from jointbench.simulators.measuring.hammer import Pulse

_LEVELS, _LEVEL_RANGE = 4, 30.0

AIM_SIGMA, TILT_SIGMA = 1.5e-3, np.radians(1.5)
"""Standard deviations of the landing point [m] and of each of two tilts [rad]."""

_BAD_SHARE = 0.1

_REPEATS = 0.35  # share of the conditions that are hit twice

_INTERVAL = 8.0  # mean time between hits [s]


@dataclass(frozen=True, slots=True)
class HammerTip:
    """Contact of the hammer in one campaign.

    Attributes:
        width: contact time at the geometric mean of the levels [s].
        stiffening: the contact time falls with the level to this power [-].
        exponent: of the pulse [-].
    """

    width: float
    stiffening: float
    exponent: float


def draw_tip(rng: np.random.Generator) -> HammerTip:
    """Draw the hammer's tip."""
    width, stiffening, exponent = rng.uniform((0.5e-3, 0.05, 1.5), (0.9e-3, 0.12, 2.1))
    return HammerTip(float(width), float(stiffening), float(exponent))


def levels_to(highest: float) -> tuple[float, ...]:
    """Return four levels over a factor of 30, with two digits [N]."""
    raw = highest * _LEVEL_RANGE ** (np.arange(1 - _LEVELS, 1) / (_LEVELS - 1))
    scale = 10.0 ** (1 - np.floor(np.log10(raw)))
    return tuple(float(x) for x in np.round(raw * scale) / scale)


def plan_hits(
    points: tuple[BodyPlace, ...],
    torques: tuple[float, ...],
    levels: tuple[float, ...],
    tip: HammerTip,
    rng: np.random.Generator,
    *,
    limits: tuple[float, ...] = (),
) -> tuple[HitRecord, ...]:
    """Draw all hits in order of time.

    A condition is hit once or twice; a bad hit comes in addition.

    Args:
        points: under the hammer.
        torques: on each bolt [N m], in order of time.
        levels: peak forces [N].
        tip: of the hammer.
        rng: source of the draws.
        limits: force at each point that fills the range of an input [N]; none for no
            overloads.
    """
    hits: list[HitRecord] = []
    now = 0.0
    for torque in torques:
        for point, place in enumerate(points):
            for level in levels:
                wanted: list[BadHit | None] = [None]
                wanted += [None] * bool(rng.random() < _REPEATS)
                if rng.random() < _BAD_SHARE * (1 + _REPEATS):
                    kind = rng.choice([k for k in BadHit if limits or k != "overload"])
                    wanted.insert(int(rng.integers(len(wanted))), BadHit(kind))
                for bad in wanted:
                    now += float(_INTERVAL * rng.uniform(0.5, 1.5))
                    own = _hit(place, level, levels, tip, bad, rng)
                    if bad is BadHit.OVERLOAD:
                        own = _too_hard(own, limits[point], rng)
                    hits.append(replace(own, point=point, torque=torque, time=now))
    return tuple(hits)


def _hit(
    place: BodyPlace,
    level: float,
    levels: tuple[float, ...],
    tip: HammerTip,
    bad: BadHit | None,
    rng: np.random.Generator,
) -> HitRecord:
    """Draw one hit, at time zero of the campaign."""
    normal = np.asarray(place.direction)
    plane = [axis for axis in np.eye(3) if abs(axis @ normal) < 0.5]
    aim = AIM_SIGMA * rng.standard_normal(2)
    tilt = TILT_SIGMA * rng.standard_normal(2)
    peak = level * float(np.exp(0.1 * rng.standard_normal()))
    if bad is BadHit.GLANCING:
        aim *= 2.0
        tilt += np.radians(rng.uniform(20, 50)) * rng.choice((-1.0, 1.0), 2)
        peak *= float(rng.uniform(0.02, 0.06))
    direction = normal + sum(
        np.tan(t) * axis for t, axis in zip(tilt, plane, strict=True)
    )
    direction /= np.linalg.norm(direction)
    offset = sum(a * axis for a, axis in zip(aim, plane, strict=True))
    middle = float(np.sqrt(levels[0] * levels[-1]))
    first = Pulse(
        start=(PRETRIGGER - float(rng.uniform(2, 5))) / SAMPLE_RATE,
        width=tip.width
        * (peak / middle) ** -tip.stiffening
        * float(np.exp(0.07 * rng.standard_normal())),
        peak=peak,
        exponent=tip.exponent * float(np.exp(0.06 * rng.standard_normal())),
        skew=float(rng.uniform(-0.1, 0.1)),
    )
    return HitRecord(
        point=0,
        torque=0.0,
        level=level,
        time=0.0,
        offset=_vector(np.asarray(offset)),
        direction=_vector(direction),
        pulses=_contacts(first, bad, rng),
        bad=bad,
    )


def _contacts(
    first: Pulse, bad: BadHit | None, rng: np.random.Generator
) -> tuple[Pulse, ...]:
    """Return the contacts of a hit: a double one bounces."""
    if bad is BadHit.DOUBLE:
        again = replace(
            first,
            start=first.start + first.width + float(rng.uniform(2e-3, 25e-3)),
            peak=first.peak * float(rng.uniform(0.2, 0.7)),
            width=1.1 * first.width,
        )
        return first, again
    return (first,)


def _too_hard(hit: HitRecord, limit: float, rng: np.random.Generator) -> HitRecord:
    """Return a hit with a force that is beyond the range of an input."""
    peak = limit * float(rng.uniform(1.3, 2.5))
    return replace(hit, pulses=(replace(hit.pulses[0], peak=peak),))


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
