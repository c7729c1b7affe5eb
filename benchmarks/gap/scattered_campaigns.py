# SPDX-License-Identifier: MIT
"""Campaigns whose hits scatter in ways that the gap engine does not share.

The specimen is integrated in physical coordinates by a Runge-Kutta scheme on a fine
step; scatter is drawn as what a hammer does (strength, aim, tilt, timing), with laws
that are not normal; noise has heavy tails. Neither the integrator nor the laws of
scatter and noise are those of `jointbench.analysis` or `jointbench.simulators`.

Ways of scatter, each with a relative size s:

- ``hit``: strength of the hit, uniform, sd s
- ``channel``: gain of each channel and hit, Laplace, sd s
- ``heavy``: the same, Student-t with 3 degrees of freedom, scale s
- ``aim``: the hit point misses by a distance in two directions and the hammer tilts by
  two angles; rocking and cross-axis sensitivity change each channel
- ``delay``: the force is recorded late or early by up to 2 us (at s of 3 %)
- ``wander``: strength and gains of each channel, correlated from hit to hit by 0.8
- ``bad``: gains of each channel scatter by s/10, and one hit is off by 8 s
- ``joint``: stiffness of the joint in each hit, triangular, sd s/10, and strength
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jointbench.acquisition.basics.compiled import compiled
from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign
from jointbench.simulators.hidden.campaign_design import (
    CampaignCondition,
    CampaignDesign,
    draw_design,
)
from jointbench.simulators.hidden.campaign_response import CONVERTER
from jointbench.simulators.hidden.campaign_sampling import (
    FORCE_NOISE,
    SAMPLE_RATE,
    SAMPLES,
)
from jointbench.simulators.measuring.converter import decimate
from jointbench.simulators.measuring.hammer import pulse_force

Floats = npt.NDArray[np.float64]
SIZES = (0.002, 0.01, 0.03)
LARGEST_DELAY = 2e-6
_MEMORY = 0.8


@dataclass(frozen=True)
class Scatter:
    """How the hits of a campaign deviate; one row for each hit.

    Attributes:
        gain: of each channel over its true one [-], shape (n_hits, 2).
        joint: stiffness of the joint over its true one [-], shape (n_hits,).
        delay: of the force against the accelerations [s], shape (n_hits,).
        bad: hits that are off by far, 0-based.
    """

    gain: Floats
    joint: Floats
    delay: Floats
    bad: tuple[int, ...] = ()


def draw_scatter(way: str, size: float, hits: int, rng: np.random.Generator) -> Scatter:
    """Draw the scatter of all hits of a campaign.

    Args:
        way: one of `WAYS`.
        size: relative size [-].
        hits: number of hits.
        rng: source of the draw.
    """
    return WAYS[way](size, hits, rng)


def _gains(gain: Floats, bad: tuple[int, ...] = ()) -> Scatter:
    hits = len(gain)
    return Scatter(1.0 + gain, np.ones(hits), np.zeros(hits), bad)


def _hit(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    strength = s * np.sqrt(3.0) * rng.uniform(-1.0, 1.0, (hits, 1))
    return _gains(np.repeat(strength, 2, axis=1))


def _channel(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    return _gains(rng.laplace(0.0, s / np.sqrt(2.0), (hits, 2)))


def _heavy(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    return _gains(np.clip(s * rng.standard_t(3, (hits, 2)), -0.5, 0.5))


def _aim(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    """Miss the point by (x, y) over the radius of gyration, tilt by two angles.

    An eccentric hit rocks the body, and adds x times a coefficient of each channel; a
    tilted one loses 1 - cos, and excites the cross axis of the sensor.
    """
    place = rng.normal(0.0, s, (hits, 2))
    angle = rng.normal(0.0, np.sqrt(s) / 2, (hits, 2))
    rocking = rng.uniform(-1.0, 1.0, (2, 2))
    cross = rng.uniform(-1.0, 1.0, (2, 2)) * np.sqrt(s)
    axial = np.cos(np.hypot(angle[:, :1], angle[:, 1:])) - 1.0
    return _gains(axial + place @ rocking + np.sin(angle) @ cross)


def _delay(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    late = LARGEST_DELAY * s / max(SIZES) * rng.uniform(-1.0, 1.0, hits)
    return Scatter(np.ones((hits, 2)), np.ones(hits), late)


def _wander(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    step = rng.normal(0.0, 1.0, (hits, 3))
    state = step[0]
    rows = [state]
    for new in step[1:]:
        state = _MEMORY * state + np.sqrt(1.0 - _MEMORY**2) * new
        rows.append(state)
    walk = np.array(rows)
    return _gains(s * (walk[:, :1] + 0.5 * walk[:, 1:]))


def _bad(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    good = rng.normal(0.0, s / 10.0, (hits, 2))
    which = int(rng.integers(hits))
    good[which] += 8.0 * s * rng.choice([-1.0, 1.0])
    return _gains(good, (which,))


def _joint(s: float, hits: int, rng: np.random.Generator) -> Scatter:
    stiffness = 1.0 + s / 10.0 * np.sqrt(6.0) * rng.triangular(-1, 0, 1, hits)
    strength = _hit(s, hits, rng)
    return Scatter(strength.gain, stiffness, np.zeros(hits))


WAYS: dict[str, Callable[[float, int, np.random.Generator], Scatter]] = {
    "hit": _hit,
    "channel": _channel,
    "heavy": _heavy,
    "aim": _aim,
    "delay": _delay,
    "wander": _wander,
    "bad": _bad,
    "joint": _joint,
}


@compiled(error_model="numpy")
def _integrate(force: Floats, numbers: Floats, body: int, step: float) -> Floats:
    """Return the accelerations of both bodies at every step, shape (2, n).

    Classical Runge-Kutta scheme of fourth order.

    Args:
        force: at every half step [N], shape (2 n + 1,).
        numbers: m1, m2, k0, c0, kj, cj.
        body: that is hit.
        step: [s].
    """
    m1, m2, k0, c0, kj, cj = numbers
    n = (force.size - 1) // 2
    out = np.empty((2, n))
    x1, x2, v1, v2 = 0.0, 0.0, 0.0, 0.0
    slope = np.empty((4, 4))
    for i in range(n):
        for stage in range(4):
            if stage == 0:
                h, f = 0.0, force[2 * i]
                a1, a2, b1, b2 = x1, x2, v1, v2
            else:
                h = step if stage == 3 else 0.5 * step
                f = force[2 * i + 2] if stage == 3 else force[2 * i + 1]
                a1 = x1 + h * slope[stage - 1, 0]
                a2 = x2 + h * slope[stage - 1, 1]
                b1 = v1 + h * slope[stage - 1, 2]
                b2 = v2 + h * slope[stage - 1, 3]
            joint = kj * (a2 - a1) + cj * (b2 - b1)
            first = f if body == 0 else 0.0
            second = f if body == 1 else 0.0
            slope[stage, 0] = b1
            slope[stage, 1] = b2
            slope[stage, 2] = (first + joint - k0 * a1 - c0 * b1) / m1
            slope[stage, 3] = (second - joint) / m2
            if stage == 0:
                out[0, i] = slope[0, 2]
                out[1, i] = slope[0, 3]
        w = step / 6.0
        x1 += w * (slope[0, 0] + 2 * slope[1, 0] + 2 * slope[2, 0] + slope[3, 0])
        x2 += w * (slope[0, 1] + 2 * slope[1, 1] + 2 * slope[2, 1] + slope[3, 1])
        v1 += w * (slope[0, 2] + 2 * slope[1, 2] + 2 * slope[2, 2] + slope[3, 2])
        v2 += w * (slope[0, 3] + 2 * slope[1, 3] + 2 * slope[2, 3] + slope[3, 3])
    return out


def scattered_null(
    seed: int, way: str, size: float, *, grid: str | None = None
) -> tuple[SimulatedCampaign, Scatter]:
    """Return a campaign without a missing effect, and how its hits deviate.

    Args:
        seed: of all draws.
        way: one of `WAYS`.
        size: relative size of the scatter [-].
        grid: of hits; None draws it.
    """
    design = draw_design(seed, grid=grid)
    rng = np.random.default_rng([seed, sorted(WAYS).index(way), int(1e4 * size)])
    scatter = draw_scatter(way, size, len(design.conditions), rng)
    records = [
        _record(design, condition, scatter, i)
        for i, condition in enumerate(design.conditions)
    ]
    force = np.stack([r[0] for r in records])
    acceleration = np.stack([r[1:] for r in records])
    force = force + FORCE_NOISE * design.noise * heavy_noise(rng, force.shape)
    acceleration = acceleration + design.noise * heavy_noise(rng, acceleration.shape)
    return SimulatedCampaign(design, (), (), force, acceleration), scatter


def heavy_noise(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Return white noise of unit sd with 10 degrees of freedom of Student's t."""
    return rng.standard_t(10, shape) * np.sqrt(0.8)


def _record(
    design: CampaignDesign, condition: CampaignCondition, scatter: Scatter, hit: int
) -> Floats:
    """Return force and accelerations of one hit, sampled, shape (3, n)."""
    beyond = CONVERTER.half_length // CONVERTER.oversampling + 1
    rate = SAMPLE_RATE * CONVERTER.oversampling
    count = (SAMPLES + beyond) * CONVERTER.oversampling
    time = np.arange(2 * count + 1) / (2 * rate)
    p = design.physical
    numbers = np.array([p[k] for k in ("m1", "m2", "k0", "c0", "kj", "cj")])
    numbers[4] *= scatter.joint[hit]
    acting = pulse_force([condition.pulse], time)
    moved = _integrate(acting, numbers, condition.hit_dof, 1.0 / rate)
    seen = pulse_force([condition.pulse], time[:-1:2] - scatter.delay[hit])
    rows = np.vstack([seen, scatter.gain[hit][:, None] * moved])
    (sampled,) = decimate([rows], CONVERTER)
    return np.asarray(sampled[:, :SAMPLES])
