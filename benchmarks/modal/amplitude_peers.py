# SPDX-License-Identifier: MIT
"""What others do with a decay: Hilbert, short-time Fourier ridge, peaks and crossings.

Each gives points of amplitude, frequency and damping ratio of every hit; the points of
all hits are put into bins of ln amplitude, and the medians joined by straight lines.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import scipy.signal
from kalman_peer import kalman_smoother

Floats = npt.NDArray[np.float64]
Points = tuple[Floats, Floats, Floats]
Peer = Callable[[Floats, float, float, float], Points]

_BIN = 0.35


def band_passed(samples: Floats, rate: float, low: float, high: float) -> Floats:
    """Return samples through a Butterworth filter of order 4, forward and back."""
    sections = scipy.signal.butter(4, (low, high), "bandpass", fs=rate, output="sos")
    return np.asarray(scipy.signal.sosfiltfilt(sections, samples))


def hilbert(samples: Floats, rate: float, frequency: float, ratio: float) -> Points:
    """Slopes of phase and ln envelope of the analytic signal over two periods."""
    signal = scipy.signal.hilbert(samples)
    span = max(8, round(4.0 * rate / frequency))
    phase, level = np.unwrap(np.angle(signal)), np.log(np.abs(signal) + 1e-300)
    turn = (phase[span:] - phase[:-span]) * rate / span
    fall = -(level[span:] - level[:-span]) * rate / span
    middle = slice(span // 2, span // 2 + turn.size)
    return np.exp(level[middle])[::4], (turn / 2 / np.pi)[::4], (fall / turn)[::4]


def short_time(samples: Floats, rate: float, frequency: float, ratio: float) -> Points:
    """Ridge of a Gaussian short-time transform, phase and ln modulus along it."""
    constant = 1.0 / (2 * np.pi * frequency * ratio)
    width = max(3.0 / frequency, 0.15 * constant)
    half = round(3 * width * rate)
    lag = np.arange(-half, half + 1) / rate
    kernel = np.exp(-0.5 * (lag / width) ** 2 + 2j * np.pi * frequency * lag)
    ridge = scipy.signal.fftconvolve(samples, kernel, "same") * 2 / np.abs(kernel).sum()
    inside = ridge[half:-half]
    phase, level = np.unwrap(np.angle(inside)), np.log(np.abs(inside) + 1e-300)
    span = max(2, round(width * rate))
    turn = (phase[2 * span :] - phase[: -2 * span]) * rate / (2 * span)
    fall = -(level[2 * span :] - level[: -2 * span]) * rate / (2 * span)
    size = np.exp(level[span:-span])
    return size[::4], (turn / 2 / np.pi)[::4], (fall / turn)[::4]


def peaks(samples: Floats, rate: float, frequency: float, ratio: float) -> Points:
    """Periods between crossings, logarithmic decrement of crests, over four periods."""
    up = np.flatnonzero((samples[:-1] < 0) & (samples[1:] >= 0))
    time = (up - samples[up] / (samples[up + 1] - samples[up])) / rate
    crests = np.array([samples[a:b].max() for a, b in pairwise(up)])
    if crests.size < 8:
        return np.empty(0), np.empty(0), np.empty(0)
    cycles = 4
    found = cycles / (time[cycles:-1] - time[: -cycles - 1])
    good = np.maximum(crests, 1e-300)
    drop = np.log(good[:-cycles] / good[cycles:]) / (2 * np.pi * cycles)
    return np.sqrt(good[:-cycles] * good[cycles:]), found[: drop.size], drop


PEERS: dict[str, Peer] = {
    "Hilbert": hilbert,
    "short-time Fourier ridge": short_time,
    "peaks, log decrement": peaks,
    "extended Kalman smoother": kalman_smoother,
}


def peer_curve(
    peer: Peer,
    decays: Sequence[Floats],
    rate: float,
    band: tuple[float, float],
    mode: tuple[float, float],
) -> Points:
    """Return a peer's curve from all hits.

    Args:
        peer: one of `PEERS`.
        decays: one channel of each hit.
        rate: [Hz].
        band: that is kept [Hz].
        mode: frequency [Hz] and damping ratio, roughly.
    """
    parts = []
    for samples in decays:
        clean = band_passed(samples, rate, *band)
        noise = 4.0 * np.std(clean[-clean.size // 8 :])
        size, frequency, ratio = peer(clean, rate, *mode)
        skip = max(1, size.size // 50)
        inside = np.zeros(size.size, bool)
        inside[skip:-skip] = True
        inside &= size > noise
        parts.append(np.array([size[inside], frequency[inside], ratio[inside]]))
    pooled = np.concatenate(parts, axis=1)
    bins = np.round(np.log(pooled[0]) / _BIN).astype(int)
    rows = np.array(
        [np.median(pooled[:, bins == one], axis=1) for one in np.unique(bins)]
    )
    return rows[:, 0], rows[:, 1], rows[:, 2]
