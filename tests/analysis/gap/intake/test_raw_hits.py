"""Hits that cannot be used, by their force, and the filter of those that can."""

import numpy as np
import pytest
from scipy.signal import freqz

from jointbench.analysis.gap.intake.filter_hits import RawHit, RawHits, filter_hits
from jointbench.analysis.gap.intake.raw_hits import QuietHit, bad_hit, make_filter
from jointbench.analysis.gap.structure_response.hit_campaign import HitRecords

AIMED = 10.0


@pytest.mark.parametrize(
    ("peak", "reason"),
    [(2.0, "glancing"), (8.0, ""), (13.0, ""), (60.0, "overload")],
)
def test_a_hit_far_from_its_aimed_peak_is_left_out(peak: float, reason: str) -> None:
    """All inputs stay within their range; the levels of the plan are left."""
    force = np.zeros((2, 400))
    force[0, 100:120] = peak * np.sin(np.linspace(0, np.pi, 20))
    hit = QuietHit(force, np.full(2, 1e-3))
    found = bad_hit(hit, 1e-2 * force, 10.0, AIMED)
    assert found.startswith(reason)
    assert bool(found) == bool(reason)


@pytest.mark.parametrize("band", [500.0, 2600.0, 3700.0])
def test_the_filter_passes_the_band_and_nothing_from_its_stop_on(band: float) -> None:
    """Samples are as few as its stop allows."""
    rate = 25_600.0
    found = make_filter(band, rate)
    assert found.stop == pytest.approx(1.15 * band)
    assert found.stop <= 0.5 * rate / found.step < 2.0 * found.stop
    frequency, gain = freqz(found.kernel, worN=8192, fs=rate)
    size = np.abs(gain)
    np.testing.assert_allclose(size[frequency < band], 1.0, atol=1e-3)
    assert size[frequency > found.stop].max() < 1e-3


def test_records_that_end_within_the_band_are_not_filtered() -> None:
    """Their sample rate leaves no room for a stop band."""
    found = make_filter(3000.0, 6400.0)
    assert found.step == 1 and found.stop == np.inf
    np.testing.assert_array_equal(found.kernel, [1.0])


def test_the_end_that_the_filter_does_not_know_is_left_out() -> None:
    """A response that still rings is filtered as one that is recorded further."""
    rate, full, short = 25_600.0, 12_000, 8000
    t = np.arange(full) / rate
    contact = np.zeros(full)
    contact[600:608] = 500.0 * np.sin(np.linspace(0.0, np.pi, 8))
    ringing = np.where(t > t[600], np.sin(2 * np.pi * 900.0 * (t - t[600])), 0.0)
    rows = np.stack([contact, 20.0 * ringing])
    noise = np.random.default_rng(2).standard_normal((2, full))
    rows += np.array([[1e-3], [1e-3]]) * noise

    def filtered(count: int) -> HitRecords:
        hit = RawHit("r", rows[:, :count], 0, 20.0, 500.0)
        one = np.full(2, 1e-3), np.ones(2)
        return filter_hits(RawHits("hits", rate, 10.0, 500, *one, (hit, hit)), 3000.0)

    whole, cut = filtered(full), filtered(short)
    count = cut.response.shape[2]
    assert count < short // cut.filter.step
    kept, longer = cut.response, whole.response[:, :, :count]
    np.testing.assert_allclose(kept, longer, atol=1e-6 * np.abs(kept).max())
    assert cut.hum_left.shape[1] == count == cut.force.shape[1]
