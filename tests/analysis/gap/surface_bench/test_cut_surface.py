"""Spectrum and skewness of a cut surface against lines that were cut."""

import itertools

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import skew

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.surface_bench.cut_surface import (
    correlation_bells,
    cut_surface,
)
from jointbench.signal.band_limited.matern_spectrum import BandLimited

POINTS = 400_000


def exponential(length: float, variance: float) -> BandLimited:
    """Return a process with covariance variance exp(-lag / length)."""
    corner = 1 / length
    return BandLimited(variance / (2 * np.pi * corner), corner, 0.5, 2 * np.pi * length)


def line(length: float, variance: float, rng: np.random.Generator) -> FloatArray:
    """Return samples of it, exact by a recursion."""
    keep = np.exp(-1 / length)
    white = rng.standard_normal(POINTS) * np.sqrt(variance * (1 - keep**2))
    return np.asarray(lfilter([1.0], [1.0, -keep], white))


@pytest.mark.parametrize("level", [-0.7, 0.0, 0.8])
def test_a_cut_line_has_its_spectrum_and_skewness(level: float) -> None:
    """Ordinates of the lower of two lines, in bands of 2,000 and more, within 8 %."""
    rng = np.random.default_rng(3)
    found = cut_surface(exponential(20.0, 1.0), exponential(4.0, 0.02), level)
    z = np.minimum(line(20.0, 1.0, rng), level + line(4.0, 0.02, rng))
    assert found.skewness == pytest.approx(skew(z), abs=0.05)
    power = np.abs(np.fft.rfft(z - z.mean())) ** 2 / (2 * np.pi * POINTS)
    omega = 2 * np.pi * np.arange(power.size) / POINTS
    images = 2 * np.pi * np.arange(-30, 31)
    edges = np.geomspace(0.03, 3.1, 12)
    for low, high in itertools.pairwise(edges):
        own = (omega >= low) & (omega < high)
        place = np.linspace(low, high, 9)
        expected = found.surface(np.abs(place[:, None] + images)).sum(axis=1)
        assert power[own].mean() == pytest.approx(expected.mean(), rel=0.08)


def test_a_level_far_above_leaves_the_rough_surface() -> None:
    """Nothing is cut: density of the process to 1e-3, no skewness."""
    rough = exponential(20.0, 1.0)
    found = cut_surface(rough, exponential(4.0, 0.02), 6.0)
    omega = np.geomspace(1e-3, 20.0, 50)
    np.testing.assert_allclose(found.surface(omega), rough.surface(omega), rtol=1e-3)
    assert abs(found.skewness) < 1e-3


def test_bells_are_the_correlation_of_the_process() -> None:
    """exp(-lag) of H = 1/2 to 1e-5, and its variance."""
    bells = correlation_bells(exponential(20.0, 3.0))
    lag = np.geomspace(1e-4, 8.0, 40)
    np.testing.assert_allclose(bells.missing(lag), 1 - np.exp(-lag), rtol=1e-5)
    assert bells.variance == pytest.approx(3.0, rel=1e-5)
