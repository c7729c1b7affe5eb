# SPDX-License-Identifier: MIT
"""Draw a flexible bench: specimen, joint, hits, noise and hidden effects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.simulators.flexible.closed_structure import (
    specimen_coordinates,
)
from jointbench.simulators.flexible.draw_specimen import draw_specimen
from jointbench.simulators.flexible.faulty_sensors import (
    sensor_rows,
)
from jointbench.simulators.flexible.flexible_bench import (
    COMPLIANCES,
    FlexibleBench,
    hit_set,
    structure_of,
)
from jointbench.simulators.flexible.flexible_effects import (
    DrawScales,
    draw_effect_of,
    require_flexible,
)
from jointbench.simulators.flexible.flexible_specimen import BoltedSpecimen
from jointbench.simulators.flexible.gauss_integration import integrate_hits
from jointbench.simulators.flexible.hit_plan import draw_tip, levels_to, plan_hits
from jointbench.simulators.flexible.hit_records import (
    PRETRIGGER,
    SAMPLE_RATE,
)
from jointbench.simulators.flexible.joint_values import (
    BoltValues,
    draw_nominal,
    draw_true,
)
from jointbench.simulators.flexible.physical_bodies import (
    MESHED_EFFECTS,
    physical_bodies,
    thicker_body,
)
from jointbench.simulators.flexible.sensor_chain import (
    FULL_SCALE,
    InputNoise,
    sensitivities,
)

_MAINS = 50.0  # [Hz]
_STRONGEST = 1200.0  # highest level [N]

_FILLED = 450.0  # acceleration at the highest level [m/s^2], half of the range

_NOISE_RANGE = (60.0, 80.0)  # below the peaks at the middle of the levels [dB]

_FORCE_NOISE = 10.0  # [dB] further below the force

_TRIED = 0.03  # [s] after which no motion is larger

_YIELDING = {"joint_compliance_tangential", "microslip", "macroslip"}

_BEYOND = {"exact": 0, "life": 0}


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
    more = _BEYOND.get(world, 0) if beyond is None else beyond
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
        levels_to(_STRONGEST),
        (),
        InputNoise(0.0, 0.0, 0.0, 50.0, 0.0),
    )
    tip = draw_tip(rng)
    plan = plan_hits(specimen.points, torques, plain.levels, tip, rng)
    trial = replace(plain, hits=plan)
    strong, typical, scales = _tried(trial)
    share = min(1.0, _FILLED / max(strong))
    levels = levels_to(_STRONGEST * share)
    force, acceleration = FULL_SCALE / sensitivities(2)
    limits = tuple(
        min(float(force), trial.levels[-1] * float(acceleration) / peak)
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
    noise = _noise(
        middle * 10 ** (-(depth + _FORCE_NOISE) / 20),
        typical * middle / trial.levels[-1] * 10 ** (-depth / 20),
        rng,
    )
    drawn = tuple(draw_effect_of(name, scales, rng) for name in names)
    made = replace(plain, levels=levels, hits=hits, noise=noise, effects=drawn)
    return _grown(made)


def _grown(bench: FlexibleBench) -> FlexibleBench:
    """Return a bench whose bodies have the thickness that is hidden."""
    bodies = bench.bodies
    for effect in bench.effects:
        if effect.name in MESHED_EFFECTS:
            factor = effect.parameters["factor"]
            first, second = (
                thicker_body(one, factor)
                if one.body.name == effect.where["body"]
                else one
                for one in bodies
            )
            bodies = first, second
    if bodies is bench.bodies:
        return bench
    return replace(bench, coordinates=specimen_coordinates(bench.specimen, bodies))


def _noise(force: float, acceleration: float, rng: np.random.Generator) -> InputNoise:
    """Draw mains and offset beside given white noise [N], [m/s^2]."""
    return InputNoise(
        force=force,
        acceleration=acceleration,
        mains=float(rng.uniform(0.3, 1.5)),
        mains_frequency=_MAINS + float(rng.uniform(-0.1, 0.1)),
        offset=float(rng.uniform(1e-4, 1e-3)),
    )


def _values(
    specimen: BoltedSpecimen, names: Sequence[str], rng: np.random.Generator
) -> tuple[BoltValues, BoltValues]:
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
