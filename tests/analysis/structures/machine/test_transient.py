"""Transients in complex modal coordinates against an independent integrator."""

import time
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.machine.complex_modes import PoleSet, solve_poles
from jointbench.analysis.structures.machine.loads import (
    Begin,
    HarmonicLoad,
    TableLoad,
)
from jointbench.analysis.structures.machine.transient import transient

RATES = 2 * np.pi * np.array([12.0, 31.0, 31.0, 55.0, 90.0, 160.0, 300.0, 520.0])
RNG = np.random.default_rng(5)
# Dampers between two points each: one is weak, one makes modes overdamped.
PORTS = RNG.standard_normal((2, 8))
DAMPING = PORTS.T @ np.diag([8.0, 900.0]) @ PORTS + 0.004 * np.diag(RATES)
ROWS = RNG.standard_normal((3, 8))
HARMONIC = (HarmonicLoad(0, 100.0, 100.0), HarmonicLoad(2, 280.0, 100.0, phase=0.7))
TABLE = TableLoad(
    1, np.array([0.0, 0.0003, 0.0111, 0.02]), np.array([5.0, 70.0, -30.0, 10.0])
)


@pytest.fixture(scope="module")
def poles() -> PoleSet:
    """Eight modes, two of them equal, with local dampers."""
    return solve_poles(RATES**2, DAMPING, ROWS, ROWS)


def integrated(knots: list[float], grid: np.ndarray) -> np.ndarray:
    """Return the outputs of an explicit Runge-Kutta method of order eight."""

    def slope(now: float, state: np.ndarray) -> np.ndarray:
        force = np.array(
            [
                100.0 * np.sin(100.0 * now),
                np.interp(now, TABLE.time, TABLE.force),
                280.0 * np.sin(100.0 * now + 0.7),
            ]
        )
        moved, speed = state[:8], state[8:]
        pushed = ROWS.T @ force - DAMPING @ speed - RATES**2 * moved
        return np.concatenate([speed, pushed])

    state, found = np.zeros(16), [np.zeros(3)]
    for low, high in pairwise(knots):
        inside = grid[(grid > low + 1e-12) & (grid < high - 1e-12)]
        done = solve_ivp(
            slope,
            (low, high),
            state,
            method="DOP853",
            rtol=1e-11,
            atol=1e-16,
            t_eval=np.append(inside, high),
        )
        state = done.y[:, -1]
        found += [ROWS @ one for one in done.y[:8].T[: inside.size]]
        if np.abs(grid - high).min() < 1e-12:
            found.append(ROWS @ state[:8])
    return np.array(found).T


def test_harmonic_loads_and_a_table_agree_with_an_integrator(poles: PoleSet) -> None:
    """Local dampers, overdamped poles, points of the table between samples."""
    time_, motion = transient(poles, [*HARMONIC, TABLE], duration=0.03, step=1e-3)
    wanted = integrated([0.0, 0.0003, 0.0111, 0.02, 0.03], time_)
    assert (~poles.oscillates).sum() >= 2
    assert np.abs(motion - wanted).max() < 1e-8 * np.abs(wanted).max()


def test_the_steady_state_begins_as_it_goes_on(poles: PoleSet) -> None:
    """A period later it is the same; a constant table is at its static value."""
    period = 2 * np.pi / 100.0
    loads = [*HARMONIC, TableLoad(1, np.array([0.0, 1.0]), np.array([50.0, 50.0]))]
    _, motion = transient(
        poles, loads, duration=3 * period, step=period / 64, begin=Begin.STEADY
    )
    assert motion[:, :64] == pytest.approx(motion[:, 128:192], rel=1e-9, abs=1e-12)
    static = ROWS @ (ROWS[1] * 50.0 / RATES**2)
    assert motion[:, :64].mean(axis=1) == pytest.approx(static, rel=1e-9)


def test_poles_left_out_respond_statically(poles: PoleSet) -> None:
    """Receptance at low frequency, and a slow transient, hardly change."""
    few = poles.lowest(poles.poles.size - 2)
    line = np.array([2.0])
    assert few.receptance(line) == pytest.approx(poles.receptance(line), rel=1e-4)
    slow = [HarmonicLoad(0, 100.0, 10.0)]
    _, all_of = transient(poles, slow, duration=2.0, step=1e-2)
    _, without = transient(few, slow, duration=2.0, step=1e-2)
    assert np.abs(all_of - without).max() < 1e-3 * np.abs(all_of).max()


def test_the_receptance_is_that_of_the_matrices(poles: PoleSet) -> None:
    """Against a solve line by line."""
    lines = np.array([5.0, 31.0, 200.0])
    for at, line in enumerate(lines):
        s = 2j * np.pi * line
        whole = np.diag(s**2 + RATES**2) + s * DAMPING
        wanted = ROWS @ np.linalg.solve(whole, ROWS.T)
        assert poles.receptance(lines)[:, :, at] == pytest.approx(wanted, rel=1e-9)


def test_a_minute_of_eighty_modes_takes_a_fifth_of_a_second() -> None:
    """60,001 samples at 1 ms; the second run, after compilation."""
    rates = 2 * np.pi * np.linspace(20.0, 3000.0, 80)
    rows = np.random.default_rng(1).standard_normal((3, 80))
    damping = rows.T @ np.diag([30.0, 300.0, 3000.0]) @ rows / 80
    damping += 0.004 * np.diag(rates)
    many = solve_poles(rates**2, damping, rows, rows)
    loads = [HarmonicLoad(axis, 100.0, 100.0) for axis in range(3)]
    transient(many, loads, duration=0.01, step=1e-3)
    taken = []
    for _ in range(3):  # the machine may be busy
        start = time.process_time()
        transient(many, loads, duration=60.0, step=1e-3)
        taken.append(time.process_time() - start)
    assert min(taken) < 0.2


def test_a_floating_structure_has_no_transient() -> None:
    """One line that names the remedy."""
    with pytest.raises(BadData, match="a body floats"):
        solve_poles(np.array([0.0, 1.0]), np.zeros((2, 2)), ROWS[:, :2], ROWS[:, :2])
