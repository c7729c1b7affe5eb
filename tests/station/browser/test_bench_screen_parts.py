"""What the server of a session prepares: envelope, pictures of hits, gains."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from jointbench.station.browser.bench.bench_state import bench_state
from jointbench.station.browser.bench.envelope_ring import EnvelopeRing
from jointbench.station.browser.bench.hit_pictures import hit_picture
from jointbench.station.browser.bench.session_feed import SessionFeed
from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.flow_events import Asked
from jointbench.station.session_events.hit_events import GainForecast, HitJudged
from jointbench.station.session_events.session_state import SessionState, state_after

RATE = 10_000.0


def bins(message: bytes) -> tuple[int, int, np.ndarray]:
    """Return first bin, samples of a bin, and values (channels, bins, 2)."""
    first, count, channels, per_bin = struct.unpack_from("<4I", message)
    values = np.frombuffer(message, np.float32, offset=16)
    return first, per_bin, values.reshape(channels, count, 2)


def test_an_envelope_keeps_a_peak_of_one_sample() -> None:
    """However the samples are cut into blocks, every bin has its extremes."""
    samples = np.zeros((2, 100))
    samples[1, 37], samples[1, 38] = 5.0, -3.0
    ring = EnvelopeRing(2, per_bin=10, kept=50)
    for block in np.array_split(samples, [7, 31, 64], axis=1):
        ring.feed(block)
    first, per_bin, values = bins(ring.message(0))
    assert (first, per_bin) == (0, 10)
    assert values.shape == (2, 10, 2)
    assert tuple(values[1, 3]) == (-3.0, 5.0)
    assert not values[0].any()


def test_only_bins_that_a_screen_has_not_seen_are_sent() -> None:
    """One that was away gets what is kept."""
    ring = EnvelopeRing(1, per_bin=1, kept=4)
    ring.feed(np.arange(10.0)[None])
    assert bins(ring.message(9))[2].ravel().tolist() == [9.0, 9.0]
    assert bins(ring.message(0))[0] == 6
    assert bins(ring.message(10))[2].size == 0


def test_a_picture_of_a_hit_shows_its_peak_and_its_first_zero() -> None:
    """A half sine of 2 ms has its first spectral zero at 3 / (2 x 2 ms) = 750 Hz."""
    time = np.arange(4000) / RATE
    force = np.where(
        (time >= 0.1) & (time < 0.102), 80 * np.sin(np.pi * (time - 0.1) / 2e-3), 0.0
    )
    hit = HitJudged(0, 500, 1505, 4500, "1", 80.0, "ok", 0.0, "clean")
    channels = [
        {"name": "hammer", "quantity": "force"},
        {"name": "a1", "quantity": "acceleration"},
    ]
    picture = hit_picture(hit, np.vstack([force, -force]), channels, RATE)
    assert max(picture["pulse"][1]) == pytest.approx(80.0, rel=1e-3)
    frequency, level = map(np.array, picture["spectrum"])
    zero = frequency[np.flatnonzero((frequency > 500) & (frequency < 1000))][
        np.argmin(level[(frequency > 500) & (frequency < 1000)])
    ]
    assert zero == pytest.approx(750.0, abs=25.0)
    assert min(picture["responses"]["a1"][1]) == pytest.approx(-80.0, rel=1e-3)


def test_all_screens_of_a_second_are_sent_one_message(tmp_path: Path) -> None:
    """It is encoded once; the clocks are beside what events change."""
    feed = SessionFeed(tmp_path / "s.h5")
    message = feed.message()
    assert feed.message() is message
    state = json.loads(message.text)["state"]
    assert state["now"] > 0.0
    assert state["hits"] == []


def gain(hit: int, sd: float) -> GainForecast:
    """Return a forecast for one resonance at 200 Hz."""
    peak = {"frequency": 200.0, "damping": 0.01, "frequency_sd": sd}
    peak |= {"damping_sd": sd, "frequency_sd_after": sd / 2, "damping_sd_after": sd / 2}
    return GainForecast(hit, 2, [peak])


def struck(number: int) -> HitJudged:
    """Return a good hit."""
    return HitJudged(number, 0, 5, 10, "1", 80.0, "ok", 0.0, "clean")


@pytest.mark.parametrize(("second", "before"), [("A", 0.04), ("B", None)])
def test_what_a_hit_bought_is_stated_within_its_point_alone(
    second: str, before: float | None
) -> None:
    """0.04 Hz before and 0.03 Hz after the hit; at another point nothing compares."""
    events = (
        Asked("A", "1", 0, 2),
        struck(0),
        gain(0, 0.04),
        Asked(second, "1", 0, 2),
        struck(1),
        gain(1, 0.03),
    )
    stamped = (Stamped(i, float(i), 0, event) for i, event in enumerate(events))
    shown = bench_state(state_after(SessionState(), stamped))["gain"]
    assert shown["peaks"][0]["frequency_sd_before"] == before
    assert shown["peaks"][0]["frequency_sd"] == 0.03
