# SPDX-License-Identifier: MIT
"""Records that end while the structure rings: what is left out is in the model."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.frf.record_end import RecordEnd
from jointbench.signal.modal.modes import ModalSettings, identify_modes

RATE, LEAD = 4096.0, 64
POLES = 2 * np.pi * np.array([-0.8 + 100.0j, -1.5 + 310.0j])
SETTINGS = ModalSettings(band=(40.0, 600.0))


def struck(count: int, noise: float = 1e-5) -> Recording:
    """Return three hits, each followed by some samples: exact decays of impulses."""
    rng = np.random.default_rng(3)
    time, pulse = np.arange(count) / RATE, np.array([0.5, 1.0, 0.5])
    decay = (np.exp(np.outer(time, POLES)) @ [1.0, 0.4]).imag
    answer = np.convolve(pulse, decay)[:count]
    samples, hits = np.zeros((2, 3 * (LEAD + count))), []
    for first in range(0, samples.shape[1], LEAD + count):
        start = first + LEAD
        samples[0, start : start + 3] = 100.0 * pulse
        samples[1, start : start + count] = 100.0 * answer
        hits.append(
            Hit(first, start, start + count, "1", 100.0, Verdict.OK, 0.0, "made")
        )
    samples += noise * 100.0 * rng.standard_normal(samples.shape)
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("x", Quantity.DISPLACEMENT, point="1"),
    )
    return Recording("cut", samples, RATE, channels, hits=tuple(hits))


def test_a_cut_record_gives_the_poles_and_intervals_of_its_noise() -> None:
    """2 % of the slower mode is left at the end: a tenth of the error, 80 dB."""
    frf = estimate_frf(struck(LEAD * 49, noise=1e-4))
    assert frf.end is not None
    true = np.abs(POLES) / (2 * np.pi)
    found, blind = (
        identify_modes(one, SETTINGS).model for one in (frf, replace(frf, end=None))
    )
    error, other = (np.abs(m.natural_frequency - true) for m in (found, blind))
    assert np.all(error < 4.0 * found.frequency_sd)
    assert np.all(found.frequency_sd < 0.2 * blind.frequency_sd)
    assert error.max() < 0.1 * other.max()


def test_hits_with_triggers_at_different_places_are_cut_alike() -> None:
    """A trigger a few samples late: the same FRF as where all are on time."""
    made = struck(LEAD * 49, noise=1e-4)
    late = [replace(h, start=h.start + n) for n, h in enumerate(made.hits)]
    frf = estimate_frf(replace(made, hits=tuple(late)))
    less = [replace(h, start=h.start + 2) for h in made.hits]
    other = estimate_frf(replace(made, hits=tuple(less)))
    assert frf.end is not None
    np.testing.assert_array_equal(frf.response, other.response)


def test_the_share_left_out_is_that_of_the_decay_after_the_end() -> None:
    """Against the sum over the samples that the block lacks, and its derivative."""
    end = RecordEnd(0.5, np.array([0.01, 0.0102, 0.0104]), np.array([0.5, 1.0, 0.5]))
    line = 2j * np.pi * np.arange(100.0, 160.0, 2.0) + 3.0
    pole = np.array([-9.0 + 800.0j])
    on_lines = end.on(line)
    left, change = (
        np.multiply.outer(on_lines.inverse, part) for part in on_lines.shares(pole)
    )
    later = 0.5 + np.arange(40_000) / 4e4
    rest = np.exp(np.multiply.outer(later, pole - 3.0))[:, 0] * np.sum(
        end.force * np.exp(-(pole[0] - 3.0) * end.time)
    )
    kernel = np.exp(-np.multiply.outer(1j * line.imag, later))
    whole = np.trapezoid(kernel * rest, later, axis=1)
    beyond = rest[-1] * kernel[:, -1] / (line - pole[0])
    force = np.exp(-np.multiply.outer(1j * line.imag, end.time)) @ end.force
    exact = (whole + beyond) / force * (line - pole[0])
    np.testing.assert_allclose(left[:, 0], exact, rtol=2e-3)
    step = 1e-4
    after = np.multiply.outer(on_lines.inverse, on_lines.shares(pole + step)[0])
    moved = (after - left) / step
    np.testing.assert_allclose(change, moved, rtol=1e-3)
