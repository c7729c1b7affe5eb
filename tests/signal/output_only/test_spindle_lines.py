"""Sines of a rotating spindle are found without a tachometer and taken out."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.output_only.output_only_modes import (
    OutputOnlySettings,
    identify_output_only,
)
from jointbench.signal.output_only.spindle_lines import without_spindle_lines

RATE, BAND = 1024.0, (20.0, 400.0)
FREQUENCY, DAMPING = (61.3, 127.0), (0.012, 0.009)


def run(seconds: float, seed: int) -> Recording:
    """Return two responses of two modes to white noise."""
    rng = np.random.default_rng(seed)
    force = rng.standard_normal(round(seconds * RATE))
    modal = []
    for frequency, ratio in zip(FREQUENCY, DAMPING, strict=True):
        pole = np.exp(
            2 * np.pi * frequency * (-ratio + 1j * np.sqrt(1 - ratio**2)) / RATE
        )
        modal.append(lfilter([1, -1], [1, -2 * pole.real, abs(pole) ** 2], force))
    samples = np.array([[1.0, 0.8], [0.5, -0.9]]) @ np.array(modal)
    samples += 0.05 * samples.std() * rng.standard_normal(samples.shape)
    channels = tuple(
        Channel(f"a{i}", Quantity.ACCELERATION, point=f"{i}") for i in (1, 2)
    )
    return Recording("run", samples, RATE, channels)


def with_sines(recording: Recording, *sines: tuple[float, float]) -> Recording:
    """Add sines of a frequency [Hz] and a share of the rms to all responses."""
    time = np.arange(recording.samples.shape[1]) / RATE
    level = recording.samples[:].std()
    added = sum(
        share * np.sqrt(2) * level * np.sin(2 * np.pi * f * time) for f, share in sines
    )
    return replace(recording, samples=recording.samples + added)


@pytest.mark.parametrize("seconds", [20.0, 60.0])
def test_resonances_and_noise_hold_no_sine(seconds: float) -> None:
    """Of eight records none is changed."""
    for seed in range(8):
        given = run(seconds, seed)
        cleaned, lines = without_spindle_lines(given, BAND)
        assert cleaned is given
        assert lines.words == ""


def test_sines_are_taken_out_to_their_frequency_and_amplitude() -> None:
    """A strong one, its harmonic, and a weak one on top of a resonance."""
    given = run(60.0, 3)
    dirty = with_sines(given, (83.017, 1.0), (166.034, 0.3), (127.2, 0.5))
    cleaned, lines = without_spindle_lines(dirty, BAND)
    np.testing.assert_allclose(lines.frequency, [83.017, 127.2, 166.034], atol=2e-3)
    wanted = np.sqrt(2) * given.samples[:].std() * np.array([1.0, 0.5, 0.3])
    np.testing.assert_allclose(lines.amplitude, wanted, rtol=0.1)
    # A sine on a resonance of 200 lines takes with it what the response itself holds on
    # its line: 6 % of the rms, by chance up to twice that.
    left = cleaned.samples[:] - given.samples[:]
    assert left.std() < 0.12 * given.samples[:].std()
    assert "83.017" in lines.words


def test_a_mode_beside_a_sine_is_that_of_the_record_without_it() -> None:
    """A sine 0.2 Hz from a mode, as strong as all of the response."""
    given = run(60.0, 5)
    settings = OutputOnlySettings(band=BAND, rows=20, blocks=8, highest_order=12)
    clean = identify_output_only(given, settings)
    dirty = identify_output_only(with_sines(given, (127.2, 1.0)), settings)
    assert dirty.natural_frequency.size == clean.natural_frequency.size == 2
    apart = np.abs(dirty.natural_frequency - clean.natural_frequency)
    assert np.all(apart < clean.frequency_sd)
    away = np.abs(dirty.damping_ratio - clean.damping_ratio)
    assert np.all(away < clean.damping_ratio_sd)
    np.testing.assert_allclose(dirty.sines.frequency, [127.2], atol=5e-3)
