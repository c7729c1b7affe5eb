# SPDX-License-Identifier: MIT
"""Poles refined by nonlinear least squares."""

from collections.abc import Callable
from typing import Any

import numpy as np

from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.line_noise import roughness
from jointbench.signal.modal.refined_pole_covariance import refine_poles

LINES = np.arange(20.0, 1000.0, 0.5)
ALL = np.ones(LINES.size, bool)


def test_poles_a_tenth_of_a_width_off_are_brought_back(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Noise of 1e-6: back to 1e-4 of the half-power half-width."""
    truth = structure((200.0, 600.0), (0.01, 0.02), (1.0, -0.5))
    lines = lines_of(noisy_frf(truth, LINES, noise=1e-6, seed=0), ALL)
    start = truth.poles * 1.0 - 0.1 * truth.poles.real * (1.0 + 1.0j)
    found = refine_poles(lines, start, roughness(lines.response))
    width = np.abs(truth.poles.real)
    assert np.all(np.abs(start - truth.poles) > 0.1 * width)
    assert np.all(np.abs(found.pole - truth.poles) < 1e-4 * width)
    assert found.converged.all()


def test_a_rough_refinement_ends_within_a_standard_deviation(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """From 1 % of a half-width off, which is more than three."""
    truth = structure((200.0, 600.0), (0.01, 0.02), (1.0, -0.5))
    lines = lines_of(noisy_frf(truth, LINES, noise=1e-3, seed=5), ALL)
    start = truth.poles - 0.01 * truth.poles.real * (1.0 + 1.0j)
    noise = roughness(lines.response)
    whole = refine_poles(lines, start, noise)
    rough = refine_poles(lines, start, noise, rough=True)
    sd = np.sqrt(np.trace(whole.covariance, axis1=1, axis2=2))
    assert np.all(np.abs(start - whole.pole) > 3.0 * sd)
    assert np.all(np.abs(rough.pole - whole.pole) < 0.3 * sd)


def test_the_covariance_is_that_of_repeated_measurements(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Sixty noises: rms error over stated sd is 1 within three times 1/sqrt(2 120)."""
    truth = structure((300.0, 340.0), (0.02, 0.015))
    scores = []
    for seed in range(60):
        lines = lines_of(noisy_frf(truth, LINES, noise=0.02, seed=seed), ALL)
        found = refine_poles(lines, truth.poles, roughness(lines.response))
        error = found.pole - truth.poles
        sd = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
        scores.append(np.c_[error.real, error.imag] / sd)
    rms = np.sqrt(np.mean(np.square(scores), axis=(0, 1)))
    assert np.all(np.abs(rms - 1.0) < 0.2)


def test_inflation_shows_residuals_beyond_the_stated_noise(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Variances understated by 25: the factor is 25 within its own scatter."""
    truth = structure((300.0,), (0.02,))
    lines = lines_of(noisy_frf(truth, LINES, noise=0.02, seed=1), ALL)
    noise = roughness(lines.response)
    right = refine_poles(lines, truth.poles, noise)
    wrong = refine_poles(lines, truth.poles, noise / 25.0)
    assert right.inflation[0] < 2.0
    assert 15.0 < wrong.inflation[0] < 45.0


def test_a_pole_that_runs_away_is_put_back_and_flagged(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """One true pole, and one 5 half-widths beside a peak it would slide onto."""
    truth = structure((300.0, 306.0), (0.002, 0.002))
    lines = lines_of(noisy_frf(truth, LINES, noise=1e-4, seed=2), ALL)
    start = np.array([truth.poles[0], truth.poles[1] + 5j * abs(truth.poles[1].real)])
    found = refine_poles(lines, start, roughness(lines.response))
    assert found.converged.tolist() == [True, False]
    assert found.pole[1] == start[1]


def test_no_steps_keep_the_start_and_tell_its_covariance(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """For those who want the poles of LSCF as they are."""
    truth = structure((300.0,), (0.02,))
    lines = lines_of(noisy_frf(truth, LINES, noise=0.01, seed=3), ALL)
    start = truth.poles * 1.0001
    found = refine_poles(lines, start, roughness(lines.response), steps=0)
    assert found.pole[0] == start[0]
    assert np.all(np.diagonal(found.covariance[0]) > 0.0)
