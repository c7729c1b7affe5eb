# SPDX-License-Identifier: MIT
"""Closed forms of what instruments and levelling do to a self-affine surface."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from jointbench.signal.fractal.instrument_blur import (
    band_limited_power,
    blurred_power,
    tip_fall,
    traced_power,
)
from jointbench.signal.fractal.levelling_loss import levelling_loss
from jointbench.signal.fractal.self_affine import SeenSurface, rolled_off
from jointbench.signal.surface.structure_constant import spectral_integral

EXPONENTS = [0.5, 1.0, 1.5]


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("lag", [0.5, 2.0, 9.0, 40.0])
def test_a_blurred_profile_has_the_spectrum_times_the_transfer(
    exponent: float, lag: float
):
    """The Kummer form equals the integral of q^(-1-s) exp(-q^2 w^2) (1 - cos q lag)."""
    width = 1.3

    def density(q: float) -> float:
        return q ** (-1 - exponent) * np.exp(-((q * width) ** 2)) * 2

    integral = sum(
        quad(lambda q: density(q) * np.sin(q * lag / 2) ** 2, a, b, limit=400)[0]
        for a, b in ((0, 0.1), (0.1, 1), (1, 10))
    )
    found = blurred_power(np.array([lag]), exponent, width, 1)[0]
    assert found == pytest.approx(integral / spectral_integral(exponent), rel=1e-6)


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("lag", [0.5, 2.0, 9.0, 40.0])
def test_the_path_of_a_tip_has_the_spectrum_times_its_transfer(
    exponent: float, lag: float
):
    """The mean over blurs equals the integral with (1 + q^2 w^2 / n)^-n."""
    width, fall = 1.3, tip_fall(exponent)

    def density(q: float) -> float:
        return q ** (-1 - exponent) * (1 + (q * width) ** 2 / fall) ** -fall * 2

    edges = np.geomspace(1e-10, 300.0, 35)
    integral = sum(
        quad(lambda q: density(q) * np.sin(q * lag / 2) ** 2, a, b, limit=2000)[0]
        for a, b in itertools.pairwise(edges)
    )
    found = traced_power(np.array([lag]), exponent, width)[0]
    assert found == pytest.approx(integral / spectral_integral(exponent), rel=3e-3)


@pytest.mark.parametrize("axes", [1, 2])
def test_the_far_form_of_the_blur_joins_the_near_one(axes: int):
    """Both sides of the change of formula follow one smooth curve."""
    edge = 2 * 1.7 * np.sqrt(40.0)
    low, high = blurred_power(np.array([edge - 1e-6, edge + 1e-6]), 1.2, 1.7, axes)
    assert high == pytest.approx(low, rel=1e-6)
    assert high != low


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("lag", [1.0, 2.5, 30.0])
def test_a_band_limited_profile_has_its_spectrum_up_to_nyquist(
    exponent: float, lag: float
):
    """The closed form equals the integral of q^(-1-s) (1 - cos q lag) up to pi."""
    integral = quad(
        lambda q: q ** (-1 - exponent) * 2 * np.sin(q * lag / 2) ** 2,
        0,
        np.pi,
        limit=400,
    )[0]
    found = band_limited_power(np.array([lag]), exponent, 1)[0]
    assert found == pytest.approx(integral / spectral_integral(exponent), rel=1e-6)


def test_a_band_limited_map_matches_a_sum_over_its_waves():
    """A rough map (s = 0.5) of 1024 x 1024 waves: ratios to lag 1 within 0.1 %."""
    q = 2 * np.pi * np.fft.fftfreq(1024)
    square = q[:, None] ** 2 + q**2
    square[0, 0] = np.inf
    power = np.sum(square ** (-(2 + 0.5) / 2), axis=1)
    lags = np.array([1.0, 2.0, 3.0, 5.0])
    waves = np.array([np.sum(power * (1 - np.cos(q * lag))) for lag in lags])
    found = band_limited_power(lags, 0.5, 2)
    assert_allclose(found / found[0], waves / waves[0], rtol=1e-3)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_the_levelling_loss_is_that_of_a_least_squares_line(exponent: float):
    """Levelling 400 points as a matrix on the covariance -|i-j|^s / 2 loses the same.

    The matrix works on whole points; at 400 of them it is within 0.5 % of the
    continuous line.
    """
    count = 400
    t = (np.arange(count) + 0.5) / count
    kernel = -0.5 * np.abs(t[:, None] - t) ** exponent
    slope = (t - 0.5) / np.sum((t - 0.5) ** 2)
    project = np.eye(count) - np.outer(t - 0.5, slope) - 1 / count
    levelled = project @ kernel @ project.T
    variance = np.diag(levelled)
    for lag in (4, 40, 120):
        left = np.mean(variance[lag:] + variance[:-lag] - 2 * np.diag(levelled, lag))
        loss = (lag / count) ** exponent - left
        found = levelling_loss(np.array([lag / count]), exponent)[0]
        assert found == pytest.approx(loss, rel=5e-3)


def test_noise_adds_twice_its_variance_at_every_lag_but_zero():
    """White noise of variance 4 lifts S by 8, and S(0) stays 0."""
    plain, noisy = SeenSurface(1.0, 2.0), SeenSurface(1.0, 2.0, noise=4.0)
    lag = np.array([0.0, 1.0, 5.0])
    assert_allclose(noisy.seen(lag) - plain.seen(lag), [0, 8, 8])


def test_a_corner_bends_the_power_law_to_its_ceiling():
    """Far below the corner S is the power law, far above it the ceiling."""
    seen = SeenSurface(1.0, 1.0, corner=100.0)
    assert_allclose(seen.seen(np.array([0.1, 1e5])), [0.1, 100.0], rtol=1e-3)
    assert rolled_off(np.array([100.0]), 100.0)[0] == pytest.approx(
        100 * (1 - 1 / np.e)
    )
