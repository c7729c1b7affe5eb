# SPDX-License-Identifier: MIT
"""Hammer campaigns on flexible specimens with hidden effects."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.simulators.flexible.closed_structure import (
    ClosedStructure,
    Coordinates,
    close_structure,
    specimen_coordinates,
)
from jointbench.simulators.flexible.flexible_effects import (
    DrawScales,
    FlexibleEffect,
    draw_effect_of,
    require_flexible,
)
from jointbench.simulators.flexible.flexible_specimen import (
    BoltedSpecimen,
    draw_specimen,
)
from jointbench.simulators.flexible.friction_and_stops import LawBank, law_bank
from jointbench.simulators.flexible.gauss_integration import HitSet, integrate_hits
from jointbench.simulators.flexible.hidden_in_joint import (
    HitCondition,
    added_coordinates,
    joint_state,
    port_laws_of,
)
from jointbench.simulators.flexible.hit_plan import (
    PRETRIGGER,
    SAMPLE_RATE,
    SAMPLES,
    HitRecord,
    draw_tip,
    levels_to,
    plan_hits,
)
from jointbench.simulators.flexible.joint_values import (
    JointValues,
    draw_nominal,
    draw_true,
)
from jointbench.simulators.flexible.physical_bodies import (
    PhysicalBody,
    physical_bodies,
)
from jointbench.simulators.flexible.sensor_chain import (
    ACCELEROMETER_SENSITIVITY,
    CONVERTER,
    FULL_SCALE,
    HAMMER_SENSITIVITY,
    OVERSAMPLING,
    InputNoise,
    digitised,
    draw_noise,
    faulty_signals,
    sampled,
    sensor_rows,
    shifted,
)

STRONGEST = 1200.0  # highest level [N]
_FILLED = 450.0  # acceleration at the highest level [m/s^2], half of the range
_NOISE_RANGE = (60.0, 80.0)  # below the peaks at the middle of the levels [dB]
_FORCE_NOISE = 10.0  # [dB] further below the force
_TRIED = 0.03  # [s] after which no motion is larger
COMPLIANCES = {
    "joint_compliance_tangential": slice(0, 2),
    "joint_compliance_normal": slice(2, 3),
}
"""Directions that count as rigid where these are hidden."""
_YIELDING = {"joint_compliance_tangential", "microslip", "macroslip"}
BEYOND = {"exact": 0, "life": 0}


@dataclass(frozen=True, slots=True, eq=False)
class FlexibleBench:
    """A specimen and everything drawn about it, before any hit is simulated.

    Attributes:
        seed: of all draws.
        world: ``exact`` or ``life``.
        specimen: as drawn.
        coordinates: its rows, with the bodies as they are.
        nominal: as the crew knows it, infinite where a direction counts as rigid.
        values: as it is.
        torques: on each bolt [N m].
        levels: peak forces [N].
        hits: in order of time.
        noise: of the inputs.
        effects: hidden ones.
    """

    seed: int
    world: str
    specimen: BoltedSpecimen
    coordinates: Coordinates
    nominal: JointValues
    values: JointValues
    torques: tuple[float, ...]
    levels: tuple[float, ...]
    hits: tuple[HitRecord, ...]
    noise: InputNoise
    effects: tuple[FlexibleEffect, ...] = ()

    @property
    def bodies(self) -> tuple[PhysicalBody, PhysicalBody]:
        """As they are."""
        return self.coordinates.bodies

    def condition(self, hit: HitRecord) -> HitCondition:
        """Return torque and time of a hit over those they refer to."""
        reference = float(np.median(self.torques))
        return HitCondition(
            hit.torque / reference, hit.time / max(self.hits[-1].time, 1e-9)
        )


@dataclass(frozen=True, slots=True, eq=False)
class FlexibleCampaign:
    """A simulated campaign.

    Attributes:
        bench: everything drawn.
        counts: of each hit, shape (n_hits, 1 + n_sensors, SAMPLES).
    """

    bench: FlexibleBench
    counts: IntArray = field(repr=False)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "counts")


def draw_bench(
    seed: int,
    *,
    kind: str = "plates",
    world: str = "exact",
    effects: Sequence[str] = (),
    beyond: int | None = None,
) -> FlexibleBench:
    """Draw a specimen, its campaign of hits and its hidden effects.

    Args:
        seed: of all draws.
        kind: one of `SPECIMEN_KINDS`.
        world: ``exact`` or ``life``, which the modal table is.
        effects: names to hide.
        beyond: modes that the bodies have and the table lacks.

    Raises:
        UsageError: kind, world or an effect is unknown.
    """
    names = [require_flexible(name) for name in effects]
    rng = np.random.default_rng([seed, 27])
    specimen = draw_specimen(kind, rng)
    more = BEYOND.get(world, 0) if beyond is None else beyond
    bodies = physical_bodies(specimen, world, beyond=more, rng=rng)
    coordinates = specimen_coordinates(specimen, bodies)
    nominal, values = _values(specimen, names, rng)
    count = int(rng.choice((2, 3)))
    torques = tuple(float(x) for x in np.round(np.geomspace(20.0, 80.0, count), -1))
    plain = FlexibleBench(
        seed,
        world,
        specimen,
        coordinates,
        nominal,
        values,
        torques,
        levels_to(STRONGEST),
        (),
        InputNoise(0.0, 0.0, 0.0, 50.0, 0.0),
    )
    tip = draw_tip(rng)
    plan = plan_hits(specimen.points, torques, plain.levels, tip, rng)
    trial = replace(plain, hits=plan)
    strong, typical, scales = _tried(trial)
    share = min(1.0, _FILLED / max(strong))
    levels = levels_to(STRONGEST * share)
    full = FULL_SCALE / ACCELEROMETER_SENSITIVITY
    limits = tuple(
        min(FULL_SCALE / HAMMER_SENSITIVITY, trial.levels[-1] * full / peak)
        for peak in strong
    )
    hits = plan_hits(specimen.points, torques, levels, tip, rng, limits=limits)
    share = levels[-1] / trial.levels[-1]
    scales = replace(
        scales,
        travel=share * scales.travel,
        speed=share * scales.speed,
        feet_travel=share * scales.feet_travel,
    )
    depth = float(rng.uniform(*_NOISE_RANGE))
    middle = float(np.sqrt(levels[0] * levels[-1]))
    noise = draw_noise(
        middle * 10 ** (-(depth + _FORCE_NOISE) / 20),
        typical * middle / trial.levels[-1] * 10 ** (-depth / 20),
        rng,
    )
    drawn = tuple(draw_effect_of(name, scales, rng) for name in names)
    return replace(plain, levels=levels, hits=hits, noise=noise, effects=drawn)


def _values(
    specimen: BoltedSpecimen, names: Sequence[str], rng: np.random.Generator
) -> tuple[JointValues, JointValues]:
    """Return nominal and true values; a hidden compliance counts as rigid before."""
    nominal = draw_nominal(specimen, rng)
    # What slips or yields needs a spring.
    while _YIELDING & set(names) and np.isinf(nominal.stiffness).any():
        nominal = draw_nominal(specimen, rng)
    values = draw_true(nominal, rng)
    stated = nominal.stiffness.copy()
    for name, columns in COMPLIANCES.items():
        if name in names:
            stated[:, columns] = np.inf
    return replace(nominal, stiffness=stated), values


def _tried(bench: FlexibleBench) -> tuple[tuple[float, ...], float, DrawScales]:
    """Return peaks by point and a typical peak at the highest level, and motions."""
    chosen = [h for h in bench.hits if h.level == bench.levels[-1] and h.bad is None]
    chosen = [
        next(h for h in chosen if h.point == p)
        for p in range(len(bench.specimen.points))
    ]
    place = bench.coordinates
    structure, laws = structure_of(replace(bench, effects=()), chosen[0])
    bolts = place.bolts.reshape(-1, place.size)
    rows = np.vstack((sensor_rows(place, bench.specimen, ()), bolts, place.feet[:, 2]))
    step = 1 / (4 * SAMPLE_RATE)
    steps = round((PRETRIGGER / SAMPLE_RATE + _TRIED) / step)
    found = integrate_hits(
        structure, hit_set(bench, chosen, rows), laws, steps=steps, step=step
    )
    sensors = len(bench.specimen.sensors)
    seen, across = found[:, :sensors], found[:, sensors:]
    velocity = np.cumsum(across, axis=-1) * step
    motion = np.cumsum(velocity, axis=-1) * step
    speed, travel = (np.abs(x).max(axis=(0, 2)) for x in (velocity, motion))
    split = bolts.shape[0]
    peaks = np.abs(seen).max(axis=(0, 2))
    scales = DrawScales(
        bench.specimen,
        bench.values,
        travel[:split].reshape(-1, 3),
        speed[:split].reshape(-1, 3),
        travel[split:],
    )
    by_point = tuple(float(x) for x in np.abs(seen).max(axis=(1, 2)))
    return by_point, float(np.median(peaks)), scales


def structure_of(
    bench: FlexibleBench, hit: HitRecord
) -> tuple[ClosedStructure, LawBank | None]:
    """Return the structure that a hit meets, and its laws."""
    condition = bench.condition(hit)
    state = joint_state(
        bench.coordinates, bench.specimen, _acting(bench), bench.effects, condition
    )
    structure = close_structure(bench.coordinates, state)
    laws = port_laws_of(bench.coordinates, state, bench.effects, condition)
    return structure, law_bank(laws, structure.lift.shape[0])


def _acting(bench: FlexibleBench) -> JointValues:
    """Return the true values, rigid where no hidden compliance shows them."""
    stiffness = bench.values.stiffness.copy()
    names = {effect.name for effect in bench.effects}
    for name, columns in COMPLIANCES.items():
        rigid = np.isinf(bench.nominal.stiffness[:, columns])
        if name not in names and rigid.any():
            stiffness[:, columns] = np.inf
    return replace(bench.values, stiffness=stiffness)


def hit_set(
    bench: FlexibleBench, hits: Sequence[HitRecord], rows: FloatArray
) -> HitSet:
    """Return hits with their loads where they land, and rows to be observed.

    Args:
        bench: drawn.
        hits: on one structure.
        rows: shape (n_rows, n_coordinates).
    """
    extra = sum(added_coordinates(effect) for effect in bench.effects)
    load = np.stack([_load(bench, hit) for hit in hits], axis=1)
    load = np.vstack((load, np.zeros((extra, load.shape[1]))))
    rows = np.hstack((rows, np.zeros((rows.shape[0], extra))))
    return HitSet(load, lambda times: np.stack([h.force(times) for h in hits]), rows)


def _load(bench: FlexibleBench, hit: HitRecord) -> FloatArray:
    """Return the generalised force of one newton where a hit lands."""
    aimed = bench.specimen.points[hit.point]
    place = aimed.position
    for effect in bench.effects:
        if effect.name == "wrong_hit_point" and effect.where["point"] == aimed.name:
            place = shifted(aimed, effect.parameters["u"], effect.parameters["v"])
    x, y, z = np.asarray(place) + np.asarray(hit.offset)
    rows = bench.coordinates.rows(aimed.body, (float(x), float(y), float(z)))
    return np.asarray(np.asarray(hit.direction) @ rows)


def simulate_hits(bench: FlexibleBench) -> FloatArray:
    """Return force [N] and accelerations [m/s^2] of all hits, without noise.

    Returns:
        Shape (n_hits, 1 + n_sensors, SAMPLES).
    """
    place = bench.coordinates
    rows = sensor_rows(place, bench.specimen, bench.effects)
    steps = (SAMPLES + CONVERTER.half_length // OVERSAMPLING + 1) * OVERSAMPLING
    step = 1 / (OVERSAMPLING * SAMPLE_RATE)
    found = np.zeros((len(bench.hits), 1 + rows.shape[0], SAMPLES))
    for group in _groups(bench):
        hits = [bench.hits[i] for i in group]
        structure, laws = structure_of(bench, hits[0])
        own = hit_set(bench, hits, rows)
        signals = integrate_hits(structure, own, laws, steps=steps, step=step)
        signals = faulty_signals(signals, bench.specimen, bench.effects, rate=1 / step)
        force = own.force(step * np.arange(steps, dtype=float))
        for index, f, seen in zip(group, force, signals, strict=True):
            found[index] = sampled(f, seen)
    return found


def _groups(bench: FlexibleBench) -> list[list[int]]:
    """Return the hits that meet the same structure."""
    drifts = any(effect.name == "thermal_drift" for effect in bench.effects)
    keys = [h.time if drifts else h.torque for h in bench.hits]
    return [[i for i, k in enumerate(keys) if k == key] for key in sorted(set(keys))]


def make_flexible_campaign(bench: FlexibleBench) -> FlexibleCampaign:
    """Simulate all hits of a bench, as its converter delivers them."""
    rng = np.random.default_rng([bench.seed, 28])
    physical = simulate_hits(bench)
    counts = [
        digitised(record, bench.noise, hit.time, rng)
        for record, hit in zip(physical, bench.hits, strict=True)
    ]
    return FlexibleCampaign(bench, np.stack(counts))
