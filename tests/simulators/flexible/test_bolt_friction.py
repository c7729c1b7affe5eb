"""Friction of simulated bolts: along given paths, and in time, by other methods."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.bolt_friction import FIRST_TURNS, Yielding
from jointbench.simulators.flexible.closed_structure import ClosedStructure
from jointbench.simulators.flexible.friction_and_stops import (
    BoltLaw,
    PortLawKind,
    forces_along,
    law_bank,
)
from jointbench.simulators.flexible.gauss_integration import HitSet, integrate_hits

PHI = 2e-6
CURVES = [
    (Yielding.RICHARD_ABBOTT, 0.8),
    (Yielding.RICHARD_ABBOTT, 6.0),
    (Yielding.CONTACT, 1.3),
    (Yielding.CONTACT, 3.0),
]
MASS, DAMPING, STIFFNESS = 0.7, 40.0, 1e7


def law(way: Yielding, exponent: float, unloading: float = 0.0) -> BoltLaw:
    """Return a law with half the stiffness of the oscillator."""
    numbers = 0.5 * STIFFNESS, PHI, float(way), exponent, unloading
    return BoltLaw(PortLawKind.FRICTION, np.ones(1), numbers)


def sums(one: BoltLaw, path: FloatArray) -> FloatArray:
    """Return S along a path [m]."""
    return forces_along(one, path) / one.parameters[0] + path


def weaker(way: Yielding, exponent: float, phi: FloatArray) -> FloatArray:
    """Return the share of the stiffness of sliders that slip before phi [m]."""
    x = phi / PHI
    if way is Yielding.RICHARD_ABBOTT:
        return 1.0 - (1.0 + x**exponent) ** (-1.0 / exponent - 1.0)
    return 1.0 - np.maximum(1.0 - x / exponent, 0.0) ** (exponent - 1.0)


def slider_ensemble(way: Yielding, exponent: float) -> tuple[FloatArray, FloatArray]:
    """Return slips [m] and weights of many sharp sliders with the same loading."""
    edges = np.concatenate([[0.0], PHI * np.geomspace(1e-5, 1e4, 6001)])
    if way is Yielding.CONTACT:
        edges = PHI * exponent * np.linspace(0.0, 1.0, 6001)
    shares = weaker(way, exponent, edges)
    shares[-1] = 1.0
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(shares)


def wandering(count: int) -> FloatArray:
    """Return a path with loops in loops [m]."""
    rng = np.random.default_rng(4)
    turns = PHI * rng.normal(0, 1.5, 40) * np.linspace(1.5, 0.3, 40)
    return np.interp(np.linspace(0, 40, count), np.arange(41), [0.0, *turns])


@pytest.mark.parametrize(("way", "exponent"), CURVES)
def test_curves_turn_as_an_ensemble_of_sharp_sliders(
    way: Yielding, exponent: float
) -> None:
    """Masing's rules with forgotten loops are Iwan's sliders, on any path."""
    path = wandering(801)
    slips, weights = slider_ensemble(way, exponent)
    stretch, right = np.zeros_like(slips), []
    for move in np.diff(path, prepend=0.0):
        stretch = np.clip(stretch + move, -slips, slips)
        right.append(float(weights @ stretch))
    assert_allclose(sums(law(way, exponent), path), right, atol=2e-4 * PHI)


@pytest.mark.parametrize(("exponent", "unloading"), [(1.0, 0.7), (3.5, 0.5)])
def test_bouc_and_wen_along_a_path(exponent: float, unloading: float) -> None:
    """Its equation over the motion, by an implicit Runge-Kutta method."""
    path = wandering(161)
    u, right = 0.0, []
    for before, after in zip([0.0, *path[:-1]], path, strict=True):
        sense = np.sign(after - before)

        def rate(_: float, y: FloatArray, sense: float = float(sense)) -> FloatArray:
            same = 1.0 if y[0] * sense >= 0 else -1.0
            held = np.abs(y) ** exponent * (unloading + (1 - unloading) * same)
            return np.asarray(sense * (1.0 - held) / PHI)

        reach = (0.0, abs(float(after - before)))
        solved = solve_ivp(rate, reach, [u], "Radau", rtol=1e-8, atol=1e-10)
        u = float(solved.y[0, -1])
        right.append(u * PHI)
    found = sums(law(Yielding.BOUC_WEN, exponent, unloading), path)
    assert_allclose(found, right, atol=2e-5 * PHI)


def test_many_turning_points_are_all_remembered() -> None:
    """A decaying motion closes no loop; then loading continues where it had stopped."""
    turns = 2 * PHI * (-1.0) ** np.arange(3 * FIRST_TURNS)
    turns *= np.linspace(1.0, 0.1, turns.size)
    one = law(Yielding.RICHARD_ABBOTT, 1.5)
    found = sums(one, np.concatenate([turns, [3 * PHI]]))
    assert found[-1] == pytest.approx(sums(one, np.array([3 * PHI]))[0])


def pulse(t: FloatArray) -> FloatArray:
    """Return a hammer blow of 1 ms [N], which slips far."""
    return np.where(t < 1e-3, 150 * np.sin(np.pi * np.clip(t, 0, 1e-3) / 1e-3) ** 2, 0)


def oscillator(one: BoltLaw, step: float, count: int) -> FloatArray:
    """Return the acceleration of an oscillator with a law [m/s^2]."""
    structure = ClosedStructure(
        np.array([[MASS]]),
        np.array([[DAMPING]]),
        np.array([[STIFFNESS]]),
        np.eye(1),
    )
    hits = HitSet(np.ones((1, 1)), lambda t: pulse(t)[None], np.ones((1, 1)))
    bank = law_bank((one,), 1)
    return integrate_hits(structure, hits, bank, steps=count, step=step)[0, 0]


def test_bouc_and_wen_in_time_as_by_radau() -> None:
    """An oscillator whose spring yields, within 1e-4 of the peak."""
    exponent, unloading = 1.7, 0.65
    step, count = 5e-6, 4000

    def rate(t: float, y: FloatArray) -> list[float]:
        q, v, u = (float(each) for each in y)
        same = 1.0 if u * v >= 0 else -1.0
        held = abs(u) ** exponent * (unloading + (1 - unloading) * same)
        force = pulse(np.array(t)) - DAMPING * v - STIFFNESS * q
        force -= 0.5 * STIFFNESS * (PHI * u - q)
        return [v, float(force) / MASS, v / PHI * (1.0 - held)]

    times = step * np.arange(count)
    solved = solve_ivp(
        rate,
        (0.0, float(times[-1])),
        [0.0, 0.0, 0.0],
        "Radau",
        t_eval=times,
        rtol=1e-8,
        atol=[1e-14, 1e-11, 1e-8],
        max_step=2e-5,
    )
    right = np.array([rate(t, y)[1] for t, y in zip(times, solved.y.T, strict=True)])
    found = oscillator(law(Yielding.BOUC_WEN, exponent, unloading), step, count)
    assert np.abs(found - right).max() < 1e-4 * np.abs(right).max()


@pytest.mark.parametrize(("way", "exponent"), CURVES)
def test_curves_in_time_as_many_sharp_sliders(way: Yielding, exponent: float) -> None:
    """Central differences over an ensemble of sliders, within 2e-4 of the peak."""
    step, count, parts = 5e-6, 2000, 8
    slips, weights = slider_ensemble(way, exponent)
    slips, weights = slips[weights > 1e-9], weights[weights > 1e-9]
    h = step / parts
    q, v, stretch, right = 0.0, 0.0, np.zeros_like(slips), []
    force = pulse(h * np.arange(count * parts + 1))
    a = 0.0
    for k in range(count * parts):
        if k % parts == 0:
            right.append(a)
        half = v + 0.5 * h * a
        move = h * half
        q += move
        stretch = np.clip(stretch + move, -slips, slips)
        held = 0.5 * STIFFNESS * (float(weights @ stretch) - q)
        a = (force[k + 1] - STIFFNESS * q - held - DAMPING * half) / MASS
        v = half + 0.5 * h * a
    found = oscillator(law(way, exponent), step, count)
    assert np.abs(found - right).max() < 2e-4 * np.abs(right).max()
