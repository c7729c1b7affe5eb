"""The fit of maps over both wavenumbers, on exact maps of closed covariances."""

import numpy as np
import pytest
from lay_surfaces import Embedded, rms_in_rings

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import RollOffVerdict
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum, line_of
from jointbench.signal.band_limited.map_likelihood import MapLikelihood, maximise_map
from jointbench.signal.band_limited.map_parameters import ANGLE
from jointbench.signal.band_limited.map_sample import map_sample
from jointbench.signal.band_limited.seen_bins import seen_bins
from jointbench.signal.band_limited.spectrum_sections import spectrum_sections
from jointbench.signal.surface.complete_patch import complete_patch

PITCH = 1e-6


def drawn(shape, seed, **parts):
    heights, _ = Embedded(shape, **parts).draw(np.random.default_rng(seed))
    return 1e-6 * heights


def areal(heights, valid=None, spacing=(PITCH, PITCH)):
    valid = all_valid(heights) if valid is None else valid
    return Areal("m", np.where(valid, heights, 0.0), spacing, valid)


@pytest.fixture(scope="module")
def turned():
    """Return a map of H 0.6 with a lay at 30 degrees, three times as long along it."""
    parts = {"hurst": 0.6, "along": 36.0, "across": 12.0, "angle": np.radians(30)}
    return drawn((160, 200), 3, **parts)


def test_direction_exponents_and_roll_offs_of_a_lay_are_covered(turned):
    """30 degrees within 2, and one H in both directions."""
    fit = fit_band_limited([areal(turned)])
    lay = fit.lay
    assert fit.mapped
    assert np.degrees(lay.angle.value) == pytest.approx(30, abs=2)
    assert lay.angle.covers(np.radians(30))
    assert lay.ratio.value == pytest.approx(3, rel=0.15)
    assert lay.hurst_along.covers(0.6)
    assert lay.hurst_across.covers(0.6)
    assert lay.roll_off_along.covers(36e-6)
    assert lay.roll_off_across.covers(12e-6)
    waves = fit.moments
    truth = rms_in_rings(
        2 * np.pi / waves.longest,
        2 * np.pi / waves.shortest,
        hurst=0.6,
        along=36e-6,
        across=12e-6,
    )
    assert waves.slope.covers(1e-6 * truth[1])


def test_a_turned_map_has_its_lay_turned(turned):
    """Rows and columns change places: 30 becomes 60 degrees."""
    fit = fit_band_limited([areal(np.ascontiguousarray(turned.T))])
    assert np.degrees(fit.lay.angle.value) == pytest.approx(60, abs=2)


def test_rows_that_are_farther_apart_leave_an_isotropic_map_without_a_lay():
    """Every second row of an isotropic map, at twice the pitch: no lay, H as it was."""
    heights = drawn((240, 120), 5, hurst=0.5, along=20.0, across=20.0)[::2]
    fit = fit_band_limited([areal(heights, spacing=(2 * PITCH, PITCH))])
    assert fit.verdict is RollOffVerdict.SATURATED
    assert fit.lay is None
    assert fit.hurst.covers(0.5)
    assert fit.roll_off.covers(20e-6)


def test_a_search_from_nearly_no_lay_ends_within_half_a_turn(turned):
    """There a step of the angle is unlimited; its last digits would be lost."""
    likelihood = MapLikelihood(seen_bins(map_sample(areal(turned))))
    free = np.array([True, True, True, False, False, True, True, True])
    start = np.array([0.0, 0.6, np.log(30.0), 0.0, 0.0, 1e-13, 0.3, 0.0])
    found = maximise_map(likelihood, start, free)
    assert abs(found.parameters[ANGLE]) <= np.pi


def test_a_roll_off_beyond_the_map_is_not_named():
    """A roll-off of six sides: the limit lies above a tenth of the side."""
    heights = drawn((96, 96), 2, hurst=0.4, along=600.0, across=600.0, margin=3)
    fit = fit_band_limited([areal(heights)])
    assert fit.verdict in {RollOffVerdict.UNDECIDED, RollOffVerdict.FRACTAL}
    assert fit.roll_off_beyond > 10e-6
    assert fit.hurst.covers(0.4)


def test_missing_corners_and_points_leave_the_rest_of_a_map(turned):
    """A masked corner is cut off, single points are interpolated."""
    valid = np.ones(turned.shape, dtype=bool)
    valid[:40, :60] = False
    valid[100::7, 100] = False
    fit = fit_band_limited([areal(turned, valid)])
    assert "120 x 200 points" in fit.reason
    assert np.degrees(fit.lay.angle.value) == pytest.approx(30, abs=2)


def test_the_largest_rectangle_without_gaps():
    """Rows 2 to 9 and columns 3 to 11 of a map with two gaps."""
    heights = np.arange(120.0).reshape(10, 12)
    valid = np.ones((10, 12), dtype=bool)
    valid[:2, 5:11] = False
    valid[2:, :3] = False
    np.testing.assert_array_equal(complete_patch(heights, valid), heights[2:, 3:])


def test_white_heights_are_no_self_affine_surface():
    """The sums of the spectrum are the variance of the waves above four samples."""
    heights = 1e-9 * np.random.default_rng(1).standard_normal((128, 128))
    fit = fit_band_limited([areal(heights)])
    assert fit.verdict is RollOffVerdict.NO_BAND
    assert fit.moments.height.value == pytest.approx(
        1e-9 * np.sqrt(np.pi * (1 / 4) ** 2), rel=0.05
    )


def test_lines_of_a_map_have_the_integral_of_its_spectrum():
    """The line spectrum against a sum over the other wavenumber."""
    model = LaySpectrum(2.0, 0.2, 0.7, 60.0)
    line = line_of(model)
    v = np.sinh(np.linspace(0, 14, 20001))
    for u in (0.05, 0.4):
        total = 2 * np.trapezoid(model.surface(np.full(v.size, u), v), v)
        assert total == pytest.approx(float(line.surface(np.array(u))), rel=1e-3)


def test_the_expected_spectrum_of_bins_is_the_mean_over_maps():
    """40 maps, with images and the smoothing by the taper: within 5 % by wavelength."""
    parts = {"hurst": 0.4, "along": 15.0, "across": 15.0}
    maker, rng = Embedded((64, 64), **parts), np.random.default_rng(8)
    total = 0.0
    for _ in range(20):
        for heights in maker.draw(rng):
            sample = map_sample(areal(heights))
            total = total + sample.power * sample.scale**2 / 40
    # A Matern surface of variance 1: H (q_r^2)^H / (pi (q_r^2 + q^2)^(1 + H)).
    corner = (2 * np.pi / 15) ** 2
    level = 0.4 * corner**0.4 / np.pi / (corner + 0.3**2) ** 1.4
    seen = seen_bins(sample).density(LaySpectrum(level, 0.3, 0.4, 15.0))
    radius = np.hypot(sample.along, sample.down)
    for low, high in ((0.3, 0.8), (0.8, 1.6), (1.6, 2.5), (2.5, 3.1)):
        ring = (radius >= low) & (radius < high)
        ratio = np.average((total / seen)[ring], weights=sample.count[ring])
        assert ratio == pytest.approx(1, abs=0.05)


@pytest.mark.parametrize("angle", [0.0, 0.7, 1.54])
def test_images_of_a_surface_with_a_lay_are_those_of_the_grid(angle):
    """A ratio of 5, next to an axis as well: within 3 % of a sum of 1,600 images."""
    heights = np.random.default_rng(0).standard_normal((96, 96))
    sample = map_sample(areal(heights))
    model = LaySpectrum(1.0, 0.3, 0.8, 40.0, ratio=5.0, angle=angle)
    shifts = 2 * np.pi * np.arange(-20, 21)
    short = np.hypot(sample.along, sample.down) > 1.0
    along, down = sample.along[short], sample.down[short]
    summed = sum(model.surface(along + k, down + j) for k in shifts for j in shifts)
    found = seen_bins(sample).density(model)[short]
    np.testing.assert_allclose(found, summed, rtol=0.03)


def test_sections_show_the_spectrum_along_and_across_a_lay(turned):
    """Across the lay there is more power at one wavelength, and the fit follows."""
    surface = areal(turned)
    along, across = spectrum_sections(surface, fit_band_limited([surface]))
    assert (along.name, across.name) == ("along the lay", "across the lay")
    middle = np.argmin(np.abs(np.log(across.wavelength / 12e-6)))
    assert across.measured[middle] > 5 * along.measured[middle]
    assert abs(float(np.average(across.residual, weights=across.count))) < 0.05
