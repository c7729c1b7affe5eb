"""The band-limited fit on surfaces from other generators than spectra."""

import numpy as np
import pytest
from scipy.linalg import cholesky, toeplitz
from scipy.optimize import minimize
from scipy.signal import lfilter
from scipy.special import gamma, kv

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import (
    Areal,
    Profile,
    SurfaceInstrument,
    all_valid,
)
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import RollOffVerdict
from jointbench.signal.band_limited.block_means import (
    BlockMeans,
    block_means,
    kernel_of,
    toeplitz_log_likelihood,
)
from jointbench.signal.band_limited.known_transfer import KnownTransfer
from jointbench.signal.band_limited.line_sample import line_sample
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.band_limited.spectral_likelihood import SpectralLikelihood
from jointbench.signal.surface.gaussian_filter import filter_waves
from jointbench.signal.surface.line_spectrum import line_spectrum
from jointbench.simulators.rough_surfaces.brownian import brownian_lines
from jointbench.simulators.rough_surfaces.profilometer import traced
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

PITCH = 1e-6


def matern(points, hurst, roll_off):
    """Return the covariance at lags 0, 1, ... in closed form, of variance 1."""
    lag = 2 * np.pi * np.arange(1, points) / roll_off
    value = 2 ** (1 - hurst) / gamma(hurst) * lag**hurst * kv(hurst, lag)
    return np.concatenate([[1.0], value])


def exponential(points, length, seed, *, height=1e-6):
    """Return a profile of exponential correlation: an autoregressive process."""
    keep = np.exp(-1 / length)
    white = np.random.default_rng([seed, length]).standard_normal(points)
    white[1:] *= np.sqrt(1 - keep**2)
    heights = height * lfilter([1.0], [1.0, -keep], white)
    return Profile(f"e{seed}", heights, PITCH, all_valid(heights))


def test_the_covariance_of_block_means_is_that_of_the_matern_process():
    """The integral over cells against the closed covariance, summed over the blocks."""
    points, count, size = 512, 64, 8
    model = BandLimited(1.0, 0.05, 0.6, 100.0)
    omega, kernel = kernel_of(count, size)
    found = kernel @ model.sampled(omega, KnownTransfer())
    mean = np.kron(np.eye(count), np.ones((1, size)) / size)
    exact = (mean @ toeplitz(matern(points, 0.6, 100.0)) @ mean.T)[0]
    level = model.level * (1 + (0.05 * 100 / 2 / np.pi) ** 2) ** 1.1
    variance = level * 2 * np.pi / 100 * np.sqrt(np.pi) * gamma(0.6) / gamma(1.1)
    assert found == pytest.approx(variance * exact, abs=3e-4 * variance)


def test_a_polynomial_leaves_the_likelihood_of_block_means_unchanged():
    """A tilt of any size is no roughness."""
    lines = np.random.default_rng(1).standard_normal((1, 512)).cumsum(axis=1)
    omega, _ = kernel_of(64, 8)
    density = BandLimited(1.0, 0.1, 0.5, 1e4).sampled(omega, KnownTransfer())
    tilted = lines + 50 * np.linspace(-1, 1, 512) + 7
    level, other = (
        block_means(one, 64, 1).log_likelihood(density) for one in (lines, tilted)
    )
    assert other == pytest.approx(level, abs=1e-6)


def test_the_roll_off_ends_where_the_likelihood_has_fallen():
    """Against a search that uses no derivative: a ratio test at 5 % has 3.84."""
    profile = exponential(1500, 40, 3)
    found = fit_band_limited([profile])
    likelihood = SpectralLikelihood(line_sample([profile]))
    model = found.model

    def lost(level_and_hurst, roll_off):
        level, hurst = level_and_hurst
        return -likelihood(np.array([level, hurst, np.log(roll_off / PITCH), 0.0, 0.0]))

    start = np.array([np.log(model.level), model.hurst])
    ends = (found.roll_off.value, found.roll_off.low, found.roll_off.high)
    values = [
        minimize(lost, start, args=(one,), method="Nelder-Mead").fun for one in ends
    ]
    assert 2 * (values[1] - values[0]) > 3.5
    assert 2 * (values[2] - values[0]) > 3.5


def test_intervals_cover_h_roll_off_and_moments():
    """6 exact profiles, H 0.7, roll-off at a tenth: few intervals miss."""
    points, hurst, roll_off = 1500, 0.7, 150.0
    root = cholesky(toeplitz(matern(points, hurst, roll_off)), lower=True)
    rng = np.random.default_rng(11)
    hits = []
    for _ in range(6):
        heights = 1e-6 * root @ rng.standard_normal(points)
        fit = fit_band_limited([Profile("m", heights, PITCH, all_valid(heights))])
        assert fit.verdict is RollOffVerdict.SATURATED
        hits.append(
            (
                fit.hurst.covers(hurst),
                fit.roll_off.covers(roll_off * PITCH),
                fit.height.covers(1e-6),
            )
        )
    assert np.sum(hits, axis=0).min() >= 4


def test_noise_whose_likeliest_size_is_nothing_may_still_be_there():
    """The draws have models with it, of less weight than those without."""
    fit = fit_band_limited([exponential(3000, 60, 1)])
    assert fit.noise == 0
    noisy = np.array([model.noise > 0 for model in fit.draws.models])
    share = float(np.sum(np.array(fit.draws.weight)[noisy]))
    assert 0.01 < share < 0.5


def test_exponential_correlation_of_400_of_16000_points_is_saturated():
    """2 pi 400 points is the roll-off; H is 1/2."""
    fit = fit_band_limited([exponential(16_000, 400, 1)])
    assert fit.verdict is RollOffVerdict.SATURATED
    assert fit.roll_off.covers(2 * np.pi * 400 * PITCH)
    assert fit.hurst.covers(0.5)


def test_a_fractal_profile_is_fractal_or_too_short_to_decide():
    """The limit of the roll-off lies above a tenth of the length."""
    rough = rough_profile(4000, spacing=PITCH, dimension=1.6, roughness=1e-10, seed=4)
    fit = fit_band_limited([rough])
    assert fit.verdict in {RollOffVerdict.UNDECIDED, RollOffVerdict.FRACTAL}
    assert fit.roll_off is None
    assert fit.roll_off_beyond > 0.1 * rough.length
    assert fit.hurst.covers(0.4)


def test_profiles_of_one_surface_narrow_the_interval():
    """Four profiles: half the interval of H, and the roll-off of 2 pi 100."""
    profiles = [exponential(2000, 100, seed) for seed in range(4)]
    alone, pooled = fit_band_limited(profiles[:1]), fit_band_limited(profiles)
    ratio = (pooled.hurst.high - pooled.hurst.low) / (
        alone.hurst.high - alone.hurst.low
    )
    assert 0.3 < ratio < 0.75
    assert pooled.roll_off.covers(2 * np.pi * 100 * PITCH)


def test_a_stated_filter_is_no_property_of_the_surface():
    """lambda_s of 20 samples: the moments begin there, and H is that of the surface."""
    found = fit_band_limited([filter_waves(exponential(8000, 60, 6), short=20e-6)])
    assert found.moments.shortest >= 20e-6
    assert found.hurst.covers(0.5)
    assert found.roll_off.covers(2 * np.pi * 60 * PITCH)
    assert found.short_cut.low == 0


def test_lambda_c_next_to_a_primary_profile_is_not_applied():
    """A cut-off that the file states counts only where the export is filtered."""
    plain = exponential(4000, 50, 6)
    stated = Profile(
        "p", plain.heights, PITCH, plain.valid, SurfaceInstrument(cutoff_long=5e-4)
    )
    assert fit_band_limited([stated]).moments.longest == pytest.approx(4e-3)
    assert fit_band_limited([filter_waves(plain, long=5e-4)]).moments.longest == 5e-4


def test_two_processes_have_moments_but_no_self_affine_band():
    """A smooth and a jagged surface together: sums of the measured spectrum remain."""
    jagged = exponential(3000, 3, 7, height=1e-7).heights
    smooth = np.convolve(
        np.random.default_rng(8).standard_normal(3100), np.hanning(101), mode="valid"
    )
    heights = jagged + 3e-7 * smooth
    fit = fit_band_limited([Profile("two", heights, PITCH, all_valid(heights))])
    assert fit.verdict is RollOffVerdict.NO_BAND
    assert not fit.moments.modelled
    assert fit.moments.height.value == pytest.approx(np.std(heights), rel=0.25)


def test_short_lines_are_refused_with_the_remedy():
    heights = np.random.default_rng(1).standard_normal(60)
    with pytest.raises(UsageError, match="measure a longer line"):
        fit_band_limited([Profile("short", heights, PITCH, all_valid(heights))])


def test_a_stated_stylus_explains_the_short_cut_and_a_wrong_one_does_not():
    """The exact path of a tip of 5 um, traced on eight times as many points."""
    fine, pitch, radius = 8, 0.25e-6, 5e-6
    line = brownian_lines(1, 3000 * fine, 0.5, np.random.default_rng(3))[0]
    heights = traced(20e-9 * fine**-0.5 * line, (pitch / fine,), radius)[::fine]

    def found(stated):
        given = SurfaceInstrument(stylus_radius=stated)
        valid = all_valid(heights)
        return fit_band_limited([Profile("t", heights, pitch, valid, given)])

    right = found(radius)
    assert abs(right.tip_deviation) < 3
    assert right.hurst.covers(0.5)
    assert abs(found(10 * radius).tip_deviation) > 3


@pytest.mark.parametrize("shape", [(300,), (80, 80)])
def test_a_plane_is_refused(shape):
    """Nothing is left of it but rounding, in a profile and in a map."""
    heights = np.linspace(0, 1e-6, np.prod(shape)).reshape(shape)
    valid = all_valid(heights)
    flat = (
        Profile("flat", heights, PITCH, valid)
        if len(shape) == 1
        else Areal("flat", heights, (PITCH, PITCH), valid)
    )
    with pytest.raises(UsageError, match="no roughness to fit"):
        fit_band_limited([flat])
    assert line_spectrum(flat) is not None


def test_the_likelihood_of_even_spacing_is_that_of_a_factor_of_the_covariance():
    """By LAPACK: whitened by the Cholesky factor, the trend taken out by QR."""
    lag = np.arange(64.0)
    covariance = np.exp(-lag / 20)
    trend = np.polynomial.legendre.legvander(np.linspace(-1, 1, 64), 2)
    data = np.random.default_rng(5).standard_normal((64, 3)).cumsum(axis=0)
    blocks = BlockMeans(data, 1, np.ascontiguousarray(trend))
    factor = np.linalg.cholesky(covariance[np.abs(lag[:, None] - lag).astype(int)])
    triangle = np.linalg.qr(np.linalg.solve(factor, np.hstack([trend, data])), "r")
    logs = np.log(np.diag(factor)).sum() + np.log(abs(np.diag(triangle)[:3])).sum()
    right = -0.5 * np.sum(triangle[3:, 3:] ** 2) - 3 * logs
    found = toeplitz_log_likelihood(covariance, blocks.trend, blocks.means)
    assert found == pytest.approx(right, rel=1e-10)


def test_a_covariance_that_is_not_positive_has_no_likelihood():
    """White heights less than nothing at the next distance."""
    blocks = BlockMeans(np.ones((4, 1)), 1, np.ones((4, 1)))
    found = toeplitz_log_likelihood(
        np.array([1.0, -0.8, 0.9, 1.2]), blocks.trend, blocks.means
    )
    assert np.isnan(found)


@pytest.mark.parametrize("blur", [0.0, 0.3, 4.0])
def test_images_near_zero_are_those_of_their_sum(blur):
    """Shifted by one whole turn the spectrum of samples is the same."""
    model = BandLimited(1.0, 0.1, 0.4, 500.0, blur)
    omega = np.geomspace(1e-4, 0.0999, 50)
    shift = 2 * np.pi * np.arange(-3, 4)[:, None]
    place = np.abs(omega + shift)
    summed = (model.surface(place) * model.short_cut(place, tip=False)).sum(axis=0)
    edge = np.array(7 * np.pi)
    beyond = model.surface(edge) * model.short_cut(edge, tip=False) * 7 / 0.8
    found = model.sampled(omega, KnownTransfer())
    np.testing.assert_allclose(found, summed + beyond, rtol=1e-11)
