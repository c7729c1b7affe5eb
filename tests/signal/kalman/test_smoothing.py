# SPDX-License-Identifier: MIT
"""The Kalman stage against filterpy and against its own transfer function."""

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from kalman_reference import reference_process_noise, reference_states
from scipy.linalg import solve_discrete_are

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import ChannelMissing, UsageError
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.kalman.smoothing import (
    KalmanModel,
    KalmanSettings,
    StateModel,
    filter_states,
    measurement_noise,
    smooth_recording,
    smooth_states,
    stage_gain,
    state_model,
)
from jointbench.signal.kalman.stage_provenance import stage_gain_of
from jointbench.signal.kalman.steady_gains import gains

RATE = 5000.0
STAGES = {
    "slow trend": KalmanSettings(cutoff=20.0),
    "trend": KalmanSettings(cutoff=113.0),
    "fast trend": KalmanSettings(),
    "oscillator": KalmanSettings(
        KalmanModel.OSCILLATOR, cutoff=300.0, frequency=200.0, damping_ratio=0.02
    ),
}


def parts_of(model: StateModel) -> tuple[FloatArray, ...]:
    """Return what `gains` takes of a model."""
    return model.transition, model.process, model.observation, model.start


@pytest.mark.parametrize("stage", STAGES)
def test_filter_and_smoother_agree_with_filterpy(stage: str) -> None:
    """1e-12 of the largest state, from the first sample to the last."""
    walk = np.cumsum(np.random.default_rng(0).normal(size=(2, 700)), axis=1)
    model = state_model(STAGES[stage], RATE)
    filtered, smoothed = reference_states(model, walk[1])
    size = np.abs(filtered).max()
    assert np.abs(filter_states(model, walk)[1] - filtered).max() < 1e-12 * size
    assert np.abs(smooth_states(model, walk)[1] - smoothed).max() < 1e-12 * size


@pytest.mark.parametrize("stage", STAGES)
def test_the_last_gains_are_those_of_the_algebraic_riccati_equation(stage: str) -> None:
    """What filterpy converges to, from SciPy's solver: 1e-9 of each gain."""
    model = state_model(STAGES[stage], RATE)
    filters, smoothers = gains(*parts_of(model))
    row = model.observation[None, :]
    predicted = solve_discrete_are(model.transition.T, row.T, model.process, np.eye(1))
    wanted = predicted @ model.observation / (row @ predicted @ row.T + 1.0)[0, 0]
    kept = predicted - np.outer(wanted, model.observation @ predicted)
    ahead = np.linalg.solve(predicted, model.transition @ kept).T
    assert np.allclose(filters[-1], wanted, rtol=1e-9, atol=0.0)
    assert np.allclose(smoothers[-1], ahead, rtol=1e-9, atol=1e-9 * np.abs(ahead).max())


def test_filterpy_is_imported_with_the_first_gain_and_no_sooner() -> None:
    """The import takes about a second in a fresh process."""
    code = (
        "import sys\n"
        "from jointbench.signal.kalman.smoothing import *\n"
        "model = state_model(KalmanSettings(), 1000.0)\n"
        "assert 'filterpy' not in sys.modules\n"
        "import numpy\n"
        "smooth_states(model, numpy.zeros((1, 10)))\n"
        "assert 'filterpy' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_gains_are_computed_once_for_a_configuration_and_cut_to_the_record() -> None:
    """Records of 600 and 1000 samples share a run; 1 sample has one gain."""
    model = state_model(STAGES["slow trend"], RATE)
    short, long = gains(*parts_of(model), 600)[0], gains(*parts_of(model), 1000)[0]
    assert np.shares_memory(short, long)
    assert (len(short), len(gains(*parts_of(model), 1)[0])) == (600, 1)
    assert np.array_equal(short, long[:600])


def test_rounding_that_goes_in_a_circle_ends_the_run() -> None:
    """With the default cutoff the last digit never rests; 20 gains, not 50,000."""
    model = state_model(KalmanSettings(), RATE)
    assert len(gains(*parts_of(model))[0]) < 100


def test_level_and_slope_carry_the_process_noise_of_filterpy() -> None:
    """White acceleration, constant within a sample."""
    model = state_model(KalmanSettings(cutoff=100.0), RATE)
    scale = model.process[1, 1]
    assert np.allclose(model.process, scale * reference_process_noise())


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("smooth", [True, False])
def test_the_stated_gain_is_that_of_the_impulse_response(
    stage: str, smooth: bool
) -> None:
    """Transform of the answer to one sample of 1 in the middle of silence."""
    settings = KalmanSettings(
        STAGES[stage].model,
        STAGES[stage].cutoff,
        smooth,
        STAGES[stage].frequency,
        STAGES[stage].damping_ratio,
    )
    model, impulse = state_model(settings, RATE), np.zeros((1, 8001))
    impulse[0, 4000] = 1.0
    run = smooth_states if smooth else filter_states
    answer = run(model, impulse)[0] @ model.observation
    f = np.array([5.0, 48.7, 166.5, 310.7, 1000.0, 2000.0])
    turn = np.exp(-2j * np.pi * np.outer(f / RATE, np.arange(8001) - 4000))
    gain = stage_gain(settings, f, RATE)
    assert np.allclose(turn @ answer, gain.gain * np.exp(1j * gain.phase), atol=1e-9)


def test_the_slow_smoother_is_a_fourth_order_low_pass_without_phase() -> None:
    """Integrated twice, white noise has power 1/f^4: W = 1 / (1 + (f / cutoff)^4)."""
    f = np.array([48.7, 166.5, 310.7])
    gain = stage_gain(KalmanSettings(cutoff=113.0), f, 25_600.0)
    assert np.allclose(gain.gain, 1.0 / (1.0 + (f / 113.0) ** 4), rtol=2e-3)
    assert np.all(gain.phase == 0.0)


@pytest.mark.parametrize("stage", STAGES)
def test_the_smoother_halves_at_its_cutoff(stage: str) -> None:
    """By definition of the process noise."""
    settings = STAGES[stage]
    cutoff = RATE / 4.0 if settings.cutoff is None else settings.cutoff
    gain = stage_gain(settings, np.array([cutoff]), RATE)
    assert gain.gain[0] == pytest.approx(0.5)


def test_innovations_tell_the_noise_of_a_signal_that_follows_the_model() -> None:
    """A trend driven as the model says, noise variance 4: 20,000 samples, 3 %."""
    model = state_model(KalmanSettings(cutoff=400.0), RATE)
    rng, n = np.random.default_rng(1), 20_000
    sd = 2.0
    push = rng.normal(size=n) * sd * np.sqrt(model.process[1, 1])
    slope = np.cumsum(push)
    level = np.cumsum(np.r_[0.0, slope[:-1]] + 0.5 * push)
    noisy = level + sd * rng.normal(size=n)
    assert measurement_noise(model, noisy[None])[0] == pytest.approx(4.0, rel=0.05)


def test_the_same_smoother_on_all_channels_leaves_the_frf_alone(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """At the modes the FRF changes by less than 1e-4 though the filter takes 16 %."""
    truth = structure((300.0, 1200.0), (0.02, 0.01))
    record = hammered(truth)
    smooth = smooth_recording(record, KalmanSettings(cutoff=1800.0))
    before, after = estimate_frf(record), estimate_frf(smooth)
    gain = stage_gain_of(after.provenance, truth.frequency)
    assert gain is not None
    assert gain.all_channels
    assert gain.gain[1] < 0.86
    for f in truth.frequency:
        line = int(np.argmin(np.abs(before.frequency - f)))
        assert after.response[0, 0, line] == pytest.approx(
            before.response[0, 0, line], rel=1e-4
        )


def test_the_smoother_on_the_response_alone_multiplies_the_frf_by_its_gain(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """This is why it is not the default, and why it is recorded."""
    truth = structure((300.0, 1200.0), (0.02, 0.01))
    record, settings = hammered(truth), KalmanSettings(cutoff=1800.0)
    smooth = smooth_recording(record, settings, channels=("a1",))
    before, after = estimate_frf(record), estimate_frf(smooth)
    gain = stage_gain_of(after.provenance, before.frequency)
    assert gain is not None
    assert not gain.all_channels
    line = int(np.argmin(np.abs(before.frequency - 1200.0)))
    ratio = after.response[0, 0, line] / before.response[0, 0, line]
    assert ratio == pytest.approx(gain.gain[line], rel=1e-3)


def test_no_stage_in_the_provenance_means_no_gain() -> None:
    """A recording that was never smoothed."""
    assert stage_gain_of((), np.array([100.0])) is None


@pytest.mark.parametrize("cutoff", [0.0, -5.0, 2500.0])
def test_a_cutoff_outside_the_band_is_refused(cutoff: float) -> None:
    """Between zero and half the sample rate there is something to smooth."""
    with pytest.raises(UsageError, match="cutoff"):
        state_model(KalmanSettings(cutoff=cutoff), RATE)


def test_a_channel_that_is_not_there_is_named(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """With the names that are."""
    with pytest.raises(ChannelMissing, match=r"'b7'.*force, a1"):
        smooth_recording(hammered(structure((300.0,), (0.1,))), channels=("b7",))


def test_the_model_is_read_only() -> None:
    """Records do not change afterwards."""
    model: StateModel = state_model(KalmanSettings(cutoff=100.0), RATE)
    with pytest.raises(ValueError, match="read-only"):
        model.process[0, 0] = 1.0
