# SPDX-License-Identifier: MIT
"""Data without modes are refused in one line with reason and remedy."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import (
    BadData,
    ChannelMissing,
    NoHitFound,
    NoModeFound,
    UsageError,
)
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.band import choose_band
from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.kalman.smoothing import smooth_recording
from jointbench.signal.modal.modes import ModalSettings, identify_modes, orders_to_try

RATE = 5120
CHANNELS = (
    Channel("force", Quantity.FORCE, point="1"),
    Channel("a1", Quantity.ACCELERATION, point="1"),
    Channel("a2", Quantity.ACCELERATION, point="2"),
)


def struck(*responses: np.ndarray, seed: int = 0, at: float = 0.05) -> Recording:
    """Return one hammer hit of 100 N and 2 ms, answered by the given responses."""
    time = np.arange(RATE) / RATE
    pulse = np.where(np.abs(time - at) < 1e-3, np.cos(np.pi * (time - at) / 2e-3), 0)
    noise = 0.01 * np.random.default_rng(seed).normal(size=RATE)
    samples = np.vstack((100.0 * pulse**2 + noise, *responses))
    return Recording("hit", samples, float(RATE), CHANNELS[: samples.shape[0]])


@pytest.mark.parametrize("hits", [1, 3])
def test_a_response_of_noise_alone_holds_no_modes(hits: int) -> None:
    """Eight seeds, hits with an exponential window, which makes noise look damped."""
    for seed in range(8):
        rng = np.random.default_rng((seed, hits))
        records = [struck(rng.normal(size=RATE), seed=i) for i in range(hits)]
        frf = estimate_frf([smooth_recording(r) for r in records])
        assert frf.added_decay_rate > 0.0
        with pytest.raises(NoModeFound, match="above the noise"):
            identify_modes(frf)


@pytest.mark.parametrize("value", [0.0, 3.7])
@pytest.mark.parametrize("smooth", [False, True])
def test_a_dead_channel_is_named(value: float, smooth: bool) -> None:
    """The first of two responses is constant, as recorded or through the smoother."""
    alive = np.random.default_rng(1).normal(size=RATE)
    record = struck(np.full(RATE, value), alive)
    with pytest.raises(ChannelMissing, match=r"'a1'") as caught:
        estimate_frf(smooth_recording(record) if smooth else record)
    assert "'a2'" not in str(caught.value)


def test_all_dead_channels_are_named() -> None:
    """Both responses are zero."""
    with pytest.raises(ChannelMissing, match=r"'a1'.*'a2'"):
        estimate_frf(struck(np.zeros(RATE), np.zeros(RATE)))


def test_an_frf_that_is_zero_throughout_is_named() -> None:
    """The second of two outputs, as an imported FRF may have it."""
    response = np.ones((2, 1, 500), complex)
    response[1] = 0.0
    frf = Frf(
        np.arange(500.0), response, FrfKind.ACCELERANCE, outputs=("top@1", "base@2")
    )
    with pytest.raises(NoModeFound, match="'base@2'"):
        identify_modes(frf)


@pytest.mark.parametrize("order", [-1, 0, 1, 201, 100_000, 10**9])
def test_an_order_out_of_range_is_a_usage_error(order: int) -> None:
    """2 to 200 for one input and 5000 lines."""
    with pytest.raises(UsageError, match=f"order is {order}; give 2 to 200 "):
        orders_to_try(ModalSettings(highest_order=order), 5000, 1)


def test_the_largest_order_falls_with_lines_and_inputs() -> None:
    """60 lines carry 30 poles, 15 for each of two inputs."""
    assert orders_to_try(ModalSettings(highest_order=15), 60, 2)[-1] == 15
    with pytest.raises(UsageError, match="give 2 to 15 "):
        orders_to_try(ModalSettings(highest_order=16), 60, 2)


def test_a_short_record_is_refused_with_the_needed_length(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """100 Hz lines up to 1 kHz: 19 lines of a 1 kHz band take 0.019 s, not 0.01 s."""
    frf = noisy_frf(
        structure((300.0,), (0.01,)), np.arange(0.0, 1001.0, 100.0), noise=0.0, seed=0
    )
    with pytest.raises(BadData, match=r"record 0\.019 s .* instead of 0\.01 s") as met:
        choose_band(replace(frf, usable_band=(0.0, 1000.0)))
    assert "--band" not in str(met.value)


def test_a_record_that_begins_inside_the_pulse_asks_for_a_pretrigger() -> None:
    """The crest of the pulse is the first sample."""
    record = struck(np.random.default_rng(2).normal(size=RATE), at=0.0)
    with pytest.raises(NoHitFound, match=r"begins inside the pulse.*pre-trigger"):
        find_hits(record)
