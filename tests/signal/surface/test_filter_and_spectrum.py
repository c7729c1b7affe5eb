"""The Gaussian filter's transmission, and the level of the power spectral density."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.surface.gaussian_filter import filter_waves, transmission
from jointbench.signal.surface.line_spectrum import line_spectrum

PITCH = 1e-6


def wave(length, *, points=4000):
    """Return a cosine of 1 um whose amplitude is over a level base."""
    heights = 1e-6 * np.cos(2 * np.pi * PITCH * np.arange(points) / length)
    return Profile("wave", heights, PITCH, all_valid(heights))


def amplitude(profile):
    return float(np.sqrt(2) * np.std(profile.heights) / 1e-6)


@pytest.mark.parametrize("length", [50e-6, 100e-6, 200e-6])
def test_a_wave_at_the_cut_off_keeps_half_its_amplitude(length):
    """ISO 16610-21: 50 % at the cut-off; a high-pass has what a low-pass lacks."""
    kept = float(transmission(np.array(2 * np.pi / length), 100e-6))
    low = amplitude(filter_waves(wave(length), short=100e-6))
    high = amplitude(filter_waves(wave(length), long=100e-6))
    assert low == pytest.approx(kept, abs=0.01)
    assert high == pytest.approx(1 - kept, abs=0.01)
    assert transmission(np.array(2 * np.pi / 100e-6), 100e-6) == pytest.approx(0.5)


def test_the_cut_offs_are_stated_and_the_ends_left_out():
    """Half the longest cut-off at each end goes, and the record states them."""
    found = filter_waves(wave(50e-6), short=10e-6, long=400e-6)
    assert found.heights.size == 4000 - 2 * 200
    assert found.instrument.cutoff_short == 10e-6
    assert found.instrument.cutoff_long == 400e-6
    assert dict(found.provenance[-1].detail)["ends"] == 200


def test_missing_points_have_no_weight():
    """A spike that is masked does not reach its neighbours."""
    clean = wave(100e-6)
    heights, valid = clean.heights.copy(), np.ones(4000, dtype=bool)
    heights[2000], valid[2000] = 0.0, False
    masked = Profile("masked", heights, PITCH, valid)
    near, far = (filter_waves(one, short=20e-6).heights for one in (clean, masked))
    keep = filter_waves(masked, short=20e-6).valid
    assert np.abs(near - far)[keep].max() < 5e-9


@pytest.mark.parametrize(
    ("short", "long", "said"),
    [
        (None, None, "has one at least"),
        (1e-6, None, "not below two samples"),
        (8e-4, 2e-6, "not below lambda_c"),
        (None, 4e-3, "choose a shorter cut-off"),
    ],
)
def test_cut_offs_that_do_not_fit_are_refused(short, long, said):
    with pytest.raises(UsageError, match=said):
        filter_waves(wave(50e-6), short=short, long=long)


@pytest.mark.parametrize("missing", [0.0, 0.005])
def test_white_heights_have_a_flat_spectrum_of_their_variance(missing):
    """One-sided density 2 sigma^2 dx at every wavelength, with a few gaps as well."""
    rng = np.random.default_rng(1)
    heights = 1e-9 * rng.standard_normal(20_000)
    valid = rng.uniform(size=heights.size) >= missing
    found = line_spectrum(Profile("white", heights * valid, PITCH, valid))
    ratio = found.density / (2e-18 * PITCH)
    inside = found.frequency < 0.45 / PITCH
    spread = (ratio - 1) * np.sqrt(found.count)
    assert np.std(spread[inside]) == pytest.approx(1, abs=0.3)
    mean = np.average(ratio[inside], weights=found.count[inside])
    assert mean == pytest.approx(1, abs=0.03)


def test_rows_that_repeat_each_other_count_once():
    """A lay across the rows: 64 equal rows have the ordinates of one."""
    line = 1e-9 * np.random.default_rng(2).standard_normal(512)
    same = np.tile(line, (64, 1))
    apart = 1e-9 * np.random.default_rng(3).standard_normal((64, 512))
    counts = [
        line_spectrum(Areal("map", z, (PITCH, PITCH), all_valid(z))).count[-8:].sum()
        for z in (same, apart)
    ]
    assert counts[1] / counts[0] == pytest.approx(64, rel=0.15)
