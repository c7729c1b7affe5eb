# SPDX-License-Identifier: MIT
"""Intervals hold the truth as often as they say, with modes beyond the band present."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.line_noise import residual_around
from jointbench.signal.modal.modes import ModalSettings, identify_modes

LINES = np.arange(0.0, 1200.0)
SETTINGS = ModalSettings(highest_order=16)


@pytest.mark.parametrize("noise", [0.1, 0.01])
def test_intervals_hold_the_truth_93_to_97_percent_of_the_time(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf], noise: float
) -> None:
    """Sixty noises, two modes, f and zeta: 240 draws; 95 give or take 3 sd of 1.4 %."""
    truth, held = structure((300.0, 700.0), (0.01, 0.02)), []
    for seed in range(60):
        m = identify_modes(
            noisy_frf(truth, LINES, noise=noise, seed=seed), SETTINGS
        ).model
        held.append(np.abs(m.natural_frequency - truth.frequency) / m.frequency_sd)
        held.append(np.abs(m.damping_ratio - truth.damping) / m.damping_ratio_sd)
    assert 0.91 < np.mean(np.array(held) < 1.96) < 0.99
    assert 0.85 < np.sqrt(np.mean(np.square(held))) < 1.15


def test_a_mode_just_beyond_the_band_biases_nothing_within(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """40 dB, a mode 5 Hz above the last line: only those within, each within 4 sd."""
    truth = structure((300.0, 700.0, 1205.0), (0.01, 0.02, 0.01))
    model = identify_modes(noisy_frf(truth, LINES, noise=0.01, seed=0)).model
    assert model.natural_frequency.size == 2
    score = (model.natural_frequency - truth.frequency[:2]) / model.frequency_sd
    assert np.all(np.abs(score) < 4.0)
    assert not model.systematic.any()


def test_residues_and_shapes_are_known_as_well_as_they_say(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Twenty noises, three outputs: rms error over sd is 1 within 20 %."""
    constant = np.array([[[1.0], [0.5], [-0.7]], [[0.4], [-1.0], [0.8]]])
    truth, residues, shapes = structure((300.0, 700.0), (0.01, 0.02), constant), [], []
    wanted = truth.residues()
    largest = np.argmax(np.abs(wanted[:, :, 0]), axis=1)[:, None]
    unit = np.take_along_axis(wanted[:, :, 0], largest, axis=1)
    for seed in range(20):
        frf = noisy_frf(truth, LINES, noise=0.02, seed=seed)
        m = identify_modes(frf, SETTINGS).model
        error = m.residues - wanted
        residues += [error.real / m.residues_sd.real, error.imag / m.residues_sd.imag]
        away, known = m.shapes - wanted[:, :, 0] / unit, m.shapes_sd.real > 0.0
        shapes += [away.real[known] / m.shapes_sd.real[known]]
    assert np.sqrt(np.mean(np.square(residues))) == pytest.approx(1.0, abs=0.2)
    assert np.sqrt(np.mean(np.square(shapes))) == pytest.approx(1.0, abs=0.2)


def test_white_residuals_as_large_as_stated_inflate_nothing(
    structure: Callable[..., Any],
) -> None:
    """Mean of 300 factors is 1 within 5 %: neither ratios nor chance count one way."""
    truth = structure((600.0,), (0.005,))
    lines = lines_of(
        Frf(LINES, truth.response(LINES, 2), FrfKind.ACCELERANCE),
        np.ones(LINES.size, bool),
    )
    factors = []
    for seed in range(300):
        parts = np.random.default_rng(seed).normal(size=(2, 1, LINES.size))
        noise = (parts[0] + 1j * parts[1]) / np.sqrt(2.0)
        factors.append(residual_around(lines, truth.poles, noise, np.ones(noise.shape)))
    left = 24.0 / 22.0
    assert np.mean(factors) == pytest.approx(left, abs=0.06)
