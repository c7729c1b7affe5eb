# SPDX-License-Identifier: MIT
"""The band that is fitted."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.band import choose_band, force_nulls, null_words
from jointbench.signal.frf.frf import Frf, FrfKind

LINES = np.arange(0.0, 2000.0)


def made(response: np.ndarray, **more: Any) -> Frf:
    """Return a receptance with one output and one input."""
    return Frf(LINES, response[None, None], FrfKind.RECEPTANCE, **more)


def test_the_excited_band_is_taken_without_the_lines_at_dc() -> None:
    """0 to 1500 Hz excited: lines 3 to 1500."""
    keep, reason = choose_band(made(np.ones(2000, complex), usable_band=(0.0, 1500.0)))
    assert LINES[keep][[0, -1]].tolist() == [3.0, 1500.0]
    assert "excited" in reason


def test_drift_that_towers_over_the_resonances_is_left_out(
    structure: Callable[..., Any],
) -> None:
    """1/f^3 that equals the peak at 50 Hz: from there on."""
    response = structure((600.0,), (0.02,)).response(LINES, 0)[0, 0]
    peak = np.abs(response).max()
    drift = np.r_[0.0, peak * (50.0 / LINES[1:]) ** 3]
    keep, reason = choose_band(made(response + drift))
    assert LINES[keep][0] == pytest.approx(50.0, abs=4.0)
    assert "drift" in reason


def test_a_low_first_mode_with_a_high_static_level_is_not_drift(
    structure: Callable[..., Any],
) -> None:
    """Static receptance ten times the second peak, first mode in the lowest 2 %."""
    truth = structure((30.0, 1500.0), (0.02, 0.05), (1.0, 1.0))
    response = truth.response(LINES, 0)[0, 0]
    assert np.abs(response[1]) > 10.0 * np.abs(response[1000:]).max()
    assert LINES[choose_band(made(response))[0]][0] == 3.0


def test_the_band_ends_where_coherence_is_lost_for_good() -> None:
    """Dips pass, the end does not."""
    coherence = np.ones((1, 1, 2000))
    coherence[0, 0, 400:404] = 0.1
    coherence[0, 0, 1200:] = 0.2
    frf = made(np.ones(2000, complex), coherence=coherence, averages=5)
    keep, reason = choose_band(frf)
    assert LINES[keep][-1] == pytest.approx(1200.0, abs=2.0)
    assert "coherent" in reason
    assert LINES[choose_band(replace(frf, averages=2))[0]][-1] == 1999.0


def test_a_given_band_is_taken_as_it_is() -> None:
    """Whatever coherence and force say."""
    keep, _ = choose_band(made(np.ones(2000, complex)), (100.0, 300.0))
    assert LINES[keep][[0, -1]].tolist() == [100.0, 300.0]


def test_a_band_without_lines_is_refused() -> None:
    """With the frequencies that there are."""
    with pytest.raises(BadData, match="1999"):
        choose_band(made(np.ones(2000, complex)), (3000.0, 4000.0))


def test_a_null_of_the_force_within_the_band_is_left_out() -> None:
    """A half sine of 3 ms has none at 500 Hz for a band that ends at 480 Hz."""
    turns = 0.003 * LINES
    power = (np.cos(np.pi * turns) / (1.0 - 4.0 * turns**2)) ** 2 + 1e-12
    frf = made(np.ones(2000, complex), innovation_noise=1.0 / power[None, None])
    null = force_nulls(frf, choose_band(frf, (300.0, 600.0))[0])
    assert LINES[null].tolist() == [float(f) for f in range(484, 520)]
    assert "484 to 519 Hz" in null_words(LINES, null)[0]
    assert not force_nulls(frf, choose_band(frf, (300.0, 480.0))[0]).any()
    assert not force_nulls(made(frf.response[0, 0]), LINES > 0.0).any()
