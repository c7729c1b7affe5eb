# SPDX-License-Identifier: MIT
"""Weights of lines: scatter, coherence, or what the Kalman stage saw."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.band import choose_band
from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.frf.line_weights import weights_of
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.kalman.smoothing import smooth_recording
from jointbench.signal.kalman.stage_provenance import stage_noise_of

FREQUENCY = np.linspace(1.0, 100.0, 100)
ALL = np.ones(100, bool)
RATE = 4096.0
NOISE = 0.01


def plain(**more: Any) -> Frf:
    """A flat FRF of one pair."""
    return Frf(FREQUENCY, np.ones((1, 1, 100), complex), FrfKind.MOBILITY, **more)


def test_lines_on_which_hits_scatter_count_less() -> None:
    """Four times the variance, a quarter of the weight; scatter before coherence."""
    variance = np.where(FREQUENCY > 70.0, 4.0, 1.0)[None, None]
    weight, source = weights_of(
        plain(variance=variance, coherence=np.full((1, 1, 100), 0.5)), ALL
    )
    assert source == "scatter between hits"
    assert weight is not None
    assert np.allclose(weight, np.where(FREQUENCY > 70.0, 0.25, 1.0))


def test_a_single_noisy_line_is_not_looked_away_from() -> None:
    """Hits differ most where a mode resonates: only trends of the noise count."""
    variance = np.where(np.arange(100) == 40, 100.0, 1.0)[None, None]
    weight, _ = weights_of(plain(variance=variance), ALL)
    assert weight is not None
    assert np.allclose(weight, 1.0)


def test_coherence_weights_lines_where_scatter_is_unknown() -> None:
    """Noise over signal is (1 - c) / c: 1 at 0.5 against 1/9 at 0.9."""
    coherence = np.where(FREQUENCY > 70.0, 0.5, 0.9)[None, None]
    weight, source = weights_of(plain(coherence=coherence), ALL)
    assert source == "coherence"
    assert weight is not None
    assert weight[-1] / weight[0] == pytest.approx(1.0 / 9.0)


def test_without_any_knowledge_all_lines_count_alike() -> None:
    """No weights, as the record states."""
    assert weights_of(plain(), ALL) == (None, "none")


def hit(seed: int) -> Recording:
    """One hit on a mode of 400 Hz that dies out early; white noise on the response."""
    time = np.arange(int(2.0 * RATE)) / RATE
    rng, since = np.random.default_rng(seed), time - 0.1
    force = np.where(
        (since >= 0.0) & (since < 0.004), 50.0 * np.sin(np.pi * since / 0.004), 0.0
    )
    late = np.maximum(since, 0.0)
    rings = np.exp(-40.0 * late) * np.sin(2.0 * np.pi * 400.0 * late)
    rings += rng.normal(0.0, NOISE, time.size)
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("a1", Quantity.ACCELERATION, point="2"),
    )
    return Recording("hit", np.array([force, rings]), RATE, channels)


def staged(seed: int) -> Recording:
    """The hit after the Kalman stage, judged as recorded."""
    judged = find_hits(hit(seed))
    return replace(smooth_recording(judged), hits=judged.hits)


def test_one_hit_is_weighed_by_the_noise_that_the_stage_saw() -> None:
    """Where a soft tip puts little force in, lines count less."""
    frf = estimate_frf(staged(0))
    keep, _ = choose_band(frf)
    weight, source = weights_of(frf, keep)
    assert source == "innovations of the Kalman stage"
    assert weight is not None
    frequency = frf.frequency[keep]
    low = weight[(frequency > 20.0) & (frequency < 60.0)].mean()
    assert weight[-10:].mean() < 0.2 * low


def test_the_noise_seen_by_the_stage_is_that_of_the_frf() -> None:
    """Against the scatter of 40 hits, between modes: within a factor of two."""
    frfs = [estimate_frf(staged(seed)) for seed in range(40)]
    scatter = np.var([frf.response[0, 0] for frf in frfs], axis=0)
    reported = frfs[0].innovation_noise
    assert reported is not None
    inside = (frfs[0].frequency > 50.0) & (frfs[0].frequency < 300.0)
    ratio = np.median(reported[0, 0, inside]) / np.median(scatter[inside])
    assert 0.5 < ratio < 2.0
    assert stage_noise_of(frfs[0].provenance)["a1"] == pytest.approx(NOISE, rel=0.3)
