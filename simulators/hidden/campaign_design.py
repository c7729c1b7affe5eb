# SPDX-License-Identifier: MIT
"""The design of a two-body hammer campaign: specimen, hits and noise, seeded."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.hidden.campaign_sampling import PRETRIGGER, SAMPLE_RATE
from jointbench.simulators.hidden.hit_deviations import (
    HitDeviations,
    ScatterWays,
    draw_deviations,
)
from jointbench.simulators.measuring.hammer import Pulse

BASE_NAMES = ("m1", "m2", "k0", "c0", "kj", "cj")
# One-sigma relative errors of the nominal parameters: masses are weighed.
NOMINAL_SIGMA: Mapping[str, float] = {
    "m1": 0.003,
    "m2": 0.003,
    "k0": 0.05,
    "c0": 0.2,
    "kj": 0.1,
    "cj": 0.3,
}
_NOMINAL_RANGE: Mapping[str, tuple[float, float]] = {
    "m1": (6.0, 11.0),
    "m2": (3.0, 5.5),
    "k0": (1.8e7, 3.0e7),
    "c0": (220.0, 360.0),
    "kj": (4.5e7, 8.0e7),
    "cj": (160.0, 300.0),
}


@dataclass(frozen=True, slots=True)
class CampaignCondition:
    """One record: struck body, force level and preload.

    Attributes:
        level: nominal peak force [N].
        hit_dof: 0 the base, 1 the top.
        preload: on the joint [N].
        preload_ratio: preload over the reference preload [-].
        order: index in the sequence of recording.
        progress: `order` over the last one, 0..1 [-].
        pulse: the force of the hit.
        force_factor: acting over measured force, the scatter of the operator [-].
        joint_factor: joint stiffness over its mean, the scatter of the joint [-].
        phase: of any hum at the start of the record [rad].
        channel_gain: of each acceleration in this hit over its true one [-].
        force_delay: of the recorded force [s].
    """

    level: float
    hit_dof: int
    preload: float
    preload_ratio: float
    order: int
    progress: float
    pulse: Pulse
    force_factor: float
    joint_factor: float
    phase: float
    channel_gain: tuple[float, float] = (1.0, 1.0)
    force_delay: float = 0.0


@dataclass(frozen=True, slots=True)
class CampaignDesign:
    """All of a campaign but its hidden effects.

    Attributes:
        seed: of all draws.
        nominal: values of m1, m2 [kg], k0, kj [N/m], c0, cj [N s/m].
        physical: true values.
        preload_reference: preload of the true values [N].
        noise: standard deviation of each acceleration [m/s^2].
        hit_scatter: relative standard deviation between hits [-].
        conditions: of the records, in order.
        ways: scatter beyond that of strength and joint.
    """

    seed: int
    nominal: Mapping[str, float]
    physical: Mapping[str, float]
    preload_reference: float
    noise: float
    hit_scatter: float
    conditions: tuple[CampaignCondition, ...]
    ways: ScatterWays = field(default_factory=ScatterWays)


# (hit dof, level [N], preload over the reference)
_Grid = tuple[tuple[int, float, float], ...]
_LEVELS = (30.0, 100.0, 300.0, 1000.0)
GRIDS: Mapping[str, _Grid] = {
    "full": (
        *((1, level, 1.0) for level in _LEVELS),
        *((1, level, 1.0) for level in _LEVELS),
        *((0, level, 1.0) for level in _LEVELS[1:]),
        *((1, 300.0, ratio) for ratio in (0.5, 2.0, 4.0, 2.0)),
        (0, 300.0, 2.0),
    ),
    "middle": (
        *((1, level, 1.0) for level in _LEVELS),
        (1, 300.0, 1.0),
        (1, 1000.0, 1.0),
        *((0, level, 1.0) for level in _LEVELS[1:]),
        *((1, 300.0, ratio) for ratio in (0.5, 2.0)),
        (0, 300.0, 2.0),
    ),
    "small": (
        *((1, level, 1.0) for level in (30.0, 200.0, 1000.0)),
        (1, 200.0, 1.0),
        *((0, level, 1.0) for level in (200.0, 1000.0)),
        (1, 200.0, 2.0),
        (0, 200.0, 2.0),
    ),
    # Every condition twice, with preloads up and down, to show loosening.
    "crossed": tuple(
        (dof, level, ratio)
        for ratio in (0.5, 1.0, 2.0, 2.0, 1.0, 0.5)
        for dof in (1, 0)
        for level in _LEVELS
    ),
}
_DRAWN = ("full", "middle", "small")


def draw_design(
    seed: int,
    *,
    grid: str | None = None,
    noise: float | None = None,
    hit_scatter: float = 0.0,
    ways: ScatterWays | None = None,
) -> CampaignDesign:
    """Draw a specimen, its nominal parameters and its hits.

    Args:
        seed: of all draws.
        grid: name of one of `GRIDS`; None draws one, except crossed designs, most often
            the full one.
        noise: of each acceleration [m/s^2]; None draws it from 0.02 to 0.5.
        hit_scatter: relative standard deviation of force and joint stiffness from
            hit to hit [-].
        ways: further scatter; None for none.

    Returns:
        The design.

    Raises:
        UsageError: there is no such grid.
    """
    rng = np.random.default_rng([seed, 11])
    nominal = {
        name: float(f"{rng.uniform(low, high):.4g}")
        for name, (low, high) in _NOMINAL_RANGE.items()
    }
    physical = {
        name: value * float(np.exp(NOMINAL_SIGMA[name] * rng.standard_normal()))
        for name, value in nominal.items()
    }
    drawn_grid = str(rng.choice(_DRAWN, p=[0.6, 0.2, 0.2]))
    drawn_noise = float(np.exp(rng.uniform(np.log(0.02), np.log(0.5))))
    reference = float(rng.choice([2000.0, 4000.0, 5000.0], p=[0.2, 0.6, 0.2]))
    chosen = drawn_grid if grid is None else grid
    if chosen not in GRIDS:
        raise UsageError(f"unknown grid {chosen!r}; there are {', '.join(GRIDS)}")
    conditions = _conditions(GRIDS[chosen], reference, hit_scatter, rng)
    further = ScatterWays() if ways is None else ways
    deviations = draw_deviations(seed, len(conditions), further)
    return CampaignDesign(
        seed=seed,
        nominal=nominal,
        physical=physical,
        preload_reference=reference,
        noise=drawn_noise if noise is None else noise,
        hit_scatter=hit_scatter,
        conditions=deviating(conditions, deviations),
        ways=further,
    )


def deviating(
    conditions: tuple[CampaignCondition, ...], deviations: HitDeviations
) -> tuple[CampaignCondition, ...]:
    """Return the conditions with gains and delays of their hits."""
    return tuple(
        replace(
            condition,
            channel_gain=(float(gain[0]), float(gain[1])),
            force_delay=float(delay),
        )
        for condition, gain, delay in zip(
            conditions, deviations.gain, deviations.delay, strict=True
        )
    )


def _conditions(
    grid: _Grid, reference: float, scatter: float, rng: np.random.Generator
) -> tuple[CampaignCondition, ...]:
    last = len(grid) - 1
    return tuple(
        CampaignCondition(
            level=level,
            hit_dof=dof,
            preload=ratio * reference,
            preload_ratio=ratio,
            order=order,
            progress=order / last,
            pulse=pulse_of(level, rng),
            force_factor=1 + scatter * float(rng.standard_normal()),
            joint_factor=1 + scatter * float(rng.standard_normal()),
            phase=float(rng.uniform(0, 2 * np.pi)),
        )
        for order, (dof, level, ratio) in enumerate(grid)
    )


def pulse_of(level: float, rng: np.random.Generator) -> Pulse:
    """Draw a hit near the end of the pre-trigger, within 10 % of its level."""
    return Pulse(
        start=(PRETRIGGER + rng.uniform(-2, 2)) / SAMPLE_RATE,
        width=rng.uniform(11.5, 15.5) / SAMPLE_RATE,
        peak=level * rng.uniform(0.9, 1.1),
        exponent=rng.uniform(1.3, 1.9),
        skew=rng.uniform(-0.08, 0.08),
    )
