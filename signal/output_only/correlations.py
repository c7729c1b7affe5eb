# SPDX-License-Identifier: MIT
"""Correlations of responses alone: the data of output-only modal identification.

Under unmeasured broadband excitation, the correlation functions of the responses decay
with the poles of the structure. They are kept block by block, because the scatter
between blocks gives the uncertainty of all results.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Recording, response_rows

# Samples per period of the highest frequency of interest.
_SAMPLES_PER_PERIOD = 2.56
# Every output serves as a reference up to this many; of more, the most independent.
_MOST_REFERENCES = 4
# Least length of a block in spans of the lags; shorter ones lose the correlation.
_LEAST_SPANS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Correlations:
    """Correlation functions of the responses, block by block.

    Attributes:
        sample_rate: after decimation [Hz].
        blocks: of responses scaled to unit rms [-], shape
            (n_blocks, n_lags, n_outputs, n_references); lag i is i samples.
        scale: rms of each response [its unit], shape (n_outputs,).
        references: rows of the outputs that serve as references.
    """

    sample_rate: float
    blocks: FloatArray
    scale: FloatArray
    references: IntArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "blocks", "scale", "references")

    @property
    def mean(self) -> FloatArray:
        """Over all blocks, shape (n_lags, n_outputs, n_references)."""
        return np.asarray(self.blocks.mean(axis=0))

    def without(self, block: int) -> FloatArray:
        """Mean over all blocks but one, shape (n_lags, n_outputs, n_references)."""
        n_blocks = self.blocks.shape[0]
        return np.asarray((n_blocks * self.mean - self.blocks[block]) / (n_blocks - 1))


def correlate_responses(
    recording: Recording, *, highest: float, n_lags: int, n_blocks: int
) -> Correlations:
    """Correlate the responses of a recording with each other.

    Args:
        recording: its forces, if any, are not used.
        highest: frequency of interest [Hz]; a zero-phase filter, the same for all
            channels, removes what is above.
        n_lags: of the correlation functions, zero lag included.
        n_blocks: of equal length; each overlaps the next by the lags, so that no
            products are lost at their borders.

    Returns:
        Unbiased estimates at the decimated rate.

    Raises:
        BadData: the record is too short, or a response is constant.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 11.4 (by way of the FFT).
    """
    responses = recording.samples[list(response_rows(recording))]
    step = max(1, int(recording.sample_rate / (_SAMPLES_PER_PERIOD * highest)))
    if step > 1:
        from scipy.signal import decimate  # slow to import

        responses = decimate(responses, step, ftype="fir", axis=1)
    responses = responses - responses.mean(axis=1, keepdims=True)
    rate = recording.sample_rate / step
    length = (responses.shape[1] - n_lags) // n_blocks
    _require_long(recording, length, n_lags, rate, n_blocks)
    scale = _alive(recording, responses)
    scaled = responses / scale[:, None]
    references = _references(scaled)
    blocks = [
        _correlate(
            scaled[:, i * length : (i + 1) * length + n_lags], references, n_lags
        )
        for i in range(n_blocks)
    ]
    return Correlations(rate, np.array(blocks), scale, references)


def _correlate(samples: FloatArray, references: IntArray, n_lags: int) -> FloatArray:
    """Return sum of y(t + lag) x(t) over a block, shape (n_lags, n_out, n_ref)."""
    length = samples.shape[1] - n_lags
    points = scipy.fft.next_fast_len(samples.shape[1] + n_lags, real=True)
    ahead = scipy.fft.rfft(samples, points, axis=1)
    here = scipy.fft.rfft(samples[references, :length], points, axis=1)
    pairs = ahead[:, None] * here.conj()[None]
    lagged = scipy.fft.irfft(pairs, points, axis=2)[:, :, :n_lags] / length
    return np.asarray(lagged.transpose(2, 0, 1))


def _references(scaled: FloatArray) -> IntArray:
    """Choose references by pivoted elimination: each as independent as possible."""
    if scaled.shape[0] <= _MOST_REFERENCES:
        return np.arange(scaled.shape[0])
    _, pivots = scipy.linalg.qr(scaled @ scaled.T, mode="r", pivoting=True)
    return np.sort(np.asarray(pivots[:_MOST_REFERENCES], np.int64))


def _require_long(
    recording: Recording, length: int, n_lags: int, rate: float, n_blocks: int
) -> None:
    if length < _LEAST_SPANS * n_lags:
        needed = (n_blocks * _LEAST_SPANS + 1) * n_lags / rate
        has = recording.samples.shape[1] / recording.sample_rate
        raise BadData(
            f"recording {recording.name!r} lasts {has:.3g} s, {needed:.3g} s are "
            "needed for modes and their scatter from responses alone; record longer"
        )


def _alive(recording: Recording, responses: FloatArray) -> FloatArray:
    """Return the rms of each response; refuse a constant one by name."""
    rms = np.asarray(np.sqrt(np.mean(responses**2, axis=1)))
    for row, level in zip(response_rows(recording), rms, strict=True):
        largest = float(np.abs(recording.samples[row]).max())
        if level <= 1e-12 * largest or level == 0.0:
            raise BadData(
                f"recording {recording.name!r}: channel "
                f"{recording.channels[row].name!r} is constant; check its cable, or "
                "leave it out"
            )
    return rms
