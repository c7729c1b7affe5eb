# SPDX-License-Identifier: MIT
"""Forces at several joints at once, compared with solve_ivp."""

from dataclasses import replace

import gap_bench as made
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.nonlinear_effects import (
    CUBIC,
    JENKINS,
    NONLINEAR,
)
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.dry_friction import follow_switch
from jointbench.analysis.gap.response.effect_hooks import Law, LumpedEffect
from jointbench.analysis.gap.response.port_forces import (
    PortLaw,
    PortModes,
    filled_lanes,
    port_forces,
)
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.second_method.verify import second_response

TRAVEL = {"ground": 4.1e-5, "joint": 1.8e-5}  # [m], at the hardest hit
STIFFNESS = {"ground": made.NOMINAL["k0"], "joint": made.NOMINAL["kj"]}
SPEED = 0.07  # [m/s], of both
PEAK = slice(None, -64)


def values_of(name: str, link: str) -> list[float]:
    """Return parameters of a typical size at a link."""
    k, t = STIFFNESS[link], TRAVEL[link]
    return {
        "cubic_stiffness": [0.3 * k / t**2],
        "quadratic_stiffness": [0.3 * k / t],
        "gap": [0.3 * k, 0.2 * t],
        "jenkins": [0.3 * k, 0.2 * t, 14.0],
        "iwan": [0.3 * k, 0.6 * t, 0.5, 14.0],
        "bouc_wen": [0.3 * k, 0.3 * t, 1.5, 1.8],
        "coulomb": [0.05 * k * t, 0.003 * SPEED],
        "quadratic_damping": [0.6 * k * t / SPEED],
        "maxwell": [0.3 * k, 8e-4],
    }[name]


def bench_of(records: list[int]) -> LumpedBench:
    """Return hits without a response on a model with two joints."""
    campaign = made.quiet_campaign(samples=288)
    links = tuple(replace(link, joint=True) for link in campaign.model.links)
    rows = ("force", "response", "hit", "level", "preload", "order")
    few = {name: getattr(campaign, name)[records] for name in rows}
    return make_bench(
        replace(campaign, model=replace(campaign.model, links=links), **few)
    )


def apart(
    first: str, second: str, *, oversampling: int, points: int = 16
) -> tuple[float, float]:
    """Return the largest and the RMS difference from solve_ivp, of the response.

    Args:
        first: effect at the ground.
        second: effect at the joint.
        oversampling: steps per sample.
        points: of solve_ivp per sample.
    """
    bench = bench_of([2])
    model = bench.campaign.model
    terms = [
        made.term_of(bench, name, f"link:{link}", values_of(name, link))
        for name, link in ((first, "ground"), (second, "joint"))
    ]
    actions = bench.actions(terms)
    args = model, model.nominal, bench.excitation, actions
    reference = second_response(*args, tolerance=1e-8, points=points)[..., PEAK]
    away = respond(*args, oversampling=oversampling)[..., PEAK] - reference
    peak = np.abs(reference).max(axis=-1, keepdims=True)
    rms = np.linalg.norm(away, axis=-1) / np.linalg.norm(reference, axis=-1)
    return float(np.abs(away / peak).max()), float(rms.max())


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("cubic_stiffness", "quadratic_damping"),
        ("gap", "cubic_stiffness"),
        ("jenkins", "gap"),
        ("bouc_wen", "jenkins"),
        ("maxwell", "cubic_stiffness"),
    ],
)
def test_two_joints_agree_with_another_integrator(first: str, second: str) -> None:
    """Within 1e-4 of the peak; one after the other they are off by some percent.

    The steps are those of the engine; seen: 1.2e-5 at most.
    """
    assert apart(first, second, oversampling=8)[0] < 1e-4


def test_dry_friction_at_two_joints_agrees_with_another_integrator() -> None:
    """A switch is followed within its step: seen 2e-5 of the peak at 8 a sample."""
    assert apart("coulomb", "coulomb", oversampling=8, points=128)[0] < 4e-5


@pytest.mark.parametrize("drift", [0.3, 1.5])
def test_a_switch_of_dry_friction_is_followed_to_its_end(drift: float) -> None:
    """Speed and impulse of a step against solve_ivp, with rest at its end and without.

    The speed starts at -0.4 and the force alone would change it by 1.
    """
    width, growth = 0.01, 0.2
    force, mean, first, second = follow_switch(1.0, width, -0.4, drift, growth, 1.0)

    def rate(t: float, y: FloatArray) -> list[float]:
        own = float(np.tanh(y[0] / width))
        middle = t - 0.5
        return [drift + growth * middle - own, own, own * middle, own * middle**2]

    run = solve_ivp(rate, (0, 1), [-0.4, 0, 0, 0], rtol=1e-9, max_step=1e-3)
    expected = [np.tanh(run.y[0, -1] / width), *run.y[1:, -1]]
    assert np.allclose([force, mean, first, second], expected, atol=1e-4)


def test_dry_friction_beside_a_spring_that_runs_away_raises_nothing() -> None:
    """A search meets such springs: the response is not finite, and is rejected."""
    bench = bench_of([2])
    rub = made.term_of(bench, "coulomb", "link:ground", values_of("coulomb", "ground"))
    soft = made.term_of(bench, "cubic_stiffness", "link:joint", [-1e19])
    with np.errstate(all="ignore"):
        found = bench.response(np.zeros(6), [rub, soft])
    assert not np.isfinite(found).all()


@pytest.mark.parametrize("name", ["iwan", "coulomb", "quadratic_damping"])
def test_a_second_law_without_amplitude_changes_nothing(name: str) -> None:
    """One joint is the special case of several, whatever the order of the effects."""
    bench = bench_of([0, 2])
    own = made.term_of(bench, name, "link:joint", values_of(name, "joint"))
    idle = made.term_of(bench, "cubic_stiffness", "link:ground", [0.0])
    alone, both, turned = (
        bench.response(np.zeros(6), terms)
        for terms in ([own], [idle, own], [own, idle])
    )
    assert np.abs(both - alone).max() < 1e-9 * np.abs(alone).max()
    assert np.array_equal(both, turned)


MASS = np.array([3.0, 2.0, 1.0])
SPRING = np.array([2e7, 3e7, 1.5e7])
DASHPOT = np.array([200.0, 150.0, 90.0])
OPEN = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
"""Elongation of three links in a row, the first to the ground."""


def chain_modes(ports: FloatArray) -> PortModes:
    """Return the modes of three bodies in a row between ports, by an eigensolver."""
    stiffness, damping = (OPEN.T @ (v[:, None] * OPEN) for v in (SPRING, DASHPOT))
    state = np.zeros((6, 6))
    state[:3, 3:] = np.eye(3)
    state[3:, :3], state[3:, 3:] = (-x / MASS[:, None] for x in (stiffness, damping))
    poles, right = np.linalg.eig(state)
    push = np.concatenate([np.zeros_like(ports.T), ports.T / MASS[:, None]])
    up = poles.imag > 0
    inputs, shapes = 2 * np.linalg.solve(right, push)[up], (ports @ right[:3]).T[up]
    return PortModes(poles[up][:, None], inputs[..., None], shapes[..., None])


def law_of(effect: LumpedEffect, *values: float) -> Law:
    """Return the law of an effect."""
    assert effect.law is not None
    return effect.law(np.array(values))


def _named(name: str) -> LumpedEffect:
    return next(entry for entry in NONLINEAR if entry.name == name)


def test_a_model_given_by_its_modes_needs_no_bodies() -> None:
    """Three ports, one of them between the outer bodies, to 1e-4 of solve_ivp."""
    ports = np.array([OPEN[0], OPEN[2], [-1.0, 0.0, 1.0]])
    modes, dt, count = chain_modes(ports), 1 / 262144, 2048
    time, turn = dt * np.arange(count), 2 * np.pi * np.array([[700.0], [400.0]])
    size, k3, kt, slip = 2e-5, 2e16, 4e6, 6e-6

    def linear(t: FloatArray) -> FloatArray:
        x = size * np.sin(turn * t) ** 2
        return np.stack([*x, x[1] - x[0]])

    def forces(r: FloatArray, z: FloatArray) -> FloatArray:
        return np.stack([k3 * r[0] ** 3, kt * (slip * z - r[1]), k3 / 2 * r[2] ** 3])

    def rate(t: float, y: FloatArray) -> FloatArray:
        r = linear(np.array([t]))[:, 0] + ports @ y[:3]
        v = size * turn[1, 0] * np.sin(2 * turn[1, 0] * t) + (ports @ y[3:6])[1]
        inner = OPEN.T @ (SPRING * (OPEN @ y[:3]) + DASHPOT * (OPEN @ y[3:6]))
        contracting = ports.T @ forces(r, y[6])
        bend = 0.5 * (1 + np.sign(v * y[6])) * np.abs(y[6]) ** 8
        return np.concatenate(
            [y[3:6], (-inner - contracting) / MASS, [v / slip * (1 - bend)]]
        )

    laws = [
        PortLaw(0, law_of(CUBIC, k3)),
        PortLaw(1, law_of(JENKINS, kt, slip, 8.0)),
        PortLaw(2, law_of(CUBIC, 0.5 * k3)),
    ]
    motions = np.zeros((1, 3, count, filled_lanes(1)))
    motions[0, :, :, 0] = linear(time)
    fine, half = port_forces(motions, modes, dt, laws, extrapolated=True)
    assert half is not None
    found = (4 * fine[:, ::2, 0] - half[:, :, 0]) / 3
    run = solve_ivp(
        rate,
        (0, time[-1]),
        np.zeros(7),
        rtol=1e-8,
        atol=1e-13,
        max_step=1e-4,
        t_eval=time[::2],
    )
    expected = forces(linear(time[::2]) + ports @ run.y[:3], run.y[6])
    away = np.abs(found - expected).max(axis=1)
    assert np.all(away < 1e-4 * np.abs(expected).max(axis=1)), away


def test_laws_at_ports_that_the_modes_lack_are_refused() -> None:
    """The message gives the ports, the laws, and what to do."""
    modes = chain_modes(OPEN[:1])
    still = np.zeros((1, 1, 8, filled_lanes(1)))
    with pytest.raises(UsageError, match="ports \\[1\\] of modes with 1 ports"):
        port_forces(
            still, modes, 1e-5, [PortLaw(1, law_of(CUBIC, 1.0))], extrapolated=False
        )
    with pytest.raises(UsageError, match="depends on the speed"):
        port_forces(
            still,
            modes,
            1e-5,
            [PortLaw(0, law_of(_named("coulomb"), 1.0, 1e-3))],
            extrapolated=False,
        )
