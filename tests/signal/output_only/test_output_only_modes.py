# SPDX-License-Identifier: MIT
"""Modes from responses alone: a machine under an unmeasured force."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, NoModeFound, UsageError
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.output_only.correlations import correlate_responses
from jointbench.signal.output_only.harmonics import envelope_spread
from jointbench.signal.output_only.output_only_modes import (
    OutputOnlyModes,
    OutputOnlySettings,
    identify_output_only,
)
from jointbench.signal.output_only.stochastic_subspace import subspace_poles

RATE = 2048.0
FREQUENCY = np.array([61.3, 127.0, 208.5, 344.0])
DAMPING = np.array([0.012, 0.009, 0.011, 0.008])
POINTS = np.array([[1.0, 0.8, -0.6, 0.7], [0.4, -0.9, 0.5, 0.8], [-0.7, 0.3, 0.9, 1.0]])
SEARCH = OutputOnlySettings(band=(30.0, 500.0))


def spindle_run(seconds: float, seed: int, *, noise: float = 0.05) -> Recording:
    """Shake four modes by one white force and record three accelerations.

    Each mode is the exact recursion of a sampled oscillator, so that its poles are
    those of the structure; the first two seconds, in which it swings in, are left out.
    """
    rng = np.random.default_rng(seed)
    force = rng.normal(size=round((seconds + 2.0) * RATE))
    omega = 2.0 * np.pi * FREQUENCY
    poles = np.exp(omega * (-DAMPING + 1j * np.sqrt(1.0 - DAMPING**2)) / RATE)
    modal = [
        lfilter([1.0, -1.0], [1.0, -2.0 * p.real, abs(p) ** 2], force) for p in poles
    ]
    samples = (POINTS @ np.array(modal))[:, round(2.0 * RATE) :]
    level = samples.std(axis=1, keepdims=True)
    return recording(samples + noise * level * rng.normal(size=samples.shape))


def recording(samples: FloatArray) -> Recording:
    """Name the rows a1, a2, ... and their points 1, 2, ..."""
    channels = tuple(
        Channel(f"a{i}", Quantity.ACCELERATION, point=str(i), direction="+z")
        for i in range(1, samples.shape[0] + 1)
    )
    return Recording("run", samples, RATE, channels)


def test_a_spindle_run_gives_frequency_and_damping_without_a_force_channel() -> None:
    """Two minutes: frequency within 0.2 %, damping within 15 %, each mode once."""
    modes = identify_output_only(spindle_run(120.0, 1), SEARCH)
    assert np.allclose(modes.natural_frequency, FREQUENCY, rtol=2e-3)
    assert np.allclose(modes.damping_ratio, DAMPING, rtol=0.15)
    assert modes.outputs == ("a1@1", "a2@2", "a3@3")
    assert not modes.sine_like.any()


@pytest.fixture(scope="module")
def runs() -> list[OutputOnlyModes]:
    """Ten runs of 40 s, small models so that it stays quick."""
    small = OutputOnlySettings(band=(30.0, 500.0), rows=30, highest_order=24)
    return [identify_output_only(spindle_run(40.0, 100 + s), small) for s in range(10)]


def nearest(modes: OutputOnlyModes) -> list[int]:
    """Return which mode is which, all of them different."""
    found = [int(np.argmin(np.abs(modes.natural_frequency - f))) for f in FREQUENCY]
    assert len(set(found)) == FREQUENCY.size
    return found


def test_the_intervals_cover_the_truth_as_often_as_they_say(
    runs: list[OutputOnlyModes],
) -> None:
    """Ten runs, four modes: of 80 intervals of 95 %, more than 87 %.

    Were they right 95 times in 100, 70 or fewer of 80 would have a chance of 0.4 %.
    """
    inside = []
    for modes in runs:
        i = nearest(modes)
        frequency_off = np.abs(modes.natural_frequency[i] - FREQUENCY)
        damping_off = np.abs(modes.damping_ratio[i] - DAMPING)
        inside += list(frequency_off < 1.96 * modes.frequency_sd[i])
        inside += list(damping_off < 1.96 * modes.damping_ratio_sd[i])
    assert np.mean(inside) > 0.875


def test_the_intervals_are_no_wider_than_they_must_be(
    runs: list[OutputOnlyModes],
) -> None:
    """The sd of damping is that of the scatter over runs, within a factor of 2."""
    damping = np.array([modes.damping_ratio[nearest(modes)] for modes in runs])
    reported = np.array([modes.damping_ratio_sd[nearest(modes)] for modes in runs])
    ratio = np.median(reported, axis=0) / np.std(damping, axis=0, ddof=1)
    assert 0.5 < np.median(ratio) < 2.0


@pytest.mark.parametrize("seed", range(2))
def test_noise_alone_holds_no_mode(seed: int) -> None:
    """Three channels of white noise, half a minute."""
    noise = np.random.default_rng(seed).normal(size=(3, round(30.0 * RATE)))
    with pytest.raises(NoModeFound, match="record longer"):
        identify_output_only(recording(noise))


def test_shapes_are_those_of_the_structure_up_to_a_factor() -> None:
    """Modal assurance criterion with the true shape above 0.995."""
    modes = identify_output_only(spindle_run(40.0, 2), SEARCH)
    for frequency, shape in zip(FREQUENCY, POINTS.T, strict=True):
        i = int(np.argmin(np.abs(modes.natural_frequency - frequency)))
        overlap = abs(np.vdot(modes.shapes[i], shape)) ** 2
        overlap /= np.vdot(modes.shapes[i], modes.shapes[i]).real * (shape @ shape)
        assert overlap > 0.995


def test_a_sine_of_the_spindle_is_distinguished_from_a_resonance() -> None:
    """A sine at 150 Hz besides the modes has a constant envelope."""
    run = spindle_run(60.0, 3)
    time = np.arange(run.samples.shape[1]) / RATE
    sine = 0.5 * run.samples.std() * np.sin(2.0 * np.pi * 150.0 * time)
    run = replace(run, samples=run.samples + sine)
    spread = envelope_spread(run, np.array([-5.0 + 2j * np.pi * 150.0]))
    resonance = envelope_spread(run, np.array([-7.2 + 2j * np.pi * 127.0]))
    assert spread[0] < 0.2
    assert resonance[0] > 0.5


def test_exact_correlations_give_exact_poles() -> None:
    """Decaying cosines, the correlations of two modes: poles to 1e-8."""
    pole = np.array([-5.0 + 400j, -9.0 + 700j])
    lag = np.arange(60) / RATE
    one = np.exp(pole[:, None] * lag).real
    correlation = np.array([[1.0, 0.5], [0.3, -1.0]]) @ one
    found = subspace_poles(
        correlation.T[:, :, None], (4,), sample_rate=RATE, band=(1.0, 1000.0)
    )
    assert np.allclose(found[0].pole, pole, rtol=1e-8)


def test_a_force_channel_takes_no_part() -> None:
    """The same modes with a force channel beside the responses."""
    run = spindle_run(30.0, 4)
    force = Channel("force", Quantity.FORCE)
    spare = np.random.default_rng(0).normal(size=(1, run.samples.shape[1]))
    with_force = replace(
        run,
        samples=np.vstack((spare, run.samples)),
        channels=(force, *run.channels),
    )
    alone = identify_output_only(run, SEARCH)
    both = identify_output_only(with_force, SEARCH)
    assert np.array_equal(alone.natural_frequency, both.natural_frequency)


def test_the_correlation_of_white_noise_is_one_at_zero_lag_only() -> None:
    """Scaled to unit rms; 1 / sqrt(n) elsewhere."""
    noise = recording(np.random.default_rng(5).normal(size=(1, 40_000)))
    data = correlate_responses(noise, highest=0.5 * RATE, n_lags=20, n_blocks=8)
    mean = data.mean[:, 0, 0]
    assert mean[0] == pytest.approx(1.0, abs=0.01)
    assert np.abs(mean[1:]).max() < 4.0 / np.sqrt(40_000)


def test_a_record_too_short_says_how_long_it_must_be() -> None:
    """Two seconds of noise."""
    with pytest.raises(BadData, match=r"lasts 2 s.*record longer"):
        identify_output_only(recording(np.random.default_rng(0).normal(size=(1, 4096))))


def test_a_dead_channel_is_named() -> None:
    """The second response is zero throughout."""
    run = spindle_run(20.0, 6)
    samples = run.samples.copy()
    samples[1] = 0.0
    with pytest.raises(BadData, match="'a2' is constant"):
        identify_output_only(replace(run, samples=samples), SEARCH)


def test_a_band_beyond_the_sample_rate_is_refused() -> None:
    """Half the sample rate is 1024 Hz."""
    with pytest.raises(UsageError, match="1024"):
        identify_output_only(
            spindle_run(20.0, 7), OutputOnlySettings(band=(10.0, 2000.0))
        )
