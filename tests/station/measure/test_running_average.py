"""The running average of a condition: the same numbers, each hit transformed once."""

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.frf.frf import Frf, estimate_frf
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure import running_average as measure_average
from jointbench.station.measure.running_average import (
    Accepted,
    GrowingAverage,
    mean_coherence,
)

RATE, COUNT, TRIGGER = 2048.0, 1024, 64
CHANNELS = (
    Channel("force", Quantity.FORCE, point="1", unit="N"),
    Channel("a1", Quantity.ACCELERATION, point="1", unit="g"),
    Channel("a2", Quantity.ACCELERATION, point="2", unit="g"),
)


def hit(
    seed: int, *, frequency: float = 150.0, damping: float = 0.05, late: int = 0
) -> Accepted:
    """Return a hit of half a second on one mode, with noise of its own."""
    rng = np.random.default_rng(seed)
    samples = rng.normal(0.0, 1e-3, (3, COUNT + late))
    time = (np.arange(COUNT + late) - TRIGGER) / RATE
    peak = rng.uniform(40.0, 60.0)
    on = (time >= 0.0) & (time < 0.003)
    samples[0, on] += peak * np.sin(np.pi * time[on] / 0.003)
    omega = 2 * np.pi * frequency
    after = np.maximum(time - 0.0015, 0.0)
    ring = np.exp(-damping * omega * after) * np.sin(omega * after)
    samples[1] += peak / 50.0 * ring
    samples[2] -= peak / 80.0 * ring
    cut = CutHit(samples, 0, TRIGGER, True)
    judged = Hit(0, TRIGGER, COUNT, "1", peak, Verdict.OK, 0.0, "")
    return Accepted(cut, judged)


def at_once(accepted: list[Accepted]) -> Frf:
    """Return the FRF of the hits, each a recording, all transformed again."""
    length = min(each.cut.samples.shape[1] for each in accepted)
    judged = (Hit(0, TRIGGER, length, "1", 50.0, Verdict.OK, 0.0, ""),)
    return estimate_frf(
        [
            Recording(f"{n}", each.cut.samples[:, :length], RATE, CHANNELS, hits=judged)
            for n, each in enumerate(accepted)
        ]
    )


@pytest.mark.parametrize(("damping", "kept"), [(0.05, 2**25), (0.004, 1)])
def test_an_average_that_grows_is_the_average_of_all_hits(
    damping: float, kept: int
) -> None:
    """With and without an exponential window, and with a hit that is shorter.

    Where no spectra are kept, hits are transformed again: the numbers are the same.
    """
    accepted = [hit(n, damping=damping, late=200) for n in range(4)]
    accepted.append(hit(4, damping=damping))
    growing = GrowingAverage(CHANNELS, RATE, kept=kept)
    for count in range(1, 6):
        found, wanted = growing.frf(accepted[:count]), at_once(accepted[:count])
        assert found is not None
        np.testing.assert_allclose(found.response, wanted.response, rtol=1e-12)
        assert found.usable_band == wanted.usable_band
        assert found.added_decay_rate == pytest.approx(wanted.added_decay_rate)
        if count > 1:
            np.testing.assert_allclose(found.coherence, wanted.coherence, rtol=1e-12)


def test_a_hit_is_transformed_when_it_comes_and_hardly_ever_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Forty hits with a search for outliers: 23,000 if all are repeated."""
    transformed = []
    real = measure_average.hit_spectra

    def counted(recordings: list[Recording], window: object) -> object:
        transformed.append(len(recordings))
        return real(recordings, window)  # type: ignore[arg-type]

    monkeypatch.setattr(measure_average, "hit_spectra", counted)
    accepted = [hit(n) for n in range(40)]
    growing = GrowingAverage(CHANNELS, RATE)
    for count in range(1, 41):
        growing.spoiler(accepted[:count], wanted=0.9999999)
        growing.frf(accepted[:count])
    assert sum(transformed) <= 80


@pytest.mark.parametrize("position", [0, 2, 4])
def test_the_hit_without_which_the_others_agree_is_found_wherever_it_is(
    position: int,
) -> None:
    """It rang at another frequency; the coherence without it is that of the others."""
    accepted = [hit(n) for n in range(5)]
    accepted[position] = hit(9, frequency=300.0)
    growing = GrowingAverage(CHANNELS, RATE, kept=1)
    spoiler = growing.spoiler(accepted, wanted=0.9)
    others = at_once(accepted[:position] + accepted[position + 1 :])
    without = mean_coherence(others)
    assert spoiler is not None
    assert without is not None
    assert spoiler.position == position
    assert f"coherence {without:.3f} without" in spoiler.reason


@pytest.mark.parametrize("position", [0, 37, 89])
def test_the_spoiler_is_found_among_ninety_hits_by_a_few_lines_of_each(
    position: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the likeliest few are looked at over all lines, and no spectra are kept."""
    looked_at = []
    real = measure_average.coherence_of_others

    def counted(*given: object) -> float:
        looked_at.append(given)
        return real(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(measure_average, "coherence_of_others", counted)
    accepted = [hit(n) for n in range(90)]
    accepted[position] = hit(99, frequency=300.0)
    growing = GrowingAverage(CHANNELS, RATE, kept=1)
    together = mean_coherence(growing.frf(accepted))
    others = at_once(accepted[:position] + accepted[position + 1 :])
    without = mean_coherence(others)
    assert together is not None
    assert without is not None
    spoiler = growing.spoiler(accepted, wanted=(together + without) / 2)
    assert spoiler is not None
    assert spoiler.position == position
    assert f"coherence {without:.3f} without" in spoiler.reason
    assert len(looked_at) <= 5


def test_hits_that_agree_have_no_spoiler_and_no_hits_have_no_average() -> None:
    """Nor do two, of which either may be the one."""
    growing = GrowingAverage(CHANNELS, RATE)
    assert growing.spoiler([hit(n) for n in range(5)], wanted=0.9) is None
    two = [hit(0), hit(1, frequency=220.0)]
    assert growing.spoiler(two, wanted=0.9) is None
    assert growing.frf([]) is None


def test_a_dead_response_gives_no_average() -> None:
    """As with hits that are transformed at once."""
    dead = hit(0)
    samples = np.array(dead.cut.samples)
    samples[2] = 0.0
    broken = Accepted(CutHit(samples, 0, TRIGGER, True), dead.hit)
    assert GrowingAverage(CHANNELS, RATE).frf([hit(1), broken]) is None
