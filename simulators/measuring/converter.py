# SPDX-License-Identifier: MIT
"""Measuring channel: filter, noise, range and quantisation."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy.special

from jointbench.acquisition.basics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class AntiAlias:
    """The linear-phase filter of a sigma-delta converter.

    Attributes:
        oversampling: steps of the plant per sample [-].
        pass_band: edge of the pass band over the sample rate [-].
        stop_band: edge of the stop band over the sample rate [-].
        attenuation: in the stop band [dB].
    """

    oversampling: int = 8
    pass_band: float = 0.42
    stop_band: float = 0.56
    attenuation: float = 90.0

    @property
    def half_length(self) -> int:
        """Taps on each side of the middle one; whole samples."""
        width = 2 * np.pi * (self.stop_band - self.pass_band) / self.oversampling
        taps = np.ceil((self.attenuation - 7.95) / (2.285 * width) + 1)
        return self.oversampling * int(np.ceil(taps / (2 * self.oversampling)))

    def taps(self) -> FloatArray:
        """Return the symmetric impulse response [-], shape (2 half_length + 1,).

        Of unit gain at standstill. `scipy.signal` designs the same filter, at the price
        of half a second of imports for every command that simulates.

        Source:
            Kaiser 1974, Proc. IEEE ISCAS, 20; Oppenheim and Schafer 2010, sec. 7.5.3.
        """
        half = self.half_length
        edge = (self.pass_band + self.stop_band) / self.oversampling
        step = np.arange(-half, half + 1)
        shape = _kaiser_shape(self.attenuation)
        window = scipy.special.i0(shape * np.sqrt(1 - (step / half) ** 2.0))
        taps = edge * np.sinc(edge * step) * (window / scipy.special.i0(shape))
        return np.asarray(taps / taps.sum(), dtype=float)


def _kaiser_shape(attenuation: float) -> float:
    """Return the shape of Kaiser's window for an attenuation above 50 dB."""
    return 0.1102 * (attenuation - 8.7)


@dataclass(frozen=True, slots=True)
class Digitiser:
    """One input of the converter.

    Attributes:
        range: largest value of either sign [SI unit].
        noise: standard deviation of the white noise of the sensor [SI unit].
        bits: of the converter, sign included.
    """

    range: float
    noise: float
    bits: int = 24

    def digitise(self, values: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Add noise, clip at the range and round to the nearest count.

        Args:
            values: filtered signal [SI unit].
            rng: source of the noise.

        Returns:
            Output of the driver [SI unit], same shape.
        """
        return self.round(values + self.noise * rng.standard_normal(values.shape))

    def round(self, values: FloatArray) -> FloatArray:
        """Clip at the range and round to the nearest count, without adding noise."""
        count = self.range / 2 ** (self.bits - 1)
        counts = np.round(values / count) * count
        return np.asarray(np.clip(counts, -self.range, self.range - count), dtype=float)


def decimate(chunks: Iterable[FloatArray], filter_: AntiAlias) -> Iterator[FloatArray]:
    """Filter and decimate a stream that was silent before its first sample.

    The filter is centred: a sample keeps its time, and needs `half_length` steps of
    the stream beyond it, so the last few samples of a stream are not delivered.

    Args:
        chunks: successive pieces of the stream, shape (n_channels, any).
        filter_: filter and oversampling.

    Yields:
        Samples, shape (n_channels, n); they do not depend on the chunks.
    """
    taps, half, every = filter_.taps(), filter_.half_length, filter_.oversampling
    waiting: FloatArray | None = None
    for chunk in chunks:
        if waiting is None:
            waiting = np.zeros((chunk.shape[0], half))
        waiting = np.concatenate((waiting, chunk), axis=1)
        ready = (waiting.shape[1] - 2 * half - 1) // every + 1
        if ready > 0:
            used = waiting[:, : (ready - 1) * every + 2 * half + 1]
            pieces = np.lib.stride_tricks.sliding_window_view(used, taps.size, axis=1)
            yield pieces[:, ::every] @ taps
            waiting = waiting[:, ready * every :]


def recut(
    chunks: Iterable[FloatArray], *, block: int, total: int
) -> Iterator[FloatArray]:
    """Cut a stream into blocks of `block` samples, `total` in all; the last is short.

    Args:
        chunks: successive pieces, shape (n_channels, any), at least `total` together.
        block: samples per block.
        total: samples to deliver.

    Yields:
        Blocks, shape (n_channels, block).
    """
    waiting: FloatArray | None = None
    left = total
    for chunk in chunks:
        waiting = chunk if waiting is None else np.concatenate((waiting, chunk), axis=1)
        while left > 0 and waiting.shape[1] >= min(block, left):
            size = min(block, left)
            yield np.ascontiguousarray(waiting[:, :size])
            waiting = waiting[:, size:]
            left -= size
        if left <= 0:  # the input stream may be endless
            return
