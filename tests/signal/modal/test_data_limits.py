# SPDX-License-Identifier: MIT
"""Limits of the data are reported: time scale, length, decay, rate."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.pulse_duration import pulse_duration, time_scale_words
from jointbench.signal.modal.data_limits import (
    block_words,
    mode_words,
    requested_band_words,
)
from jointbench.signal.modal.modes import ModalSettings, identify_modes

Make = Callable[..., Any]


def test_the_duration_of_a_half_sine_is_two_thirds_of_it(
    structure: Make, hammered: Make
) -> None:
    """A half sine is above half its peak from 30 to 150 degrees."""
    record = hammered(structure((300.0,), (0.02,)), width=4e-3, sample_rate=50e3)
    assert pulse_duration(record) == pytest.approx(2.0 / 3.0 * 4e-3, rel=0.01)
    assert time_scale_words([record]) == ()


@pytest.mark.parametrize(("factor", "unit"), [(1e-3, "ms"), (1e3, "s")])
def test_a_time_column_in_the_wrong_unit_is_reported_with_the_remedy(
    structure: Make, hammered: Make, factor: float, unit: str
) -> None:
    """A pulse of 0.4 ms becomes one of 0.4 s, or of 0.4 us; both are reported."""
    record = hammered(structure((300.0,), (0.02,)), sample_rate=25600.0)
    scaled = replace(record, sample_rate=factor * record.sample_rate)
    (words,) = time_scale_words([record, scaled, scaled])
    assert "(and 1 more)" in words
    assert f"'time:{unit}'" in words


def test_a_shaker_is_no_pulse() -> None:
    """A slow sine is above half its peak for long; it is no hammer."""
    force = np.sin(np.arange(4000) / 100.0)
    channels = (Channel("f", Quantity.FORCE), Channel("a", Quantity.ACCELERATION))
    record = Recording("sine", np.array([force, force]), 100.0, channels)
    assert pulse_duration(record) is None


def test_a_block_of_some_milliseconds_says_what_it_cannot_hold(
    structure: Make, hammered: Make
) -> None:
    """229 samples from the trigger on, 8.95 ms: lines 112 Hz apart, modes 80 Hz."""
    truth = structure((400.0, 480.0), (0.01, 0.01))
    record = hammered(truth, sample_rate=25600.0, interval=0.02, first=282)
    words = block_words([find_hits(record)], lines=45)
    assert "lines 112 Hz apart (45 lines in the band)" in words[0]
    assert "closer than 224 Hz" in words[0]
    assert "below 335 Hz" in words[0]
    assert "when the block of 8.95 ms ends" in words[1]


def test_a_block_long_enough_says_nothing(structure: Make, hammered: Make) -> None:
    """One second, decayed to nothing."""
    record = find_hits(hammered(structure((400.0,), (0.01,))))
    assert block_words([record], lines=1000) == ()


def test_a_band_beyond_the_record_is_reported(structure: Make, hammered: Make) -> None:
    """8192 Hz: half is 4096 Hz, filters act from 3200 Hz on; 1 s holds 3 Hz."""
    record = find_hits(hammered(structure((400.0,), (0.01,))))
    assert requested_band_words([record], None) == ()
    assert requested_band_words([record], (10.0, 3000.0)) == ()
    low, high = requested_band_words([record], (1.0, 5000.0))
    assert "begins at 1 Hz" in low
    assert "nothing above 4096 Hz" in high
    (near,) = requested_band_words([record], (10.0, 3500.0))
    assert "3200 Hz" in near


def test_a_mode_that_hardly_decays_has_no_damping_in_the_data(
    structure: Make, hammered: Make
) -> None:
    """0.0005 of 100 Hz falls to exp(-0.3) in a second; 5 % of 400 Hz to nothing."""
    truth = structure((100.0, 400.0), (0.0005, 0.05))
    record = find_hits(hammered(truth))
    settings = ModalSettings(band=(50.0, 600.0), highest_order=12)
    model = identify_modes(estimate_frf(record), settings).model
    assert model.natural_frequency.size == 2
    (words,) = mode_words([record], model)
    assert words.startswith("mode 1: hardly decays")
