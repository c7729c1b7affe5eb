"""Filter, decimation, quantisation and cutting into blocks."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.signal
from numpy.testing import assert_allclose

from jointbench.simulators.measuring.converter import (
    AntiAlias,
    Digitiser,
    decimate,
    recut,
)


def _pieces(stream, *sizes):
    edges = np.cumsum((0, *sizes))
    return [stream[:, a:b] for a, b in pairwise(edges)]


def _tone(frequency, samples, filter_):
    """A tone of `frequency` over the sample rate, at the steps of the plant."""
    time = np.arange(samples * filter_.oversampling) / filter_.oversampling
    return np.cos(2 * np.pi * frequency * time)[None, :]


def test_a_tone_in_the_pass_band_keeps_its_height_and_time():
    """0.3 of the sample rate goes through unchanged, without delay."""
    filter_ = AntiAlias()
    (samples,) = decimate([_tone(0.3, 400, filter_)], filter_)
    middle = np.arange(100, 300)
    expected = np.cos(2 * np.pi * 0.3 * middle)
    # 90 dB of attenuation is a ripple of 3e-5.
    assert_allclose(samples[0, middle], expected, atol=4e-5)


def test_a_tone_in_the_stop_band_is_gone():
    """0.7 of the sample rate would alias to 0.3; it is down by 90 dB."""
    filter_ = AntiAlias()
    (samples,) = decimate([_tone(0.7, 400, filter_)], filter_)
    assert np.abs(samples[0, 100:300]).max() < 4e-5


@pytest.mark.parametrize(
    "filter_", [AntiAlias(), AntiAlias(16, 0.395, 0.445, 90.0), AntiAlias(4, 0.4, 0.6)]
)
def test_filter_and_decimation_are_those_of_scipy_signal(filter_: AntiAlias) -> None:
    """Length and taps of its Kaiser design, samples of its polyphase filter."""
    every, width = filter_.oversampling, filter_.stop_band - filter_.pass_band
    taps, beta = scipy.signal.kaiserord(filter_.attenuation, 2 * width / every)
    half = every * int(np.ceil(taps / (2 * every)))
    edge = (filter_.pass_band + filter_.stop_band) / every
    design = scipy.signal.firwin(2 * half + 1, edge, window=("kaiser", beta))
    assert_allclose(filter_.taps(), design, rtol=1e-13, atol=1e-17)
    stream = np.random.default_rng(2).standard_normal((2, 600 * every))
    full = scipy.signal.upfirdn(design, stream, up=1, down=every, axis=1)
    (samples,) = decimate([stream], filter_)
    first = half // every
    assert_allclose(samples, full[:, first : first + samples.shape[1]], atol=1e-13)


def test_the_cut_of_the_stream_does_not_change_the_samples():
    """One piece or four, the samples are the same."""
    filter_ = AntiAlias()
    stream = np.random.default_rng(1).standard_normal((2, 8000))
    (whole,) = decimate([stream], filter_)
    pieces = list(decimate(_pieces(stream, 100, 3000, 17, 4883), filter_))
    assert_allclose(np.hstack(pieces), whole, rtol=0, atol=1e-14)


def test_the_digitiser_clips_at_its_range():
    """Full scale is the range below and one count less above."""
    digitiser = Digitiser(range=10.0, noise=0.0, bits=16)
    values = digitiser.digitise(np.array([25.0, -25.0]), np.random.default_rng(1))
    assert_allclose(values, [10 - 10 / 2**15, -10.0], rtol=1e-15)


def test_the_digitiser_rounds_to_the_nearest_count():
    """The error of quantisation is at most half a count."""
    digitiser = Digitiser(range=8.0, noise=0.0, bits=12)
    exact = np.linspace(-7.9, 7.9, 1001)
    error = digitiser.digitise(exact, np.random.default_rng(1)) - exact
    assert np.abs(error).max() <= 0.5 * 8 / 2**11 * (1 + 1e-9)


def test_the_noise_has_the_stated_standard_deviation():
    """Within 4 sigma of its own scatter at 10,000 samples."""
    digitiser = Digitiser(range=10.0, noise=0.02)
    noise = digitiser.digitise(np.zeros(10_000), np.random.default_rng(4))
    assert abs(noise.std() / 0.02 - 1) < 4 / np.sqrt(2 * 10_000)


def test_recut_blocks_join_to_the_stream():
    """Blocks of seven, the last one short, nothing lost."""
    stream = np.arange(40.0).reshape(2, 20)
    blocks = list(recut(_pieces(stream, 3, 9, 8), block=7, total=18))
    assert [block.shape[1] for block in blocks] == [7, 7, 4]
    assert np.array_equal(np.hstack(blocks), stream[:, :18])
