"""Hits cut out of a stream, however its blocks fall."""

import numpy as np
import pytest

from jointbench.acquisition.records.recordings import Channel, Quantity, Verdict
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.signal.hits.live_hits import CutHit, HitCutter, judge_cut

LEVEL = 5.0
CHANNELS = (
    Channel("force", Quantity.FORCE, range=1000.0),
    Channel("a1", Quantity.ACCELERATION, "1", range=1000.0),
)


def stream(*peaks: tuple[int, float], size: int = 4000) -> np.ndarray:
    """Return force pulses of nine samples, and a response of half their size."""
    force = np.zeros(size)
    for where, peak in peaks:
        force[where : where + 9] += peak * np.sin(np.pi * np.arange(9) / 8)
    ripple = 1e-3 * np.sin(0.7 * np.arange(size))
    return np.vstack((force, 0.5 * force + ripple))


def cutter(after: int = 500) -> HitCutter:
    """Return a cutter with twenty samples of pre-trigger."""
    return HitCutter(row=0, level=LEVEL, before=20, after=after)


def feed(cut: HitCutter, samples: np.ndarray, size: int) -> list[CutHit]:
    """Feed samples in blocks of a size; return the hits."""
    blocks = (samples[:, i : i + size] for i in range(0, samples.shape[1], size))
    return [hit for block in blocks if (hit := cut.feed(block)) is not None]


@pytest.mark.parametrize("size", [50, 64, 333, 499])
def test_hits_are_the_same_however_the_blocks_fall(size: int) -> None:
    """Two pulses, cut at every block size at the same samples."""
    hits = feed(cutter(), stream((1000, 50.0), (2500, 80.0)), size)
    assert [(h.start, h.trigger) for h in hits] == [(981, 20), (2481, 20)]
    assert all(h.samples.shape == (2, 520) for h in hits)


@pytest.mark.parametrize("size", [50, 51, 101])
def test_a_sample_that_equals_the_level_fires(size: int) -> None:
    """``previous < level <= sample``, also where a block ends between the two."""
    samples = stream()
    samples[0, 1010:1013] = LEVEL
    (hit,) = feed(cutter(), samples, size)
    assert hit.start + hit.trigger == 1010


def test_a_sample_just_below_the_level_does_not_fire() -> None:
    """The trigger is no nearer than its level."""
    samples = stream()
    samples[0, 1010:1013] = np.nextafter(LEVEL, 0.0)
    assert feed(cutter(), samples, 64) == []


def test_a_second_pulse_within_the_block_is_no_hit_of_its_own() -> None:
    """It stays in the block of the first, for the judge to see."""
    (hit,) = feed(cutter(), stream((1000, 50.0), (1300, 30.0)), 64)
    assert hit.samples[0].argmax() == 23
    assert hit.samples[0, 323] == pytest.approx(30.0)


def test_a_hit_at_the_very_start_has_a_short_pretrigger() -> None:
    """There are no samples before the stream began."""
    (hit,) = feed(cutter(), stream((5, 50.0)), 64)
    assert (hit.start, hit.trigger) == (0, 6)


def test_a_gap_cuts_a_hit_short_and_the_cutter_starts_anew() -> None:
    """What had come is returned as not whole; the next hit counts on."""
    cut = cutter()
    assert feed(cut, stream((1000, 50.0), size=1200), 100) == []
    broken = cut.break_off()
    assert broken is not None
    assert not broken.whole
    assert broken.samples.shape[1] == 219
    (hit,) = feed(cut, stream((300, 50.0), size=1000), 100)
    assert hit.start + hit.trigger == 1200 + 301


def judged(cut: CutHit, **limits: float) -> Verdict:
    """Judge a hit that needs 500 samples."""
    return judge_cut(
        cut,
        CHANNELS,
        row=0,
        sample_rate=1000.0,
        point="1",
        needed=500,
        limits=HitLimits(**limits),  # type: ignore[arg-type]
    ).verdict


@pytest.mark.parametrize(
    ("pulses", "verdict"),
    [
        (((1000, 50.0),), Verdict.OK),
        (((1000, 50.0), (1040, 20.0)), Verdict.DOUBLE),
        (((1000, 995.0),), Verdict.OVERLOAD),
        (((1000, 8.0),), Verdict.WEAK),
    ],
)
def test_a_hit_is_judged_by_itself(
    pulses: tuple[tuple[int, float], ...], verdict: Verdict
) -> None:
    """Clean, bounced, beyond the range, and below a third of the level asked for."""
    (hit,) = feed(cutter(), stream(*pulses), 64)
    assert judged(hit, weak_force=50.0 / 3) is verdict


def test_a_hit_that_a_gap_cut_short_is_late() -> None:
    """219 samples are no block of 500."""
    cut = cutter()
    feed(cut, stream((1000, 50.0), size=1200), 100)
    broken = cut.break_off()
    assert broken is not None
    assert judged(broken) is Verdict.LATE
