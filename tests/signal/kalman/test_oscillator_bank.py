# SPDX-License-Identifier: MIT
"""Lost samples filled by a bank of oscillators."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from kalman_reference import reference_states

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.kalman.oscillator_bank import (
    bank_model,
    find_dropouts,
    repair_dropouts,
    smooth_with_gaps,
)

MODES = (np.array([120.0, 300.0]), np.array([0.01, 0.02]))


def damaged(record: Recording, first: int = 3000, count: int = 40) -> Recording:
    """Let the response read zero for a while."""
    samples = record.samples.copy()
    samples[1, first : first + count] = 0.0
    return replace(record, samples=samples)


def test_the_bank_without_gaps_agrees_with_filterpy() -> None:
    """Four oscillators, 1e-12 of the largest state after smoothing."""
    samples = np.random.default_rng(0).normal(size=400)
    frequency, damping = np.array([20.0, 60.0, 90.0, 130.0]), np.full(4, 0.02)
    model, _ = bank_model(samples, frequency, damping, 400.0)
    none = np.zeros(400, bool)
    _, wanted = reference_states(model, samples, at_rest=True)
    found = smooth_with_gaps(model, samples, none)
    assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_a_gap_agrees_with_filterpy_as_well() -> None:
    """Thirty lost samples: filterpy gets None there."""
    samples = np.random.default_rng(1).normal(size=300)
    model, _ = bank_model(samples, *MODES, 1000.0)
    lost = np.zeros(300, bool)
    lost[100:130] = True
    _, wanted = reference_states(model, samples, at_rest=True, lost=lost)
    found = smooth_with_gaps(model, samples, lost)
    assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_the_steps_of_a_converter_are_no_dropouts_but_a_longer_stop_is() -> None:
    """Noise of four steps repeats itself often; twenty equal samples it never gives."""
    samples = np.round(np.random.default_rng(4).normal(0.0, 4.0, size=(2, 80_000)))
    samples[1, 50_000:50_020] = samples[1, 50_000]
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("a1", Quantity.ACCELERATION, point="1"),
    )
    lost = find_dropouts(Recording("quiet", samples, 25600.0, channels))
    assert np.flatnonzero(lost[1]).tolist() == list(range(50_001, 50_020))


def test_dropouts_are_found_where_they_are_and_nowhere_else(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Forty zeros in the response; a force that rests at zero is none."""
    record = damaged(hammered(structure(*MODES), noise=1e-4))
    lost = find_dropouts(record)
    assert not lost[0].any()
    assert np.array_equal(np.flatnonzero(lost[1]), np.arange(3000, 3040))


def test_a_whole_recording_is_returned_as_it_is(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Nothing lost, nothing done, nothing in the provenance."""
    record = hammered(structure(*MODES), noise=1e-4)
    assert repair_dropouts(record, *MODES) is record


def test_repair_brings_the_frf_back(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """A gap of 40 samples (5 ms) in mid-decay: its error in the FRF falls to a fifth.

    The good samples are those that were recorded, bit by bit.
    """
    whole = hammered(structure(*MODES), noise=1e-4)
    broken = damaged(whole)
    mended = repair_dropouts(broken, *MODES)
    good = ~find_dropouts(broken)
    assert np.array_equal(mended.samples[good], whole.samples[good])
    frfs = [estimate_frf(r) for r in (whole, broken, mended)]
    inside = (frfs[0].frequency > 50.0) & (frfs[0].frequency < 600.0)
    wrong = [
        np.linalg.norm((f.response - frfs[0].response)[0, 0, inside]) for f in frfs[1:]
    ]
    assert wrong[1] < 0.2 * wrong[0]
    assert dict(mended.provenance[-1].detail)["filled_a1"] == 40


def test_a_channel_that_lost_half_its_samples_is_refused(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """There is nothing to track."""
    record = hammered(structure(*MODES), noise=1e-4)
    lost = np.zeros(record.samples.shape, bool)
    lost[1, :4500] = True
    with pytest.raises(BadData, match="4500 of 8192"):
        repair_dropouts(record, *MODES, lost=lost)


def test_oscillators_outside_the_band_are_refused(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Half the sample rate is 4096 Hz."""
    with pytest.raises(UsageError, match="4096"):
        repair_dropouts(hammered(structure(*MODES)), [5000.0], [0.01])
