# SPDX-License-Identifier: MIT
"""Forward models against another integrator, noise against its own statistics."""

from dataclasses import replace

import gap_bench as made
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.make_bench import force_time_gate, make_bench
from jointbench.analysis.gap.residuals.noise_models import (
    channel_sigma,
    whitening_basis,
)
from jointbench.analysis.gap.response.dynamic_stiffness import invert
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.response.slider_integration import slide, slider_tables


def integrate(k3: float) -> FloatArray:
    """Return both accelerations of the hardest hit by solve_ivp, shape (2, n)."""
    m1, m2, k0, c0, kj, cj = (
        made.NOMINAL[k] for k in ("m1", "m2", "k0", "c0", "kj", "cj")
    )

    def force(t: float) -> float:
        return float(1000.0 * np.exp(-0.5 * ((t - 0.008) / 2.5e-4) ** 2))

    def rate(t: float, x: FloatArray) -> list[float]:
        r, v = x[1] - x[0], x[3] - x[2]
        joint = kj * r + cj * v + k3 * r**3
        return [
            x[2],
            x[3],
            (joint - k0 * x[0] - c0 * x[2]) / m1,
            (force(t) - joint) / m2,
        ]

    time = np.arange(made.SAMPLES) / made.RATE
    run = solve_ivp(
        rate,
        (0, time[-1]),
        np.zeros(4),
        t_eval=time,
        rtol=1e-9,
        atol=1e-14,
        method="DOP853",
        max_step=2e-4,
    )
    return np.array([rate(t, x)[2:] for t, x in zip(time, run.y.T, strict=True)]).T


@pytest.mark.parametrize("k3", [0.0, 1.5e16])
def test_the_response_agrees_with_another_integrator(k3: float) -> None:
    """Linear and cubic joints within 5e-5 of the peak."""
    bench = make_bench(made.quiet_campaign())
    terms = [made.term_of(bench, "cubic_stiffness", "link:joint", [k3])] if k3 else []
    y = bench.response(np.zeros(6), terms, 8)[2]
    reference = integrate(k3)
    error = np.abs(y - reference)[:, :-64].max()
    assert error < 5e-5 * np.abs(reference).max()


@pytest.mark.parametrize("bodies", [1, 2, 3])
def test_the_inverse_holds_for_any_number_of_bodies(bodies: int) -> None:
    """The product with the matrix itself is one, at every record and line."""
    rng = np.random.default_rng(bodies)
    shape = (bodies, bodies, 4, 5)
    z = rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    product = np.einsum("ij...,jk...->ik...", z, invert(z))
    one = np.eye(bodies)[:, :, None, None]
    assert np.abs(product - one).max() < 1e-12


def test_noise_is_not_estimated_where_the_joint_diverges() -> None:
    """The bench keeps its noise at an effect that drives the joint apart."""
    bench = make_bench(made.made_campaign([]))
    term = made.term_of(bench, "cubic_stiffness", "link:joint", [-1e17])
    assert not np.isfinite(bench.response(np.zeros(6), (term,))).all()
    kept = bench.refine(np.zeros(6), (term,))
    assert np.array_equal(kept.noise.sigma, bench.noise.sigma)
    assert not kept.expanded


def test_a_delay_moves_the_response_by_whole_samples() -> None:
    """Two samples of delay are a shift by two rows."""
    bench = make_bench(made.quiet_campaign())
    late = made.term_of(bench, "delay", "channel:a1", [2 / made.RATE])
    plain = bench.response(np.zeros(6), ())
    moved = bench.response(np.zeros(6), (late,))
    size = np.abs(plain).max()
    assert np.abs(moved[:, 1, 2:] - plain[:, 1, :-2]).max() < 1e-6 * size
    assert np.array_equal(moved[:, 0], plain[:, 0])


def test_a_slider_loads_along_its_curve_and_unloads_elastically() -> None:
    """Loading saturates at 1; stepping back by d lowers u by d."""
    tables, tops = slider_tables(1.0, 0.0, 12.0)
    top, loading = slide(0.0, 0.0, 5.0, tables, tops)
    assert top == pytest.approx(1.0, abs=1e-4)
    back, _ = slide(top, loading, -0.5, tables, tops)
    assert back == pytest.approx(top - 0.5, abs=1e-9)


def test_a_slider_loads_again_along_its_loading_curve() -> None:
    """After unloading it continues from its point on the curve."""
    tables, tops = slider_tables(1.0, 0.0, 12.0)
    u, loading = slide(0.0, 0.0, 0.9, tables, tops)
    low, _ = state = slide(u, loading, -0.2, tables, tops)
    grid = np.linspace(0, 1, tables.shape[1]) * (tables.shape[1] - 1)
    curve = np.interp(low, grid / tops[1], tables[1]) + 0.2
    again, _ = slide(*state, 0.2, tables, tops)
    assert again == pytest.approx(np.interp(curve, grid / tops[0], tables[0]), rel=1e-9)


def test_many_small_steps_move_a_slider_as_far_as_one() -> None:
    """The state does not depend on the number of steps of a monotone path."""
    tables, tops = slider_tables(0.3, 0.9, 1.0)
    once, _ = slide(0.0, 0.0, 1.7, tables, tops)
    state = (0.0, 0.0)
    for _ in range(100):
        state = slide(*state, 0.017, tables, tops)
    assert state[0] == pytest.approx(once, rel=1e-9)


def test_white_noise_is_estimated_from_the_top_of_the_spectrum() -> None:
    """Within 2 % for 16 records, independent of the low-frequency residual."""
    rng = np.random.default_rng(5)
    time = np.arange(2048) / made.RATE
    tone = 3.0 * np.sin(2 * np.pi * 300 * time)
    residual = 0.2 * rng.standard_normal((16, 2, 2048)) + tone
    sigma = channel_sigma(residual, np.ones((16, 2)))
    assert sigma == pytest.approx(0.2 * np.ones((16, 2)), rel=0.02)


def test_whitening_leaves_unit_noise_along_a_strong_direction() -> None:
    """I + b b^T becomes the identity along b."""
    b = np.zeros((1, 50))
    b[0, :10] = 2.0
    basis, shrink = whitening_basis(b)
    unit = b[0] / np.linalg.norm(b)
    spread = np.sqrt(1 + np.sum(b**2))
    loud = spread * unit
    left = loud - basis.T @ (shrink * (basis @ loud))
    assert np.linalg.norm(left) == pytest.approx(1.0, rel=1e-9)


def test_the_prediction_without_force_is_zero() -> None:
    """No force, no response."""
    bench = make_bench(made.quiet_campaign())
    still = replace(bench.excitation, spectrum=0 * bench.excitation.spectrum)
    y = respond(bench.campaign.model, bench.theta(np.zeros(6)), still)
    assert not np.any(y)


def hits_with_ringing(noise: float) -> FloatArray:
    """Return forces of hits that ring for 30 samples on both sides, and noise [N]."""
    time = np.arange(2048) - 200.0
    ringing = 3e-3 * np.sinc(0.9 * time) * np.exp(-np.abs(time) / 5.0)
    pulse = np.exp(-((time / 5.0) ** 2)) + ringing
    drawn = np.random.default_rng(1).standard_normal((8, 2048))
    return np.outer([30, 100, 300, 1000] * 2, pulse) + noise * drawn


@pytest.mark.parametrize(("noise", "most"), [(2e-3, 48), (0.05, 24), (3.0, 8)])
def test_the_time_gate_of_a_noisy_force_is_narrow(noise: float, most: int) -> None:
    """It keeps the ringing of the filter that exceeds the noise, and little noise."""
    force = hits_with_ringing(noise)
    (first, last), sigma = force_time_gate(force)
    assert 200 - first <= most + 15
    assert last - 201 <= most + 15
    assert sigma == pytest.approx(noise, rel=0.05)
    outside = np.concatenate([force[:, :first], force[:, last:]], axis=1)
    assert np.mean(outside**2) < 1.05 * noise**2


def test_a_joint_that_warms_up_does_not_scatter() -> None:
    """Stiffness lost with the square of time, 0.3 % in all, bends but is a trend."""
    warming = -0.003 * np.linspace(0.0, 1.0, len(made.CONDITIONS)) ** 2
    bench, joint = make_bench(made.quiet_campaign()), np.eye(6)[3]
    clean = [
        bench.response(made.BASE + w * joint, [])[k] for k, w in enumerate(warming)
    ]
    records = np.stack(clean)
    records += 0.02 * np.random.default_rng(3).standard_normal(records.shape)
    mean = made.BASE + warming.mean() * joint
    found = make_bench(made.quiet_campaign(records)).refine(mean, ())
    assert found.noise.scatter.size[1] == 0.0
