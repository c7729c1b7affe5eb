# SPDX-License-Identifier: MIT
"""Residues of known poles."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.lsfd import fit_residues
from jointbench.signal.modal.modal_model import split_residues

LINES = np.arange(20.0, 1000.0, 0.5)
ALL = np.ones(LINES.size, bool)


@pytest.mark.parametrize("kind", list(FrfKind))
def test_residues_are_those_of_receptance_whatever_was_measured(
    structure: Callable[..., Any], kind: FrfKind
) -> None:
    """Exact data, 1e-7 of the largest residue."""
    truth = structure((120.0, 400.0, 800.0), (0.01, 0.02, 0.005), (1.0, -0.7, 0.5))
    lines = lines_of(Frf(LINES, truth.response(LINES, kind.derivatives), kind), ALL)
    fit = fit_residues(lines, truth.poles, np.abs(lines.response) ** 2)
    wanted = truth.residues().reshape(3, 1)
    assert np.abs(fit.residues() - wanted).max() < 1e-7 * np.abs(wanted).max()


def test_the_window_does_not_enter_the_residues(structure: Callable[..., Any]) -> None:
    """Measured at s = j omega + 40, fitted with the same s."""
    truth = structure((200.0,), (0.01,))
    s = 2j * np.pi * LINES + 40.0
    p, r = truth.poles[0], truth.residues()[0, 0, 0]
    response = (r / (s - p) + np.conj(r) / (s - np.conj(p)))[None, None]
    frf = Frf(LINES, response, FrfKind.RECEPTANCE, added_decay_rate=40.0)
    fit = fit_residues(lines_of(frf, ALL), truth.poles, np.ones((1, LINES.size)))
    assert fit.residues()[0, 0] == pytest.approx(r, rel=1e-8)


def test_residual_terms_take_up_modes_beyond_the_band(
    structure: Callable[..., Any],
) -> None:
    """Modes at 2 and 1800 Hz, lines from 20 to 1000 Hz: residue within 1e-4."""
    truth = structure((2.0, 400.0, 1800.0), (0.05, 0.01, 0.02))
    lines = lines_of(Frf(LINES, truth.response(LINES, 2), FrfKind.ACCELERANCE), ALL)
    fit = fit_residues(lines, truth.poles[1:2], np.ones((1, LINES.size)))
    assert fit.residues()[0, 0] == pytest.approx(truth.residues()[1, 0, 0], rel=1e-4)


def test_significance_is_the_chi_squared_lost_without_the_mode(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Compared with the rise of the weighted residual when the mode is left out."""
    truth = structure((200.0, 600.0), (0.02, 0.03), (1.0, 0.05))
    frf = noisy_frf(truth, LINES, noise=0.05, seed=0)
    lines, variance = lines_of(frf, ALL), np.full((1, LINES.size), 1e-2)
    both = fit_residues(lines, truth.poles, variance)
    one = fit_residues(lines, truth.poles[:1], variance)
    lost = [
        np.sum(2.0 * np.abs(lines.response - f.synthesis) ** 2 / variance)
        for f in (one, both)
    ]
    assert both.significance[1] == pytest.approx(lost[0] - lost[1], rel=1e-6)


def test_a_rank_one_residue_splits_into_shape_and_participation() -> None:
    """Shape with largest component 1; their product is the residue."""
    shape, drive = np.array([0.5, -2.0, 1.0]), np.array([0.3, 0.1j])
    shapes, participation = split_residues(np.outer(shape, drive)[None])
    assert shapes[0] == pytest.approx([-0.25, 1.0, -0.5])
    assert np.allclose(np.outer(shapes[0], participation[0]), np.outer(shape, drive))


def test_a_mass_below_and_a_compliance_above_the_band_are_residual_terms(
    structure: Callable[..., Any],
) -> None:
    """A free body of 5 kg and a mode at 4 kHz leave the mode of the band as it is."""
    truth = structure((400.0, 4000.0), (0.01, 0.01))
    s = 2j * np.pi * LINES
    response = truth.response(LINES, 0) + (1.0 / 5.0) / s**2
    lines = lines_of(Frf(LINES, response, FrfKind.RECEPTANCE), ALL)
    noise = np.full((1, LINES.size), 1e-20)
    fit = fit_residues(lines, truth.poles[:1], noise)
    assert np.allclose(fit.synthesis, lines.response, rtol=1e-6)
    assert fit.residues()[0, 0] == pytest.approx(truth.residues()[0, 0, 0], rel=1e-6)


def test_real_modes_have_imaginary_residues_and_the_same_synthesis(
    structure: Callable[..., Any],
) -> None:
    """A proportionally damped structure: nothing is lost, real parts are exactly 0."""
    truth = structure((200.0, 600.0), (0.01, 0.02), (1.0, -0.4))
    lines = lines_of(Frf(LINES, truth.response(LINES, 2), FrfKind.ACCELERANCE), ALL)
    noise = np.ones((1, LINES.size))
    fit = fit_residues(lines, truth.poles, noise, real_modes=True)
    assert not np.any(fit.residues().real)
    assert np.allclose(fit.residues()[:, 0], truth.residues()[:, 0, 0], rtol=1e-6)
    assert np.allclose(fit.synthesis, lines.response, rtol=1e-6)


def test_a_complex_mode_forced_to_be_real_is_missed_in_part(
    structure: Callable[..., Any],
) -> None:
    """A residue turned by 0.3 rad: sin(0.3) = 30 % of it is left over at its peak."""
    truth = structure((400.0,), (0.01,))
    p, r = truth.poles[0], truth.residues()[0, 0, 0] * np.exp(0.3j)
    s = 2j * np.pi * LINES
    response = (r / (s - p) + np.conj(r) / (s - np.conj(p)))[None, None]
    lines = lines_of(Frf(LINES, response, FrfKind.RECEPTANCE), ALL)
    noise = np.ones((1, LINES.size))
    fit = fit_residues(lines, truth.poles, noise, real_modes=True)
    peak = int(np.argmax(np.abs(lines.response[0])))
    missed = np.abs(fit.synthesis - lines.response)[0, peak]
    assert missed / np.abs(lines.response[0, peak]) > 0.2
