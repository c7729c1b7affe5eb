"""The simulated profilometer and its Keyence export."""

import csv
import io

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.simulators.rough_surfaces.profilometer import (
    Profilometer,
    measure_areal,
    measure_profile,
    traced,
)
from jointbench.simulators.rough_surfaces.rough_surface import rough_map, rough_profile
from jointbench.simulators.rough_surfaces.surface_files import write_keyence_csv

MAP = rough_map(12, 20, spacing=0.25e-6, dimension=1.5, roughness=1e-9, seed=1)


def test_noise_has_the_stated_size():
    """The difference to the surface is the noise, within 4 sigma."""
    profile = rough_profile(20_000, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=1)
    seen = measure_profile(profile, Profilometer(noise=2e-9), seed=1)
    error = seen.heights - profile.heights
    assert abs(error.std() / 2e-9 - 1) < 4 / np.sqrt(2 * 20_000)


def test_a_point_spread_damps_a_wave_as_its_transform_says():
    """A Gaussian of sigma turns a wave of wave number q down by exp(-(q s)^2/2)."""
    profile = rough_profile(4096, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=1)
    number = 2 * np.pi / 16e-6
    wave = type(profile)(
        name="wave",
        heights=1e-6 * np.cos(number * 1e-6 * np.arange(4096)),
        spacing=1e-6,
        valid=profile.valid,
    )
    spot = 3e-6
    seen = measure_profile(wave, Profilometer(noise=0.0, spot=spot), seed=1)
    middle = slice(500, 3500)
    damping = np.exp(-((number * spot) ** 2) / 2)
    assert_allclose(seen.heights[middle], damping * wave.heights[middle], atol=2e-10)


def test_missing_points_are_masked_and_zero():
    """A fifth of the points without an answer, none with a made-up height."""
    seen = measure_areal(MAP, Profilometer(missing=0.2), seed=3)
    assert 0.1 < np.mean(~seen.valid) < 0.3
    assert not np.any(seen.heights[~seen.valid])


def test_heights_are_whole_steps_of_the_resolution():
    """0.1 nm is the last digit."""
    heights = measure_areal(MAP, Profilometer(), seed=3).heights
    assert_allclose(heights / 1e-10, np.round(heights / 1e-10), atol=1e-6)


def test_the_export_has_the_quirks_of_the_instrument(tmp_path):
    """Byte-order mark, CRLF, quotes, and the line break inside a key."""
    path = tmp_path / "height.csv"
    write_keyence_csv(MAP, path)
    raw = path.read_bytes()
    assert raw.startswith(b'\xef\xbb\xbf"Measured date",')
    assert b'\r\n"Data type\n","ImageDataCsv"\r\n' in raw
    assert b'"XY Calibration","250.000","nm"\r\n' in raw
    assert raw.count(b"\n") == raw.count(b"\r\n") + 1


def test_the_export_holds_every_height_within_its_last_digit(tmp_path):
    """A standard CSV reader finds the map again, missing points as empty cells."""
    seen = measure_areal(MAP, Profilometer(missing=0.1), seed=2)
    path = tmp_path / "height.csv"
    write_keyence_csv(seen, path)
    text = path.read_bytes().decode("utf-8-sig")
    rows = list(csv.reader(io.StringIO(text, newline="")))
    first = rows.index(["Height"]) + 1
    cells = np.array([[float(c or "nan") for c in row] for row in rows[first:]])
    assert np.array_equal(np.isfinite(cells), seen.valid)
    assert_allclose(cells[seen.valid] * 1e-6, seen.heights[seen.valid], atol=5.1e-11)


def test_unequal_spacing_is_refused(tmp_path):
    """The format has one calibration for both directions."""
    skewed = Areal(
        "skewed", np.zeros((2, 2)), (1e-6, 2e-6), all_valid(np.zeros((2, 2)))
    )
    with pytest.raises(UsageError, match="resample"):
        write_keyence_csv(skewed, tmp_path / "height.csv")


def test_a_share_of_missing_points_above_one_is_refused():
    """Shares lie in 0..1."""
    with pytest.raises(UsageError, match=r"0\.\.1"):
        Profilometer(missing=1.5)


def test_a_round_tip_touches_a_ridge_with_its_radius():
    """Over a single spike its path is the circle of the tip."""
    heights = np.zeros(201)
    heights[100] = 1e-6
    path = traced(heights, (1e-7,), 5e-6)
    x = 1e-7 * (np.arange(201) - 100)
    circle = 1e-6 - 5e-6 + np.sqrt(25e-12 - x[70:131] ** 2)
    assert_allclose(path[70:131], np.maximum(circle, 0), atol=1e-15)


def test_a_tip_never_goes_below_the_surface():
    """The dilation lies on or above every point of the map, and a point tip on it."""
    path = traced(MAP.heights, MAP.spacing, 2e-6)
    assert np.all(path >= MAP.heights)
    assert traced(MAP.heights, MAP.spacing, 0.0) is MAP.heights


def test_drift_is_a_slow_wave_of_its_size():
    """Half a wave over the scan: no neighbours differ by more than pi / n of it."""
    flat = type(MAP)(
        name="flat",
        heights=np.zeros((50, 40)),
        spacing=(1e-6, 1e-6),
        valid=all_valid(np.zeros((50, 40))),
    )
    seen = measure_areal(flat, Profilometer(noise=0.0, drift=1e-7), seed=4).heights
    assert np.ptp(seen) > 0.4e-7
    assert np.max(np.abs(np.diff(seen.ravel()))) < 1e-7 * np.pi / 2000 + 1e-10
