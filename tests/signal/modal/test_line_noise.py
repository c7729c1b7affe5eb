# SPDX-License-Identifier: MIT
"""Noise of FRF lines."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.line_noise import line_noise, model_error, roughness

ONES = np.ones((1, 100), complex)
LINES = np.arange(1.0, 2000.0, 0.5)


def test_roughness_estimates_the_noise_of_a_resonant_frf(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """1 % noise: its mean variance over 4000 lines within 10 %."""
    truth = structure((300.0, 900.0), (0.02, 0.01))
    frf = noisy_frf(truth, LINES, noise=0.01, seed=0)
    clean = truth.response(LINES, 2)[0]
    variance = 1e-4 * np.mean(np.abs(clean) ** 2)
    assert roughness(frf.response[0]).mean() == pytest.approx(variance, rel=0.1)


def test_the_smaller_of_scatter_and_roughness_is_the_noise() -> None:
    """Aim moves residues alike on all lines: hits scatter, the FRF stays smooth."""
    rng = np.random.default_rng(3)
    noise = 0.1 * (rng.normal(size=(1, 4000)) + 1j * rng.normal(size=(1, 4000)))
    aim = line_noise(1.0 + noise, np.full((1, 4000), 0.25))
    assert aim.mean() == pytest.approx(0.02, rel=0.1)
    small = line_noise(1.0 + noise, np.full((1, 4000), 1e-4))
    assert small == pytest.approx(1e-4)


def test_no_line_is_ever_exact() -> None:
    """Silence and exact data still get a positive variance."""
    assert np.all(line_noise(ONES, None) > 0.0)
    assert np.all(line_noise(0.0 * ONES, None) > 0.0)


def test_the_model_error_is_what_noise_does_not_explain() -> None:
    """Residual of 3 % of the level beside noise of 1 %: 3 % within 5 %."""
    rng = np.random.default_rng(1)
    response = np.full((1, 20_000), 2.0 + 0j)
    parts = rng.normal(size=(2, 1, 20_000)) + 1j * rng.normal(size=(2, 1, 20_000))
    residual = (2.0 * 0.03 * parts[0] + 2.0 * 0.01 * parts[1]) / np.sqrt(2.0)
    noise = np.full((1, 20_000), 0.02**2)
    assert model_error(residual, noise, response) == pytest.approx(0.03, rel=0.05)
    assert model_error(residual, 100.0 * noise, response) == 0.0
