"""Hits cut out of recordings: quiet before, long enough after, one length."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, ChannelMissing, NoHitFound
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.analysis.gap.intake.cut_hits import (
    PRETRIGGER,
    QUIET,
    SHORTEST,
    cut_hits,
)

RATE = 16384.0
DECAY = 0.02
NOISE = 1e-3
CHANNELS = (
    Channel("force", Quantity.FORCE, "1"),
    Channel("a0", Quantity.ACCELERATION, "1"),
)


def recording(
    triggers: list[int],
    *,
    samples: int = 20_000,
    offset: float = 0.0,
    hum: float = 0.0,
    verdicts: list[Verdict] | None = None,
    seed: int = 1,
) -> Recording:
    """Return pulses and the ringing of one mode after each."""
    time = np.arange(samples) / RATE
    force, response = np.zeros(samples), hum * np.sin(2 * np.pi * 50 * time)
    for trigger in triggers:
        since = time - time[trigger]
        force += 100.0 * np.exp(-0.5 * ((since - 3e-4) / 1e-4) ** 2)
        ring = np.exp(-since / DECAY) * np.sin(2 * np.pi * 300 * since)
        response += np.where(since > 0, 10.0 * ring, 0.0)
    rng = np.random.default_rng(seed)
    rows = np.stack([force, response + offset])
    judged = verdicts or [Verdict.OK] * len(triggers)
    hits = tuple(
        Hit(t - 100, t, samples, "1", 100.0, verdict, 0.0, "")
        for t, verdict in zip(triggers, judged, strict=True)
    )
    noisy = rows + NOISE * rng.standard_normal(rows.shape)
    return Recording("visit", noisy, RATE, CHANNELS, hits=hits)


def quiet_rms(response: FloatArray) -> float:
    """Return the rms of the first samples."""
    return float(np.sqrt(np.mean(response[:, :, :QUIET] ** 2)))


def test_every_accepted_hit_starts_at_rest_and_has_decayed_at_the_end() -> None:
    """Only noise before the hit; at most 5 % of the response at the end."""
    cut = cut_hits([recording([2000, 9000, 16000])], ["a0"])
    assert cut.force.shape[0] == 3
    assert quiet_rms(cut.response) < 1.2 * NOISE
    assert np.abs(cut.response[:, :, -64:]).max() < 0.06 * np.abs(cut.response).max()
    assert_array_equal(np.argmax(cut.force, axis=1), np.argmax(cut.force[0]))


def test_hits_that_were_rejected_stay_out() -> None:
    """The verdicts of the bench decide."""
    verdicts = [Verdict.OK, Verdict.DOUBLE, Verdict.OK]
    cut = cut_hits([recording([2000, 9000, 16000], verdicts=verdicts)], ["a0"])
    assert [hit.trigger for hit in cut.hits] == [2000, 16000]


def test_hits_during_the_response_to_the_previous_one_are_refused() -> None:
    """3 decay times between hits leave 5 % of the response ringing."""
    step = int(3 * DECAY * RATE)
    triggers = [2000 + k * step for k in range(12)]
    with pytest.raises(BadData, match="wait longer between hits") as caught:
        cut_hits([recording(triggers)], ["a0"])
    assert "\n" not in str(caught.value)


def test_one_hit_too_early_is_left_out_with_its_reason() -> None:
    """The other hits are unchanged."""
    early = 2000 + int(4 * DECAY * RATE)
    cut = cut_hits([recording([2000, early, 9000, 16000])], ["a0"])
    assert [hit.trigger for hit in cut.hits] == [2000, 9000, 16000]
    (reason,) = cut.left_out
    assert "has not decayed" in reason


def test_without_a_pretrigger_nothing_is_cut() -> None:
    """The message states the required length."""
    with pytest.raises(BadData, match="longer pre-trigger"):
        cut_hits([recording([PRETRIGGER - 1])], ["a0"])


def test_a_recording_that_ends_too_soon_is_refused() -> None:
    """The response has too few samples."""
    with pytest.raises(BadData, match="record longer"):
        cut_hits([recording([2000], samples=2000 + SHORTEST // 2)], ["a0"])


def test_a_bench_that_never_rests_is_refused() -> None:
    """A tenth of the response is present before the hit."""
    with pytest.raises(BadData, match="not quiet"):
        cut_hits([recording([2000, 9000], hum=1.5)], ["a0"])


def test_a_faint_hum_is_left_for_the_engine_to_name() -> None:
    """It is an effect of the catalogue, not a fault of the hit."""
    cut = cut_hits([recording([2000, 9000], hum=0.05)], ["a0"])
    assert np.abs(cut.response[:, 0, :QUIET]).max() > 0.02


def test_the_offset_of_a_chain_is_subtracted() -> None:
    """Fifty times the noise, and half of it."""
    for offset in (0.05, 5e-4):
        cut = cut_hits([recording([2000, 9000, 16000], offset=offset)], ["a0"])
        mean = cut.response[:, 0, :QUIET].mean()
        assert abs(mean) < 4 * NOISE / np.sqrt(3 * QUIET)


def test_recordings_cut_by_their_trigger_lose_no_hit_to_its_jitter() -> None:
    """Short records of one hit each, a few samples apart."""
    many = [recording([t], samples=1000, seed=t) for t in (126, 128, 131, 133)]
    cut = cut_hits(many, ["a0"])
    assert cut.force.shape == (4, 1000 - 133 + PRETRIGGER)
    assert_allclose(cut.recording, [0, 1, 2, 3])


def test_missing_channels_and_hits_are_named() -> None:
    """One line each."""
    with pytest.raises(ChannelMissing, match=r"'a7'.*force, a0"):
        cut_hits([recording([2000])], ["a7"])
    with pytest.raises(NoHitFound, match="1 overload"):
        cut_hits([recording([2000], verdicts=[Verdict.OVERLOAD])], ["a0"])
