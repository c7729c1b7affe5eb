# SPDX-License-Identifier: MIT
"""Judging hammer hits."""

import numpy as np
import pytest
from scipy.signal import butter, firwin, lfilter, sosfilt

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.hits.find_hits import HitCriteria, find_hits
from jointbench.signal.hits.hit_verdicts import longest_flat_top, second_peak

N, RATE = 20_000, 20_000.0


def pulse(at: int, peak: float, width: int = 12) -> np.ndarray:
    """Return a half sine in a record of N samples."""
    force = np.zeros(N)
    i = np.arange(width + 1)
    force[at : at + width + 1] = peak * np.sin(np.pi * i / width)
    return force


def judged(
    force: np.ndarray,
    response: np.ndarray | None = None,
    *,
    force_range: float | None = None,
    criteria: HitCriteria | None = None,
) -> tuple[Hit, ...]:
    """Return the hits of a force record."""
    samples = np.array([force, np.zeros(force.size) if response is None else response])
    channels = (
        Channel("force", Quantity.FORCE, range=force_range),
        Channel("a", Quantity.ACCELERATION),
    )
    return find_hits(Recording("r", samples, RATE, channels), criteria).hits


def test_a_channel_at_its_range_is_an_overload_with_the_share_as_number() -> None:
    """100 N on a channel of 101 N."""
    (hit,) = judged(pulse(500, 100.0), force_range=101.0)
    assert hit.verdict is Verdict.OVERLOAD
    assert hit.measure == pytest.approx(100.0 / 101.0)
    assert "99.0 %" in hit.reason


def test_a_flat_top_is_an_overload_even_where_the_range_is_unknown() -> None:
    """A half sine of 12 samples cut at 90 % stands still for 5 samples."""
    (hit,) = judged(np.minimum(pulse(500, 100.0), 90.0))
    assert (hit.verdict, hit.measure) == (Verdict.OVERLOAD, 3.0)


def test_a_clipped_response_spoils_the_hit_as_well() -> None:
    """The force is clean, the accelerometer is not."""
    response = np.clip(500.0 * np.sin(np.arange(N) / 7.0), -300.0, 300.0)
    (hit,) = judged(pulse(500, 100.0), response)
    assert hit.verdict is Verdict.OVERLOAD
    assert "'a'" in hit.reason


def test_a_smooth_crest_read_by_a_coarse_converter_is_not_clipped() -> None:
    """A pulse of 133 samples in steps of 1 % rests at its crest for many samples."""
    coarse = np.round(pulse(500, 100.0, width=133))
    assert np.count_nonzero(coarse == coarse.max()) > 5
    assert longest_flat_top(coarse) == 1


@pytest.mark.parametrize(("share", "delay"), [(0.6, 80), (0.2, 300), (0.08, 30)])
def test_a_bounce_is_double_with_its_share_and_delay(share: float, delay: int) -> None:
    """The number is the second peak over the first; the reason gives the delay."""
    (hit,) = judged(pulse(500, 100.0) + pulse(500 + delay, 100.0 * share))
    assert hit.verdict is Verdict.DOUBLE
    assert hit.measure == pytest.approx(share)
    assert f"{1e3 * delay / RATE:.2f} ms after" in hit.reason
    assert hit.reason.startswith(f"second force peak is {100 * hit.measure:.1f} % of")


def test_a_small_touch_before_the_blow_is_double_too() -> None:
    """The main peak comes second."""
    ratio, samples = second_peak(pulse(500, 30.0) + pulse(560, 100.0), trigger=501)
    assert ratio == pytest.approx(0.3)
    assert samples == -60


RINGING = {
    "anti-alias filter": sosfilt(butter(8, 0.8, output="sos"), pulse(500, 100.0)),
    "steep low-pass": sosfilt(butter(6, 0.25, output="sos"), pulse(500, 100.0)),
    "linear-phase filter": lfilter(firwin(65, 0.8), 1.0, pulse(500, 100.0)),
    "transducer": pulse(500, 100.0)
    + np.where(
        np.arange(N) > 512,
        12.0
        * np.exp(-(np.arange(N) - 512.0) / 40)
        * np.sin((np.arange(N) - 512) / 1.5),
        0.0,
    ),
    "mains hum": pulse(500, 100.0) + np.sin(2 * np.pi * 50 * np.arange(N) / RATE),
    "noise": pulse(500, 100.0) + 2.0 * np.random.default_rng(3).normal(size=N),
}


@pytest.mark.parametrize("cause", RINGING)
def test_ringing_hum_and_noise_after_the_pulse_are_not_a_second_hit(cause: str) -> None:
    """They swing both ways, and a hammer cannot pull."""
    (hit,) = judged(RINGING[cause])
    assert hit.verdict is Verdict.OK, hit.reason
    assert hit.measure < 0.05


def test_a_bounce_is_still_seen_through_a_steep_filter() -> None:
    """20 % after 3 ms, both pulses with their ringing."""
    force = pulse(500, 100.0) + pulse(560, 20.0)
    (hit,) = judged(sosfilt(butter(6, 0.25, output="sos"), force))
    assert hit.verdict is Verdict.DOUBLE
    assert hit.measure == pytest.approx(0.2, abs=0.04)


def test_a_hit_far_below_the_usual_is_weak() -> None:
    """20 N among hits of 100 N: the number is their ratio."""
    force = np.concatenate([pulse(500, p) for p in (100.0, 20.0, 100.0)])
    hits = judged(force)
    assert [h.verdict for h in hits] == [Verdict.OK, Verdict.WEAK, Verdict.OK]
    assert hits[1].measure == pytest.approx(0.2)


def test_a_last_hit_without_room_for_a_block_is_late() -> None:
    """The record ends 0.1 s after it, the others have 1 s."""
    force = np.concatenate([pulse(500, 100.0)] * 3)[: 2 * N + 2500]
    *rest, last = judged(force)
    assert [h.verdict for h in rest] == [Verdict.OK, Verdict.OK]
    assert last.verdict is Verdict.LATE
    assert last.measure == pytest.approx(0.1, abs=1e-3)


def test_a_given_least_length_decides_what_is_late() -> None:
    """0.975 s follow the trigger; 1.5 s were asked for."""
    (hit,) = judged(pulse(500, 100.0), criteria=HitCriteria(minimum_length=1.5))
    assert hit.verdict is Verdict.LATE
    assert "1.5 s" in hit.reason


@pytest.mark.parametrize("seed", range(40))
def test_clipping_is_found_as_by_the_steps_of_all_levels(seed: int) -> None:
    """The resolution from neighbours decides as that from all levels in order does."""
    rng = np.random.default_rng(seed)
    samples = np.cumsum(rng.standard_normal(400))
    step = float(rng.choice([1e-3, 0.2, 0.5, 1.0]))
    samples = np.round(samples / step) * step
    samples = np.clip(samples, -np.inf, np.quantile(samples, rng.choice([0.9, 1.0])))
    levels = np.unique(samples)
    resolution = float(np.diff(levels).min())
    longest = 1
    for sign in (1.0, -1.0):
        turned = sign * samples
        if turned.max() <= 0.3 * np.abs(samples).max():
            continue
        top = np.flatnonzero(turned >= turned.max() - 1e-9 * abs(turned.max()))
        for run in np.split(top, np.flatnonzero(np.diff(top) > 1) + 1):
            beside = [i for i in (run[0] - 1, run[-1] + 1) if 0 <= i < 400]
            if turned.max() - min(turned[i] for i in beside) > 2.0 * resolution:
                longest = max(longest, run.size)
    assert longest_flat_top(samples) == longest
