# SPDX-License-Identifier: MIT
"""How far a hidden effect stands out in the hits of a campaign.

The change that an effect makes is projected on what the base and the aim of each hit
cannot follow within their priors. One good hit of each condition is integrated over its
first milliseconds and stands for the repeats; the change is of first order in the base.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.faulty_sensors import (
    faulty_signals,
    sensor_rows,
    surface_axes,
)
from jointbench.simulators.flexible.flexible_bench import (
    FlexibleBench,
    hit_set,
    structure_of,
)
from jointbench.simulators.flexible.gauss_integration import integrate_hits
from jointbench.simulators.flexible.hit_plan import AIM_SIGMA, TILT_SIGMA
from jointbench.simulators.flexible.hit_records import (
    PRETRIGGER,
    SAMPLE_RATE,
    HitRecord,
)
from jointbench.simulators.flexible.joint_values import (
    BOLT_SIGMA,
    DAMPING_SIGMA,
    FEET_SIGMA,
    MODULUS_SIGMA,
    STIFFNESS_SIGMA,
    BoltValues,
)

_WINDOW = 0.04  # [s] of each hit
_OVERSAMPLING = 3
_DIFFERENCE = 0.02  # of a prior's standard deviation, for differences
_TABLE_ERROR = 0.01  # of the peak of a record, where the modal table is not exact


@dataclass(frozen=True, slots=True)
class FlexibleMargin:
    """How far an effect stands out.

    Attributes:
        rho: norm of the change that the base cannot follow, over the noise and over the
            square root of the number of parameters [-].
        margin: its square [-], before any rival.
        alone: the same norm before the base follows [-].
    """

    rho: float
    margin: float
    alone: float


def flexible_margin(bench: FlexibleBench, name: str) -> FlexibleMargin:
    """Return how far one effect of a bench stands out beside the others.

    Args:
        bench: drawn.
        name: of the effect.
    """
    chosen = _one_of_each(bench)
    good = sum(hit.bad is None for hit in bench.hits)
    others = tuple(e for e in bench.effects if e.name != name)
    without = replace(bench, effects=others)
    effect = next(e for e in bench.effects if e.name == name)
    whole, base = _records(bench, chosen), _records(without, chosen)
    weight = 1 / _noise(bench, base)
    change = ((whole - base) * weight).reshape(len(chosen), -1)
    aims = _aim_columns(without, chosen) * weight[:, None]
    aims = aims.reshape(*aims.shape[:2], -1)
    columns = np.stack(
        [
            ((_records(replace(without, values=v), chosen) - base) * weight).reshape(
                len(chosen), -1
            )
            / _DIFFERENCE
            for v in _moved_values(bench.nominal, bench.values)
        ],
        axis=1,
    )
    left = _left(change, columns, aims)
    scale = good / len(chosen) / max(1, len(effect.parameters))
    rho = float(np.sqrt(left * scale))
    return FlexibleMargin(rho, rho**2, float(np.sqrt(np.sum(change**2) * scale)))


def _one_of_each(bench: FlexibleBench) -> list[HitRecord]:
    """Return the first good hit of each condition, at the highest and lowest level."""
    levels = {bench.levels[0], bench.levels[-2], bench.levels[-1]}
    found: dict[tuple[int, float, float], HitRecord] = {}
    for hit in bench.hits:
        if hit.bad is None and hit.level in levels:
            found.setdefault((hit.point, hit.torque, hit.level), hit)
    return list(found.values())


def _records(bench: FlexibleBench, hits: list[HitRecord]) -> FloatArray:
    """Return accelerations from just before the hit, shape (n_hits, n_sensors, n)."""
    rows = sensor_rows(bench.coordinates, bench.specimen, bench.effects)
    step = 1 / (_OVERSAMPLING * SAMPLE_RATE)
    start = PRETRIGGER / SAMPLE_RATE - 4e-4
    moved = [_earlier(hit, start) for hit in hits]
    found: list[FloatArray] = [np.zeros(0)] * len(hits)
    drifts = any(effect.name == "thermal_drift" for effect in bench.effects)
    keys = [h.time if drifts else h.torque for h in hits]
    for key in sorted(set(keys)):
        group = [i for i, own in enumerate(keys) if own == key]
        structure, laws = structure_of(bench, hits[group[0]])
        signals = integrate_hits(
            structure,
            hit_set(bench, [moved[i] for i in group], rows),
            laws,
            steps=round(_WINDOW / step),
            step=step,
        )
        signals = faulty_signals(signals, bench.specimen, bench.effects, rate=1 / step)
        for i, seen in zip(group, signals, strict=True):
            found[i] = seen[:, ::_OVERSAMPLING]
    return np.stack(found)


def _earlier(hit: HitRecord, start: float) -> HitRecord:
    """Return a hit in a record that begins later by `start` [s]."""
    pulses = tuple(replace(p, start=p.start - start) for p in hit.pulses)
    return replace(hit, pulses=pulses)


def _noise(bench: FlexibleBench, base: FloatArray) -> FloatArray:
    """Return the standard deviation in each record and channel, shape (n, m, 1)."""
    floor = 0.0 if bench.world == "exact" else _TABLE_ERROR
    peak = np.abs(base).max(axis=2, keepdims=True)
    return np.asarray(np.hypot(bench.noise.acceleration, floor * peak))


def _moved_values(nominal: BoltValues, true: BoltValues) -> Iterator[BoltValues]:
    """Yield the true values, each with one parameter moved along its prior."""

    def up(sigma: float) -> float:
        return float(np.exp(_DIFFERENCE * sigma))

    rigid = np.isinf(nominal.stiffness[0])
    for axis in np.flatnonzero(~rigid):
        factors = np.ones(3)
        factors[axis] = up(STIFFNESS_SIGMA)
        yield replace(true, stiffness=true.stiffness * factors)
    for axes in ([0, 1], [2]):
        factors = np.ones(3)
        factors[axes] = up(DAMPING_SIGMA)
        yield replace(true, damping=true.damping * factors)
    for bolt in range(true.stiffness.shape[0]):
        factors = np.ones((true.stiffness.shape[0], 1))
        factors[bolt] = up(BOLT_SIGMA)
        yield replace(
            true, stiffness=true.stiffness * factors, damping=true.damping * factors
        )
    yield replace(true, feet_stiffness=true.feet_stiffness * up(FEET_SIGMA))
    yield replace(true, feet_damping=true.feet_damping * up(DAMPING_SIGMA))
    for body in (0, 1):
        factors = np.ones(2)
        factors[body] = up(MODULUS_SIGMA)
        yield replace(true, modulus=true.modulus * factors)
        factors[body] = up(DAMPING_SIGMA)
        yield replace(true, damping_ratio=true.damping_ratio * factors)


def _aim_columns(bench: FlexibleBench, hits: list[HitRecord]) -> FloatArray:
    """Return the change by aim and tilt of each hit, one standard deviation each.

    Returns:
        Shape (n_hits, 4, n_sensors, n).
    """
    base = _records(bench, hits)
    found = []
    for way in range(4):
        moved = [_moved_hit(bench, hit, way) for hit in hits]
        found.append((_records(bench, moved) - base) / _DIFFERENCE)
    return np.stack(found, axis=1)


def _moved_hit(bench: FlexibleBench, hit: HitRecord, way: int) -> HitRecord:
    axis = surface_axes(bench.specimen.points[hit.point])[way % 2]
    if way < 2:
        offset = np.asarray(hit.offset) + _DIFFERENCE * AIM_SIGMA * axis
        x, y, z = (float(value) for value in offset)
        return replace(hit, offset=(x, y, z))
    direction = np.asarray(hit.direction) + _DIFFERENCE * TILT_SIGMA * axis
    x, y, z = (float(value) for value in direction / np.linalg.norm(direction))
    return replace(hit, direction=(x, y, z))


def _left(change: FloatArray, columns: FloatArray, aims: FloatArray) -> float:
    """Return what is left of a change after a least squares fit with unit priors.

    Args:
        change: shape (n_hits, n).
        columns: of parameters common to all hits, shape (n_hits, n_parameters, n).
        aims: of parameters of each hit, shape (n_hits, n_ways, n).
    """
    count = columns.shape[1]
    matrix, vector, total = np.eye(count), np.zeros(count), 0.0
    for own, common, ways in zip(change, columns, aims, strict=True):
        inner = np.linalg.inv(ways @ ways.T + np.eye(ways.shape[0]))

        def left(
            x: FloatArray, w: FloatArray = ways, m: FloatArray = inner
        ) -> FloatArray:
            """Return the part that aim and tilt do not follow."""
            return np.asarray(x - (x @ w.T) @ m @ w)

        rest = left(common)
        matrix += rest @ common.T
        vector += rest @ own
        total += float(left(own) @ own)
    return max(total - float(vector @ np.linalg.solve(matrix, vector)), 0.0)
