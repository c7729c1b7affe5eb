"""Margins against closed forms: second-order terms, other sites, scatter of hits."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.simulators.detectability.base_refit import (
    project,
    refit_base,
    try_moves,
)
from jointbench.simulators.detectability.expected_margin import (
    expected_margin,
    margin_scale,
)
from jointbench.simulators.hidden.campaign_design import draw_design
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE, SAMPLE_RATE
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.sample_weights import sample_weights, weigh
from jointbench.simulators.measuring.hammer import Pulse

SCATTER = 0.0019


@pytest.fixture(scope="module")
def quiet():
    """A quiet small design without scatter."""
    return margin_scale(draw_design(21, grid="small", noise=0.025))


@pytest.fixture(scope="module")
def scattered():
    """The same specimen with scatter of the operator."""
    design = draw_design(21, grid="small", noise=0.025, hit_scatter=SCATTER)
    return margin_scale(design)


def test_a_delay_differs_from_a_low_pass_by_its_second_order_term(quiet):
    """At equal tau by (s tau)^2/2: second differences of the samples, and the pair.

    Differences of samples lose what lies near the Nyquist frequency, the pair of
    equal tau is one rival among many: the margin lies between them.
    """
    tau, view = 1e-6, quiet.view
    delay = HiddenEffect("delay", {"tau": tau, "dof": 1})
    low_pass = HiddenEffect("sensor_lowpass", {"fc": 1 / (2 * np.pi * tau), "dof": 1})
    second = np.zeros_like(view.responses)
    bends = np.diff(view.responses[:, 1], 2, axis=1)
    second[:, 1, 1:-1] = 0.5 * (tau * SAMPLE_RATE) ** 2 * bends
    pair = [sketch_responses(view.design, [each]) for each in (delay, low_pass)]
    low = float(np.sum(project(view, second) ** 2))
    high = float(np.sum(project(view, pair[0] - pair[1]) ** 2))
    margin = expected_margin(quiet, delay)
    assert margin.rival == "sensor_lowpass channel:a1"
    assert margin.rho > 100
    assert 0.9 * low < margin.margin < 1.02 * high


def test_a_small_mode_near_a_resonance_may_sit_on_either_body(quiet):
    """One resonance determines the product of mass and squared shape, not the body."""
    omega = 2 * np.pi * 1.02 * quiet.scales.frequency[0]
    mass = 4e-4
    parts = {"m": mass, "k": mass * omega**2, "c": 0.02 * mass * omega, "dof": 0}
    margin = expected_margin(quiet, HiddenEffect("hidden_mode", parts))
    assert margin.rival == "hidden_mode body:m2"
    assert margin.margin < 0.01 * margin.rho**2


def test_two_gains_are_distinguished_by_the_priors_of_the_masses_only(quiet):
    """A gain on one channel is minus that on the other, both masses changed.

    The cheapest way to scale all of the base by x costs x^2 times the sum of the
    squared inverse priors.
    """
    margin = expected_margin(
        quiet, HiddenEffect("gain_error", {"frac": 3e-3, "dof": 0})
    )
    inverse = 1 / np.array([0.003, 0.003, 0.05, 0.2, 0.1, 0.3])
    assert margin.rival == "gain_error channel:a1"
    assert_allclose(margin.margin, 3e-3**2 * np.sum(inverse**2), rtol=0.05)


def test_a_loosening_far_below_the_scatter_is_invisible(scattered):
    """At most its stiffness in units of the scatter, summed over the records."""
    loosening = HiddenEffect("loosening", {"frac": 6e-5})
    progress = np.array([c.progress for c in scattered.view.design.conditions])
    most = 6e-5 / SCATTER * np.sqrt(np.sum((progress - progress.mean()) ** 2))
    change = sketch_responses(scattered.view.design, [loosening])
    left = project(scattered.view, change - scattered.view.responses)
    assert_allclose(np.linalg.norm(left), most, rtol=0.1)
    assert expected_margin(scattered, loosening).margin < 0.01


def test_scatter_takes_little_of_a_delay(quiet, scattered):
    """It blurs size and stiffness of a record, neither of which is a delay."""
    delay = HiddenEffect("delay", {"tau": 1e-7, "dof": 1})
    without = expected_margin(quiet, delay).rho
    assert 0.5 * without < expected_margin(scattered, delay).rho < 1.05 * without


def test_whitening_is_the_inverse_root_of_the_covariance(quiet, scattered):
    """In the metric of a record's dense covariance, on one direction of scatter."""
    view = scattered.view
    zero = np.zeros_like(view.responses)
    weights = sample_weights(view.design, view.responses, zero, zero)
    white = weigh(weights, view.responses).reshape(len(view.responses), -1)
    noise = weigh(quiet.view.weights, view.responses).reshape(white.shape)
    square = np.sum(noise**2, axis=1)
    # Sherman and Morrison: r^T (N + s^2 r r^T)^-1 r = r^2 / (1 + s^2 r^2), r^2 over N.
    assert_allclose(
        np.sum(white**2, axis=1), square / (1 + SCATTER**2 * square), rtol=1e-6
    )


def test_noise_of_the_force_is_white_after_whitening(quiet):
    """Along the ringing of one sample of the force, of which the pulse has many."""
    view = quiet.view
    condition = view.design.conditions[0]
    step = 1 / SAMPLE_RATE
    sd = FORCE_NOISE * view.design.noise
    start = np.floor(condition.pulse.start / step) * step
    short = Pulse(start, step, sd * np.pi / 2, exponent=1.0)
    design = replace(view.design, conditions=(replace(condition, pulse=short),))
    rings = np.zeros_like(view.responses)
    rings[0] = view.weights.inverse[0] * sketch_responses(design)[0]
    along = rings / np.linalg.norm(rings)
    white = weigh(view.weights, along / view.weights.inverse).reshape(rings.shape)
    samples = int(np.ceil(max(c.pulse.width for c in view.design.conditions) / step))
    late = [np.roll(rings, k, axis=2) for k in range(samples)]
    forced = sum(float(np.sum(white * h)) ** 2 for h in late)
    assert forced > 0.2
    assert_allclose(float(np.sum(white**2)) + forced, 1.0, rtol=1e-3)


def test_a_refitted_base_is_at_the_minimum_of_its_cost(quiet):
    """Steps of full precision from there gain less than two percent."""
    relaxation = HiddenEffect("maxwell", {"k": 1.5e5, "tau": 3.5e-4})
    view = quiet.view
    responses = sketch_responses(view.design, [relaxation])
    fit = refit_base(view, responses)
    rows = []
    for unit in np.eye(6):
        sides = [
            try_moves(view, responses, fit.moves + sign * 1e-6 * unit, None).left
            for sign in (1, -1)
        ]
        rows.append((sides[0] - sides[1]) / 2e-6)
    step = np.linalg.lstsq(-np.stack(rows, axis=1), fit.left, rcond=None)[0]
    better = try_moves(view, responses, fit.moves + step, None)
    assert fit.cost < 1.02 * better.cost + 0.01
