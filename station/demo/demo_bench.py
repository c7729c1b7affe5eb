# SPDX-License-Identifier: MIT
"""The demo's session on the simulated bench: hits, two surfaces, masses, truth."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import JointSetup, Session, new_session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.hits.find_hits import find_hits
from jointbench.simulators.rough_surfaces.profilometer import (
    Profilometer,
    measure_areal,
)
from jointbench.simulators.rough_surfaces.rough_surface import rough_map
from jointbench.simulators.rough_surfaces.surface_files import write_keyence_csv
from jointbench.simulators.two_body.bench import BenchTruth, TwoBodyBench
from jointbench.simulators.two_body.bench_url import bench_from_url
from jointbench.station.screen.escaping_console import Screen
from jointbench.station.sources.chassis_source import ChassisSource
from jointbench.station.sources.record_source import record

HITS = 12
_TORQUE = 20.0
"""Of each bolt [N m]."""
_DIMENSION = 1.48
"""Of a profile of the surfaces [-]; the station has to find it."""
_ROUGHNESS = 4e-11
"""Fractal roughness of a profile of the surfaces [m]."""
_MAP_ROWS, _MAP_COLUMNS, _MAP_SPACING = 192, 1024, 0.271217e-6
_SCALE_ERROR = 1e-3
"""Relative standard deviation of the simulated scale [-]."""


@dataclass(frozen=True, slots=True)
class DemoTruth:
    """What the simulated specimen is made of.

    Attributes:
        bench: bodies, links, modes and hits.
        dimension: of a profile of either surface [-].
        roughness: of a profile of either surface [m].
    """

    bench: BenchTruth
    dimension: float
    roughness: float


@dataclass(frozen=True, slots=True, eq=False)
class DemoSession:
    """Result of the session; only the truth comes from the simulation itself.

    Attributes:
        session: hits and surfaces, as a real session would record them.
        masses: weighed mass of each body [kg], by name.
        mass_sds: standard deviation of the scale for each [kg].
        truth: for the comparison at the end, never for an estimate.
    """

    session: Session
    masses: dict[str, float]
    mass_sds: dict[str, float]
    truth: DemoTruth


def record_demo_session(folder: Path, *, seed: int) -> DemoSession:
    """Record hits and two surfaces on the simulated bench.

    Args:
        folder: where the profilometer leaves its CSV files.
        seed: of hammer, noise and surfaces.

    Returns:
        The session and, apart from it, the truth.
    """
    bench = bench_from_url(f"sim:two-body?seed={seed}&hits={HITS}&torque={_TORQUE:g}")
    recording = find_hits(_record_hits(bench))
    truth = bench.truth
    session = new_session(
        source=bench.name,
        simulated=True,
        recordings=(recording,),
        surfaces=tuple(_measure_face(folder, name, seed) for name in ("a", "b")),
        joint=JointSetup(preload=truth.preload, torque=truth.torque),
        notes="Two bodies on a bolted joint, struck on the top.",
    )
    masses = _weigh(truth, seed)
    return DemoSession(
        session,
        masses,
        {name: _SCALE_ERROR * mass for name, mass in masses.items()},
        DemoTruth(truth, _DIMENSION, _ROUGHNESS),
    )


def _record_hits(bench: TwoBodyBench) -> Recording:
    screen = Screen(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=screen, disable=not screen.is_terminal) as bar:
        length = bench.samples / bench.sample_rate
        task = bar.add_task(f"recording {bench.hits} hits", total=length)
        source = ChassisSource(bench, samples=bench.samples)
        return record(
            source, on_block=lambda seconds: bar.update(task, completed=seconds)
        )


def _measure_face(folder: Path, face: str, seed: int) -> Surface:
    """Measure a surface, export it as the instrument does, and import that file."""
    number = 2 * seed + ("a", "b").index(face)
    truth = rough_map(
        _MAP_ROWS,
        _MAP_COLUMNS,
        spacing=_MAP_SPACING,
        dimension=_DIMENSION,
        roughness=_ROUGHNESS,
        seed=number,
    )
    measured = measure_areal(truth, Profilometer(missing=1e-4), seed=number)
    path = folder / f"face-{face}.csv"
    write_keyence_csv(measured, path)
    return read_surface(path)


def _weigh(truth: BenchTruth, seed: int) -> dict[str, float]:
    error = 1 + _SCALE_ERROR * np.random.default_rng([seed, 9]).standard_normal(2)
    return {"base": float(truth.m1 * error[0]), "top": float(truth.m2 * error[1])}
