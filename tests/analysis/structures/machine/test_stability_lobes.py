"""The stability limit against closed forms and a simulated regenerative cut."""

import numpy as np
import pytest
from scipy.linalg import expm

from jointbench.analysis.structures.machine.stability_lobes import stability_lobes

STIFFNESS, MASS, RATIO, CUT = 1e7, 1.0, 0.03, 2e9
RATE = np.sqrt(STIFFNESS / MASS)
LINES = np.linspace(1.0, 3000.0, 20_000)
OMEGA = 2 * np.pi * LINES
RECEPTANCE = 1 / (STIFFNESS - MASS * OMEGA**2 + 2j * RATIO * RATE * MASS * OMEGA)


def test_the_limit_of_one_mode_is_that_of_tlusty() -> None:
    """2 k zeta (1 + zeta) / K_s, at omega_n sqrt(1 + 2 zeta)."""
    found = stability_lobes(LINES, RECEPTANCE, CUT, np.linspace(100.0, 600.0, 50))
    wanted = 2 * STIFFNESS * RATIO * (1 + RATIO) / CUT
    assert found.limit == pytest.approx(wanted, rel=1e-5)
    chatter = RATE / (2 * np.pi) * np.sqrt(1 + 2 * RATIO)
    assert found.frequency == pytest.approx(chatter, rel=2e-4)
    assert found.width.min() >= found.limit


def growth(width: float, speed: float) -> float:
    """Return by how much a simulated cut grows over forty turns."""
    turn = 250
    k = STIFFNESS + CUT * width
    state = np.array([[0, 1, 0], [-k, -2 * RATIO * RATE, CUT * width], [0, 0, 0]])
    step = expm(state / (speed * turn))
    wave, moved = [0.0] * turn, np.array([1e-9, 0.0])
    for _ in range(60 * turn):
        before = 0.5 * (wave[-turn] + wave[-turn + 1])
        wave.append(float(moved[0]))
        moved = step[:2, :2] @ moved + step[:2, 2] * before
    size = np.abs(np.array(wave).reshape(-1, turn)).max(axis=1)
    return float(size[-1] / size[20])


def test_a_simulated_cut_chatters_above_the_lobe_and_not_below() -> None:
    """A delayed simulation with its own integrator, 5 % to either side."""
    found = stability_lobes(LINES, RECEPTANCE, CUT, np.array([310.0]))
    width = float(found.width[0])
    assert growth(0.95 * width, 310.0) < 1.0 < growth(1.05 * width, 310.0)


def test_several_teeth_shift_the_lobes() -> None:
    """Four teeth at a speed are one tooth at four times the speed."""
    speed = np.linspace(100.0, 400.0, 20)
    one = stability_lobes(LINES, RECEPTANCE, CUT, 4 * speed)
    four = stability_lobes(LINES, RECEPTANCE, CUT, speed, teeth=4)
    assert four.width == pytest.approx(one.width)


def test_a_receptance_without_a_negative_real_part_never_chatters() -> None:
    """A spring and a damper."""
    found = stability_lobes(LINES, 1 / (1e7 + 10j * OMEGA), CUT, np.array([50.0]))
    assert found.limit == np.inf
    assert found.width[0] == np.inf


def test_at_low_speed_the_lobes_leave_no_room() -> None:
    """From three hundred lobes on, the limit is that of every speed."""
    found = stability_lobes(LINES, RECEPTANCE, CUT, np.array([0.01, 1.0, 400.0]))
    assert found.width[:2] == pytest.approx(found.limit)
    assert found.width[2] > 1.1 * found.limit
