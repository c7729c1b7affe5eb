"""The chain on samples that stay in their file."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.acquisition.session_file.store import write_session
from jointbench.signal.amplitude import ring_downs as decays
from jointbench.signal.amplitude.ring_downs import ring_downs
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.kalman.process_models import state_model
from jointbench.signal.kalman.smoothing import (
    KalmanSettings,
    measurement_noise,
    observe_noise,
)
from jointbench.station.pipeline.chain import run_chain
from jointbench.station.pipeline.modal_notes import modal_notes

RATE, SAMPLES = 4096.0, 8192
CHANNELS = (
    Channel("force", Quantity.FORCE, point="1"),
    Channel("a1", Quantity.ACCELERATION, point="1"),
    Channel("a2", Quantity.ACCELERATION, point="2"),
)


def recordings(*levels: float) -> list[Recording]:
    """Return one hit a recording on two modes, the second response the stronger."""
    time = np.arange(SAMPLES - 100) / RATE
    modes = np.exp(np.outer([-8 + 400j, -12 + 2500j], time)).imag
    rng, made = np.random.default_rng(4), []
    for number, level in enumerate(levels):
        samples = 1e-3 * rng.standard_normal((3, SAMPLES))
        samples[0, 100:108] += 100.0 * level * np.hanning(10)[1:-1]
        samples[1:, 100:] += level * np.array([[1.0, 0.5], [1.7, -0.9]]) @ modes
        made.append(Recording(f"r{number}", samples, RATE, CHANNELS))
    return made


def test_modes_and_notes_are_those_of_samples_in_memory(tmp_path: Path) -> None:
    """FRFs, noise, modes, amplitude and linearity; levels differ by a factor of two."""
    made = recordings(1.0, 1.4, 2.0, 1.2)
    path = tmp_path / "s.h5"
    write_session(new_session(source="made", simulated=True, recordings=made), path)
    one = run_chain(made)
    other = run_chain(open_session(path, most_whole=0).recordings)
    np.testing.assert_array_equal(other.frf.response, one.frf.response)
    np.testing.assert_array_equal(other.frf.variance, one.frf.variance)
    np.testing.assert_array_equal(
        other.result.model.damping_ratio, one.result.model.damping_ratio
    )
    assert [m.reason for m in other.amplitude] == [m.reason for m in one.amplitude]
    found, wanted = modal_notes(other), modal_notes(one)
    assert found.linearity is not None
    assert wanted.linearity is not None
    assert found.linearity.words == wanted.linearity.words
    assert found.limits == wanted.limits


def test_decays_beyond_the_memory_are_those_of_some_hits_and_channels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Softest, middle and hardest hit, in order of time, and the stronger response."""
    judged = [find_hits(r) for r in recordings(2.0, 1.0, 1.2, 1.5, 1.8)]
    monkeypatch.setattr(decays, "_MOST_SAMPLES", 30_000)
    monkeypatch.setattr(decays, "_LEAST_HITS", 3)
    found = ring_downs(judged)
    assert found.labels == ("a2@2",)
    assert found.samples.shape[:2] == (3, 1)
    levels = found.impulse / found.impulse.max()
    np.testing.assert_allclose(levels, [1.0, 0.5, 0.75], rtol=0.01)


def test_noise_of_a_long_recording_comes_from_stretches_of_it() -> None:
    """Of 200,000 samples 32,768 are filtered: within 2 % of what all of them give."""
    noise = np.random.default_rng(8).standard_normal((3, 200_000))
    detail = dict(observe_noise(Recording("long", noise, RATE, CHANNELS)).detail)
    whole = measurement_noise(state_model(KalmanSettings(), RATE), noise)
    for channel, variance in zip(CHANNELS, whole, strict=True):
        (found,) = [v for k, v in detail.items() if k.endswith(f"_{channel.name}")]
        assert found == pytest.approx(np.sqrt(variance), rel=0.02)
