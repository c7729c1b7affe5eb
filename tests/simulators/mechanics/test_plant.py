"""The time-stepped plant against closed forms and an independent integrator."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.mechanics.plant import (
    GROUND,
    Plant,
    PlantLink,
    plant_matrices,
    plant_modes,
    two_bodies,
)
from jointbench.simulators.mechanics.plant_integration import PlantState, step_plant

BENCH = two_bodies(m1=9.0, m2=4.6, k0=2.2e7, c0=320.0, kj=6.0e7, cj=240.0)


def test_one_body_has_the_frequency_and_damping_of_its_closed_form():
    """The pole of m x'' + c x' + k x is known exactly."""
    modes = plant_modes(Plant((2.0,), (PlantLink(GROUND, 0, 8.0e6, 80.0),)))
    assert_allclose(modes.natural_frequency, [2000 / (2 * np.pi)], rtol=1e-12)
    assert_allclose(modes.damping_ratio, [80 / (2 * 2.0 * 2000)], rtol=1e-12)


def test_two_bodies_have_the_roots_of_the_characteristic_polynomial():
    """det(m s^2 + c s + k), multiplied out by hand, vanishes at every pole."""
    polynomial = np.polyadd(
        np.polymul([9.0, 320.0 + 240.0, 8.2e7], [4.6, 240.0, 6.0e7]),
        -np.polymul([240.0, 6.0e7], [240.0, 6.0e7]),
    )
    roots = np.roots(polynomial)
    expected = np.sort(np.abs(roots[roots.imag > 0])) / (2 * np.pi)
    assert_allclose(plant_modes(BENCH).natural_frequency, expected, rtol=1e-9)


def test_free_decay_of_one_body_follows_the_closed_form():
    """Started at 1 mm, the acceleration is the analytic damped cosine."""
    mass, omega, zeta = 2.0, 2000.0, 0.01
    plant = Plant(
        (mass,), (PlantLink(GROUND, 0, mass * omega**2, 2 * zeta * omega * mass),)
    )
    step = 1 / 131072
    time = step * np.arange(8192)
    acceleration, _ = step_plant(
        plant,
        np.zeros(2 * 8192 + 1),
        body=0,
        time_step=step,
        state=PlantState(0.0, np.array([1e-3, 0.0]), np.zeros((2, 0))),
    )
    pole = omega * (-zeta + 1j * np.sqrt(1 - zeta**2))
    # x = Re[A exp(p t)] with x(0) = 1e-3 and v(0) = 0, differentiated twice.
    amplitude = 1e-3 * (1 + 1j * pole.real / pole.imag)
    exact = (amplitude * pole**2 * np.exp(pole * time)).real
    # Runge-Kutta turns the phase by (omega h)^5 / 120 per step: 6e-8 in all here.
    assert_allclose(acceleration[0], exact, atol=1e-7 * np.abs(exact).max())


def test_forced_response_agrees_with_a_tight_adaptive_integrator():
    """A half-sine on the top: RK4 at eight steps a sample against DOP853."""
    step, steps, width = 1 / (8 * 16384), 4096, 0.8e-3

    def pulse(time):
        inside = (time >= 0) & (time <= width)
        return np.where(inside, 300 * np.sin(np.pi * time / width) ** 2, 0.0)

    mass, stiffness, damping = plant_matrices(BENCH)

    def rate(time, state):
        push = np.array([0.0, float(pulse(np.asarray(time)))])
        bent = np.linalg.solve(mass, push - stiffness @ state[:2] - damping @ state[2:])
        return np.concatenate((state[2:], bent))

    at = step * np.arange(steps)
    solution = solve_ivp(
        rate,
        (0, at[-1]),
        np.zeros(4),
        method="DOP853",
        t_eval=at,
        rtol=1e-10,
        atol=1e-14,
        max_step=1e-4,
    )
    exact = np.stack([rate(t, y)[2:] for t, y in zip(at, solution.y.T, strict=True)])
    acceleration, _ = step_plant(
        BENCH, pulse(step / 2 * np.arange(2 * steps + 1)), body=1, time_step=step
    )
    assert_allclose(acceleration.T, exact, atol=1e-6 * np.abs(exact).max())


def test_an_integration_in_two_parts_equals_one():
    """The state carries everything from one piece to the next."""
    force = np.zeros(401)
    force[:40] = 100.0
    whole, _ = step_plant(BENCH, force, body=1, time_step=1e-5)
    early, state = step_plant(BENCH, force[:201], body=1, time_step=1e-5)
    late, _ = step_plant(BENCH, force[200:], body=1, time_step=1e-5, state=state)
    assert np.array_equal(whole, np.hstack((early, late)))


def test_a_link_to_a_missing_body_is_refused():
    """The message names the bodies that exist."""
    with pytest.raises(UsageError, match=r"beyond 0\.\.0"):
        Plant((1.0,), (PlantLink(0, 1, 1.0, 1.0),))


def test_a_mass_of_zero_is_refused():
    """Nothing divides by a mass that is not there."""
    with pytest.raises(UsageError, match="must be positive"):
        Plant((0.0,), ())
