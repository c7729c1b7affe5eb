# SPDX-License-Identifier: MIT
"""Finding hammer hits."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import ChannelMissing, NoHitFound
from jointbench.acquisition.records.recordings import (
    Channel,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.hits.find_hits import (
    HitCriteria,
    accepted_hits,
    find_hits,
    trigger_indices,
)


def force_record(force: np.ndarray, sample_rate: float = 10_000.0) -> Recording:
    """Return a recording of a force and a silent response."""
    return Recording(
        "made",
        np.array([force, np.zeros_like(force)]),
        sample_rate,
        (
            Channel("force", Quantity.FORCE, point="7"),
            Channel("a", Quantity.ACCELERATION, point="1"),
        ),
    )


def pulse(n: int, at: int, peak: float, width: int = 10) -> np.ndarray:
    """Return a half sine of `width` samples that begins at sample `at`."""
    force = np.zeros(n)
    i = np.arange(width + 1)
    force[at : at + width + 1] = peak * np.sin(np.pi * i / width)
    return force


def test_the_trigger_fires_where_the_level_is_first_reached() -> None:
    """Previous < level <= current, and the level itself counts as reached."""
    force = np.array([0.0, 1.0, 2.0, 3.0, 1.0, 0.0])
    assert trigger_indices(force, level=2.0, rearm=1.0, dead=0) == (2,)
    assert trigger_indices(force, level=2.5, rearm=1.0, dead=0) == (3,)


def test_the_trigger_stays_silent_until_it_is_rearmed() -> None:
    """A dip to 1.5 does not re-arm at 1.0; a dip to 0.5 does."""
    shallow = np.array([0.0, 3.0, 1.5, 3.0, 0.0])
    deep = np.array([0.0, 3.0, 0.5, 3.0, 0.0])
    assert trigger_indices(shallow, level=2.0, rearm=1.0, dead=0) == (1,)
    assert trigger_indices(deep, level=2.0, rearm=1.0, dead=0) == (1, 3)


def test_a_force_that_starts_above_the_level_is_no_hit() -> None:
    """Its rise was not recorded."""
    force = np.array([5.0, 3.0, 0.0, 0.0])
    assert trigger_indices(force, level=2.0, rearm=1.0, dead=0) == ()


def test_segments_run_from_pretrigger_to_the_next_pretrigger_or_the_end() -> None:
    """Hits at 2000 and 12,000 of 20,000 samples with 100 samples of pre-trigger."""
    record = force_record(pulse(20_000, 2000, 50.0) + pulse(20_000, 12_000, 60.0))
    first, second = find_hits(record, HitCriteria(trigger_level=1.0)).hits
    assert (first.start, first.trigger, first.stop) == (1901, 2001, 11_901)
    assert (second.start, second.trigger, second.stop) == (11_901, 12_001, 20_000)
    assert first.point == "7"
    assert second.peak_force == pytest.approx(60.0)


def test_a_hit_at_the_very_start_gets_a_shorter_pretrigger() -> None:
    """The pulse begins at sample 3."""
    hit = find_hits(force_record(pulse(5000, 3, 80.0))).hits[0]
    assert (hit.start, hit.verdict) == (0, Verdict.OK)
    assert 3 < hit.trigger < 8


def test_the_automatic_level_is_above_the_noise_and_below_small_hits() -> None:
    """Noise of 1 N and hits of 100 and 30 N."""
    rng = np.random.default_rng(1)
    force = pulse(20_000, 2000, 100.0) + pulse(20_000, 12_000, 30.0)
    found = find_hits(force_record(force + rng.normal(size=20_000)))
    assert [hit.trigger // 1000 for hit in found.hits] == [2, 12]


def test_noise_alone_holds_no_hit() -> None:
    """Its largest value does not stand out of its own spread."""
    noise = np.random.default_rng(2).normal(size=20_000)
    with pytest.raises(NoHitFound, match="stand out"):
        find_hits(force_record(noise))


def test_a_force_of_the_wrong_sign_is_named_as_such() -> None:
    """A hammer pushes."""
    with pytest.raises(NoHitFound, match="sign"):
        find_hits(force_record(-pulse(5000, 1000, 80.0)))


def test_a_recording_without_force_is_refused() -> None:
    """Hits are found on the force."""
    record = Recording(
        "r", np.zeros((1, 100)), 1000.0, (Channel("a", Quantity.ACCELERATION),)
    )
    with pytest.raises(ChannelMissing, match="force"):
        find_hits(record)


def test_a_bounce_within_the_dead_time_belongs_to_its_hit() -> None:
    """Two pulses 5 ms apart are one hit, judged double."""
    record = force_record(pulse(9000, 1000, 80.0) + pulse(9000, 1050, 40.0))
    (hit,) = find_hits(record).hits
    assert hit.verdict is Verdict.DOUBLE
    assert accepted_hits(find_hits(record)) == ()


def test_all_real_hits_are_accepted(real_hits: tuple[Recording, ...]) -> None:
    """They peak 21 to 23 samples after the start, with filter ringing before that."""
    for record in real_hits:
        (hit,) = find_hits(record).hits
        assert hit.verdict is Verdict.OK, hit.reason
        assert (hit.start, hit.stop) == (0, 25_600)
        assert 17 <= hit.trigger <= 21


def test_a_stream_yields_every_hit(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Five hits one second apart at 8192 Hz."""
    record = find_hits(
        hammered(structure((300.0,), (0.02,)), peaks=(90.0, 100.0, 80.0, 110.0, 95.0))
    )
    spacing = np.diff([hit.trigger for hit in record.hits])
    assert spacing.tolist() == [8192] * 4
    assert all(hit.verdict is Verdict.OK for hit in record.hits)
