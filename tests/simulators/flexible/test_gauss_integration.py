"""The integrator: energy, order, and the linear response by another method."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.closed_structure import ClosedStructure
from jointbench.simulators.flexible.draw_flexible_bench import draw_bench
from jointbench.simulators.flexible.faulty_sensors import sensor_rows
from jointbench.simulators.flexible.flexible_bench import (
    FlexibleBench,
    hit_set,
    structure_of,
)
from jointbench.simulators.flexible.gauss_integration import (
    HitSet,
    energy,
    integrate_hits,
    propagate,
)
from jointbench.simulators.flexible.hit_records import SAMPLE_RATE

SAMPLES = 640


@pytest.fixture(scope="module")
def bench() -> FlexibleBench:
    """Return a lap-jointed beam that slips at all bolts."""
    return draw_bench(7, kind="lap-beam", effects=["microslip"])


def short_hits(bench: FlexibleBench) -> HitSet:
    """Return three hits on the first torque, the strongest among them."""
    chosen = [h for h in bench.hits if h.torque == bench.torques[0] and not h.bad]
    chosen = sorted(chosen, key=lambda h: -h.level)[:3]
    rows = sensor_rows(bench.coordinates, bench.specimen, bench.effects)
    return hit_set(bench, chosen, rows)


def accelerations(bench: FlexibleBench, oversampling: int) -> FloatArray:
    """Return the records of the hits at whole samples."""
    structure, laws = structure_of(bench, bench.hits[0])
    found = integrate_hits(
        structure,
        short_hits(bench),
        laws,
        steps=SAMPLES * oversampling,
        step=1 / (oversampling * SAMPLE_RATE),
    )
    return found[:, :, ::oversampling]


def relative(found: FloatArray, right: FloatArray) -> float:
    """Return the largest difference over the peak of its record and channel."""
    peak = np.abs(right).max(axis=2, keepdims=True)
    return float(np.abs((found - right) / peak).max())


def undamped(structure: ClosedStructure) -> ClosedStructure:
    """Return a structure without damping."""
    return replace(structure, damping=np.zeros_like(structure.damping))


def test_an_undamped_structure_keeps_its_energy(bench: FlexibleBench) -> None:
    """Gauss collocation conserves quadratic invariants, at any step."""
    structure = undamped(structure_of(bench, bench.hits[0])[0])
    size = structure.mass.shape[0]
    state = np.random.default_rng(1).standard_normal((2 * size, 2))
    state[:size] *= 1e-4
    first = energy(structure, state)
    state = propagate(structure, state, step=2e-5, steps=1000)
    assert np.abs(energy(structure, state) / first - 1).max() < 1e-9


def test_the_work_of_the_hammer_is_the_energy_of_the_structure() -> None:
    """One mass on a spring: work of a half sine and energy after it agree."""
    mass, stiffness = 2.0, 2.0 * (2 * np.pi * 300) ** 2
    one = ClosedStructure(
        np.array([[mass]]), np.zeros((1, 1)), np.array([[stiffness]]), np.eye(1)
    )
    hits = HitSet(
        np.ones((1, 1)),
        lambda t: np.where(t < 1e-3, 100 * np.sin(np.pi * t / 1e-3), 0.0)[None],
        np.ones((1, 1)),
    )
    step = 1e-6
    found = integrate_hits(one, hits, None, steps=4000, step=step)[0, 0]
    velocity = np.cumsum(found) * step
    time = step * np.arange(4000)
    work = float(np.sum(hits.force(time)[0] * velocity) * step)
    peak = np.abs(velocity[2000:]).max()
    assert work == pytest.approx(0.5 * mass * peak**2, rel=2e-3)


def test_the_linear_part_converges_with_the_fourth_power(bench: FlexibleBench) -> None:
    """A step twice as long makes an error more than ten times as large."""
    linear = replace(bench, effects=())
    right = accelerations(linear, 8)
    errors = [relative(accelerations(linear, k), right) for k in (1, 2)]
    assert errors[0] / errors[1] > 10
    assert errors[1] < 1e-3


def test_slipping_bolts_converge_with_the_step(bench: FlexibleBench) -> None:
    """Half as many steps as a campaign takes change its records by 1e-4 at most."""
    right = accelerations(bench, 8)
    errors = [relative(accelerations(bench, k), right) for k in (2, 4)]
    assert errors[1] < 1e-4
    assert errors[1] < 0.3 * errors[0]


def test_the_linear_response_is_that_of_the_matrices(bench: FlexibleBench) -> None:
    """Another method: M s^2 + C s + K solved on a damped Laplace line."""
    linear = replace(bench, effects=())
    structure, _ = structure_of(linear, linear.hits[0])
    hits, oversampling = short_hits(linear), 8
    step = 1 / (oversampling * SAMPLE_RATE)
    count = SAMPLES * oversampling
    time = step * np.arange(count)
    shift = 16 / time[-1]
    force = np.fft.rfft(hits.force(time) * np.exp(-shift * time))
    omega = 2 * np.pi * np.fft.rfftfreq(count, step)
    load, rows = structure.lift.T @ hits.load, hits.sensors @ structure.lift
    spectrum = np.zeros((3, rows.shape[0], omega.size), dtype=complex)
    for k in np.flatnonzero(omega < 2 * np.pi * 40e3):
        s = shift + 1j * omega[k]
        matrix = structure.mass * s**2 + structure.damping * s + structure.stiffness
        motion = np.linalg.solve(matrix, load) * force[:, k]
        spectrum[:, :, k] = s**2 * (rows @ motion).T
    right = np.fft.irfft(spectrum, count) * np.exp(shift * time)
    found = accelerations(linear, oversampling)[:, :, : SAMPLES // 2]
    peak = np.abs(right).max()
    assert np.abs(found - right[:, :, ::8][:, :, : SAMPLES // 2]).max() < 2e-4 * peak
