"""Every joint law in the stepper against an adaptive integrator at tight tolerance."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from jointbench.simulators.mechanics.joint_laws import JointLaw, LawKind
from jointbench.simulators.mechanics.plant import GROUND, Plant, PlantLink
from jointbench.simulators.mechanics.plant_integration import step_plant
from jointbench.simulators.mechanics.sliders import jenkins_bank

MASSES = np.array([9.0, 4.6])
LINKS = (PlantLink(GROUND, 0, 2.2e7, 320.0), PlantLink(0, 1, 5.0e7, 240.0))
STEP, STEPS, WIDTH = 1 / (16 * 16384), 5000, 0.8e-3
PEAK = 1000.0


def _pulse(time):
    phase = np.clip(time / WIDTH, 0, 1)
    return PEAK * np.sin(np.pi * phase) ** 2


def _reference(link_force, state_rate):
    """Accelerations of base and top from DOP853, the law written out by the test."""

    def rate(time, y):
        x, v, w = y[:2], y[2:4], y[4]
        r, drift = x[1] - x[0], v[1] - v[0]
        joint = 5.0e7 * r + 240.0 * drift + link_force(r, drift, w, time)
        ground = 2.2e7 * x[0] + 320.0 * v[0]
        bent = np.array([joint - ground, float(_pulse(time)) - joint]) / MASSES
        return np.concatenate((v, bent, [state_rate(drift, w)]))

    at = STEP * np.arange(STEPS)
    options = {"rtol": 1e-9, "atol": 1e-14, "max_step": 2e-5}
    # The law may have kinks: short steps, so that none is stepped over.
    out = solve_ivp(
        rate, (0, at[-1]), np.zeros(5), method="DOP853", t_eval=at, **options
    )
    return np.stack([rate(t, y)[2:4] for t, y in zip(at, out.y.T, strict=True)], axis=1)


def _no_state(_, __):
    return 0.0


def _jenkins_rate(v, w, kt=1.4e7, slip=30.0, n=12.0):
    loading = v * w > 0
    return kt * v * (1 - abs(w / slip) ** n if loading else 1.0)


def _bouc_wen_rate(v, w, n=1.5, b=0.6, g=-0.2, zy=4e-6):
    return v * (1 - abs(w / zy) ** n * (b * np.sign(v * w) + g))


CASES = {
    "cubic": (
        JointLaw(LawKind.ODD_POWER, 0, 1, (2e16, 3.0)),
        lambda r, v, w, t: 2e16 * r**3,
        _no_state,
    ),
    "square": (
        JointLaw(LawKind.SQUARE, 0, 1, (4e11,)),
        lambda r, v, w, t: 4e11 * r * r,
        _no_state,
    ),
    "root": (
        JointLaw(LawKind.ROOT, 0, 1, (4e4, 1e-6)),
        lambda r, v, w, t: 4e4 * r * (r * r + 1e-12) ** -0.25,
        _no_state,
    ),
    "stop": (
        JointLaw(LawKind.STOP, 0, 1, (2e7, 4e-6)),
        lambda r, v, w, t: 2e7 * max(r - 4e-6, 0),
        _no_state,
    ),
    "slot": (
        JointLaw(LawKind.SLOT, 0, 1, (2e7, 3e-6)),
        lambda r, v, w, t: 2e7 * np.sign(r) * max(abs(r) - 3e-6, 0),
        _no_state,
    ),
    "coulomb": (
        JointLaw(LawKind.COULOMB, 0, 1, (5.0, 2e-3)),
        lambda r, v, w, t: 5.0 * np.tanh(v / 2e-3),
        _no_state,
    ),
    "square damping": (
        JointLaw(LawKind.SQUARE_DAMPING, 0, 1, (1e4,)),
        lambda r, v, w, t: 1e4 * v * abs(v),
        _no_state,
    ),
    "dead zone damping": (
        JointLaw(LawKind.DEAD_ZONE_DAMPING, 0, 1, (900.0, 5e-6)),
        lambda r, v, w, t: 900.0 * v * (1 - 1 / (1 + (r / 5e-6) ** 8)),
        _no_state,
    ),
    "drift": (
        JointLaw(LawKind.DRIFT, 0, 1, (5e6, 0.02)),
        lambda r, v, w, t: 5e6 * r * t / 0.02,
        _no_state,
    ),
    "maxwell": (
        JointLaw(LawKind.MAXWELL, 0, 1, (2e7, 1.2e-4)),
        lambda r, v, w, t: w,
        lambda v, w: 2e7 * v - w / 1.2e-4,
    ),
    "bouc-wen": (
        JointLaw(LawKind.BOUC_WEN, 0, 1, (1.5e7, 1.5, 0.6, -0.2, 4e-6)),
        lambda r, v, w, t: 1.5e7 * w,
        _bouc_wen_rate,
    ),
    "slider": (
        JointLaw(
            LawKind.SLIDERS,
            0,
            1,
            sliders=jenkins_bank(kt=1.4e7, slip_force=30.0, sharpness=12.0),
        ),
        lambda r, v, w, t: w,
        _jenkins_rate,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_law_moves_the_bodies_as_an_adaptive_integrator_says(name):
    """Within 1e-5 of the peak over 19 ms, kinks and reversals included."""
    law, link_force, state_rate = CASES[name]
    exact = _reference(link_force, state_rate)
    plant = Plant(tuple(MASSES), LINKS, (law,))
    force = _pulse(STEP / 2 * np.arange(2 * STEPS + 1))
    acceleration, _ = step_plant(plant, force, body=1, time_step=STEP)
    assert_allclose(acceleration, exact, atol=1e-5 * np.abs(exact).max())


@pytest.mark.parametrize("name", CASES)
def test_every_law_makes_a_difference(name):
    """The comparison above is not between two linear models."""
    law, _, _ = CASES[name]
    force = _pulse(STEP / 2 * np.arange(2 * STEPS + 1))
    plain, _ = step_plant(Plant(tuple(MASSES), LINKS), force, body=1, time_step=STEP)
    bent, _ = step_plant(
        Plant(tuple(MASSES), LINKS, (law,)), force, body=1, time_step=STEP
    )
    assert np.abs(bent - plain).max() > 1e-2 * np.abs(plain).max()


def test_a_law_to_the_ground_acts_on_one_body_only():
    """A cubic spring of no stiffness elsewhere: m a = -k3 x^3 at the first step."""
    law = JointLaw(LawKind.ODD_POWER, GROUND, 0, (3e15, 3.0))
    plant = Plant((2.0,), (), (law,))
    push = np.full(2001, 10.0)
    acceleration, state = step_plant(plant, push, body=0, time_step=1e-5)
    after, _ = step_plant(plant, push[:3], body=0, time_step=1e-5, state=state)
    assert_allclose(after[0, 0], (10.0 - 3e15 * state.values[0] ** 3) / 2.0)
    assert_allclose(acceleration[0, 0], 5.0)


def test_sliders_keep_their_state_between_integrations():
    """An integration in two parts equals one, hysteresis included."""
    law = CASES["slider"][0]
    plant = Plant(tuple(MASSES), LINKS, (law,))
    force = _pulse(STEP / 2 * np.arange(2 * 2000 + 1))
    whole, _ = step_plant(plant, force, body=1, time_step=STEP)
    early, state = step_plant(plant, force[:2001], body=1, time_step=STEP)
    late, _ = step_plant(plant, force[2000:], body=1, time_step=STEP, state=state)
    assert_allclose(np.hstack((early, late)), whole, rtol=0, atol=1e-9)
