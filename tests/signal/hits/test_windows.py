# SPDX-License-Identifier: MIT
"""Force and exponential windows."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.windows import (
    HammerWindow,
    apply_window,
    choose_window,
    join_windows,
)


def test_the_force_window_keeps_the_pulse_and_ends_in_half_a_cosine() -> None:
    """Whole up to 10 samples after the trigger, half at 12.5, nothing from 15 on."""
    window = HammerWindow(force_width=0.010)
    force, _ = apply_window(
        window,
        np.r_[np.zeros(20), np.ones(30)],
        np.zeros((1, 50)),
        trigger=20,
        sample_rate=1000.0,
    )
    assert np.all(force[20:31] == 1.0)
    assert force[32] == pytest.approx(0.5 * (1 + np.cos(np.pi * 0.4)))
    assert np.all(force[35:] == 0.0)


def test_the_mean_before_the_pulse_is_taken_off_the_force() -> None:
    """An offset of 3 N."""
    force = np.full(100, 3.0)
    force[50:55] += 10.0
    cleaned, _ = apply_window(
        HammerWindow(), force, np.zeros((1, 100)), trigger=50, sample_rate=100.0
    )
    assert np.allclose(cleaned[50:55], 10.0)
    assert np.allclose(cleaned[:50], 0.0)


def test_the_exponential_window_multiplies_force_and_response_alike() -> None:
    """Both by exp(-rate t), t from the trigger, so that the FRF is H(s + rate)."""
    rng = np.random.default_rng(0)
    force, response = rng.normal(size=64), rng.normal(size=(2, 64))
    plain = apply_window(HammerWindow(), force, response, trigger=8, sample_rate=64.0)
    damped = apply_window(
        HammerWindow(decay_rate=5.0), force, response, trigger=8, sample_rate=64.0
    )
    decay = np.exp(-5.0 * (np.arange(64) - 8) / 64.0)
    assert np.allclose(damped[0], plain[0] * decay)
    assert np.allclose(damped[1], plain[1] * decay)


def test_what_comes_long_before_the_pulse_is_dropped_from_all_channels() -> None:
    """A lead of 4 samples before the trigger at 20."""
    response = np.sin(np.arange(50.0))[None]
    force, kept = apply_window(
        HammerWindow(lead=0.004), np.ones(50), response, trigger=20, sample_rate=1000.0
    )
    assert np.all(kept[0, :16] == 0.0)
    assert np.all(kept[0, 16:] != 0.0)
    assert force[15] == 0.0


def test_a_decayed_response_gets_no_exponential_window(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """300 Hz at 2 % has decayed by exp(-37) after 1 s."""
    window = choose_window(find_hits(hammered(structure((300.0,), (0.02,)))))
    assert window.decay_rate is None
    assert "no exponential window" in window.reason


def test_noise_at_the_end_is_not_taken_for_ringing(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """The same structure with 3 % noise: its end is above 3 % of its start."""
    record = hammered(structure((300.0,), (0.02,)), noise=0.03, seed=4)
    assert choose_window(find_hits(record)).decay_rate is None


def test_a_response_that_rings_on_gets_an_exponential_window(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """100 Hz at 0.2 % has decayed by exp(-1.26) only; 3 % shall be left."""
    record = find_hits(hammered(structure((100.0,), (0.002,))))
    window = choose_window(record)
    assert window.decay_rate is not None
    # Over the length of the block from first to last tenth (0.9 of it).
    left = np.exp(-0.9 * 2 * np.pi * 100.0 * 0.002)
    assert window.decay_rate == pytest.approx(np.log(left / 0.03), rel=0.03)


def test_the_force_window_spans_ten_pulses(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """A half sine of 20 ms, cut at 5 % of its peak: 97 % of it."""
    record = find_hits(hammered(structure((50.0,), (0.05,)), width=0.02))
    width = choose_window(record).force_width
    assert width == pytest.approx(10 * 0.97 * 0.02, rel=0.02)


def test_joined_windows_are_the_widest_and_the_fastest() -> None:
    """So that one window serves all recordings of an average."""
    joined = join_windows(
        (HammerWindow(0.01, None, 0.001, "a"), HammerWindow(0.02, 3.0, 0.002, "b"))
    )
    assert joined == HammerWindow(0.02, 3.0, 0.002, "a | b")
