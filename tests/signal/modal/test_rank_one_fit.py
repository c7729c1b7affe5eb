# SPDX-License-Identifier: MIT
"""Modes of rank one fitted to the lines around a peak."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.modal.residual_search import rank_one_fit
from jointbench.signal.modal.residual_search.peak_sums import PeakLines, sums_of_slopes
from jointbench.signal.modal.residual_search.rank_one_fit import (
    covariance,
    fit_rank_one,
)

POLES: ComplexArray = np.array([-3.0 + 625.0j, -4.0 + 630.0j])
REFERENCES = np.array([[1.0, 0.4 - 0.2j, 0.3], [-0.5, 1.0, 0.2 + 0.1j]], np.complex128)
STEP: ComplexArray = np.array([1.0j, -1.0 + 0.0j])
NOISE = 0.01


@pytest.fixture
def peak() -> PeakLines:
    """Return two modes within a half-power width, five outputs, three references."""
    rng = np.random.default_rng(1)
    shape = rng.normal(size=(2, 5)) + 0.1j * rng.normal(size=(2, 5))
    s = 2j * np.pi * np.linspace(95.0, 105.0, 60)
    response: ComplexArray = np.zeros((5, 3, s.size), complex)
    for pole, row, reference in zip(POLES, shape, REFERENCES, strict=True):
        residue = (row[:, None] * reference)[:, :, None]
        response += s**2 * (residue / (s - pole) + residue.conj() / (s - pole.conj()))
    sd = np.full(response.shape, NOISE * float(np.abs(response).max()))
    error = rng.normal(size=(2, *response.shape))
    noisy = np.asarray(response + sd * (error[0] + 1j * error[1]), np.complex128)
    return PeakLines(np.asarray(s, np.complex128), noisy, sd, 2, 3.5)


@pytest.mark.parametrize("moved", [-1.5, 0.5, 1.5])
def test_the_search_ends_at_one_optimum(peak: PeakLines, moved: float) -> None:
    """From starts up to a third of their distance away, and references turned."""
    best = fit_rank_one(peak, POLES, REFERENCES)
    turned = (REFERENCES * np.exp(0.3j * moved * np.arange(3))).astype(np.complex128)
    found = fit_rank_one(peak, POLES + moved * STEP, turned)
    assert found.cost == pytest.approx(best.cost, rel=1e-6)
    assert found.pole == pytest.approx(best.pole, abs=1e-3)


def test_two_modes_at_one_peak_come_out_at_the_noise(peak: PeakLines) -> None:
    """Chi-squared per value is one; the poles are the true ones."""
    found = fit_rank_one(peak, POLES + np.array([2.0j, -2.0j]), REFERENCES)
    assert found.cost / (2.0 * peak.response.size) == pytest.approx(1.0, abs=0.1)
    assert found.pole == pytest.approx(POLES, abs=0.1)


def test_sums_in_place_of_slopes_end_at_the_same_optimum(
    peak: PeakLines, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A limit as of a large measurement: no matrix of slopes."""
    start = POLES + np.array([2.0j, -2.0j])
    whole = fit_rank_one(peak, start, REFERENCES)
    monkeypatch.setattr(rank_one_fit, "_MOST_VALUES", 0)
    found = fit_rank_one(peak, start, REFERENCES)
    assert found.cost == pytest.approx(whole.cost, rel=1e-6)
    assert found.pole == pytest.approx(whole.pole, abs=1e-3)
    assert found.shape == pytest.approx(whole.shape, rel=1e-3, abs=1e-6)


def test_the_gradient_is_that_of_the_sum_of_squares(peak: PeakLines) -> None:
    """By differences over the poles, noise different from line to line."""
    rng = np.random.default_rng(2)
    uneven = replace(peak, sd=peak.sd * rng.uniform(0.5, 2.0, peak.sd.shape))
    start, pivot = POLES + 2.0 * STEP, np.argmax(np.abs(REFERENCES), axis=1)
    gradient = sums_of_slopes(uneven, start, REFERENCES, pivot)[1]
    for number, way in enumerate(([1, 0], [1j, 0], [0, 1], [0, 1j])):
        step = 1e-4 * peak.width * np.array(way)
        ends = [
            sums_of_slopes(uneven, start + sign * step, REFERENCES, pivot)[2]
            for sign in (-1, 1)
        ]
        slope = (ends[1] - ends[0]) / 2e-4
        assert 2.0 * gradient[number] == pytest.approx(slope, rel=1e-4)


def test_covariances_do_not_depend_on_where_the_search_begins(peak: PeakLines) -> None:
    """A reference whose other component comes out largest is scaled by that one."""
    best = fit_rank_one(peak, POLES, REFERENCES)
    turned = REFERENCES.copy()
    turned[:, [0, 1]] = turned[:, [1, 0]]
    found = fit_rank_one(peak, POLES, turned)
    assert np.abs(found.reference).max(axis=1) == pytest.approx([1.0, 1.0])
    for own, other in zip(covariance(peak, found), covariance(peak, best), strict=True):
        assert own == pytest.approx(other, rel=0.01, abs=1e-6 * np.abs(other).max())
