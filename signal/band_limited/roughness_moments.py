# SPDX-License-Identifier: MIT
"""Root mean squares of height, slope and curvature between two wavelengths."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.band_records import (
    Interval95,
    LineDensity,
    RoughnessMoments,
)
from jointbench.signal.band_limited.line_sample import LineSample
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.band_limited.moment_units import in_metres
from jointbench.signal.band_limited.spectral_likelihood import SpectralLikelihood
from jointbench.signal.band_limited.weighted_draws import WeightedDraws
from jointbench.signal.fractal.verdict_records import NORMAL_97_5

_NODES = 300
RESOLVED = 4.0
"""Shortest wavelength of the moments [samples]: two samples are alias and noise."""
_CUT_HALF = 2 * np.pi / np.sqrt(2 * np.log(2))
"""Wavelength at which a Gaussian blur transmits half the amplitude, over its width."""


def spectral_moments(
    models: Sequence[BandLimited], low: float, high: float
) -> FloatArray:
    """Return the integrals of q^0, q^2 and q^4 times the two-sided density.

    Args:
        models: surfaces.
        low: wavenumber [rad/sample]; 0 for all long waves.
        high: wavenumber [rad/sample].

    Returns:
        The integrals of each surface, shape (n_models, 3).
    """
    level, pivot, power, corner = np.array(
        [
            (one.level, one.pivot, one.hurst + 0.5, 2 * np.pi / one.roll_off)
            for one in models
        ]
    ).T[:, :, None]
    start = np.full_like(corner, low) if low > 0 else 1e-3 * np.minimum(corner, high)
    edge = np.exp(np.log(start) + np.log(high / start) * np.linspace(0, 1, _NODES))
    if low == 0:
        edge = np.hstack([np.zeros_like(start), edge])
    middle = np.square(0.5 * (edge[:, 1:] + edge[:, :-1]))
    ratio = (corner**2 + pivot**2) / (corner**2 + middle)
    part = 2 * level * ratio**power * np.diff(edge)
    return np.array([(part * middle**k).sum(axis=1) for k in (0, 1, 2)]).T


def cut_wavelength(blur: FloatArray) -> FloatArray:
    """Return where a short cut transmits half the amplitude [samples]."""
    cut: FloatArray = _CUT_HALF * np.sqrt(np.maximum(blur, 0))
    return cut


def shortest_wave(likelihood: SpectralLikelihood, model: BandLimited) -> float:
    """Return the shortest wavelength at which the heights show the surface [samples].

    It is outside known filters, not shorter than the short cut, and has more power of
    the surface than of noise.
    """
    transfer = likelihood.sample.transfer
    tip = transfer.tip is not None
    omega = np.geomspace(2 * np.pi / likelihood.sample.points, np.pi, 400)
    seen = model.surface(omega) * model.short_cut(omega, tip=tip)
    shown = seen * transfer.power(omega) > model.noise / (2 * np.pi)
    shown &= model.short_cut(omega, tip=tip) >= 0.25
    clear = np.flatnonzero(~shown)
    top = omega[clear[0] - 1] if clear.size and clear[0] > 0 else omega[-1]
    if clear.size and clear[0] == 0:
        top = omega[0]
    bounds = (RESOLVED, 2 * np.pi / transfer.highest, 2 * np.pi / float(top))
    return float(max(bounds))


def longest_wave(sample: LineSample) -> float:
    """Return the longest wavelength of the moments [samples]: the line, or lambda_c."""
    lowest = sample.transfer.lowest
    return min(float(sample.points), 2 * np.pi / lowest if lowest > 0 else np.inf)


def modelled_moments(
    likelihood: SpectralLikelihood, draws: WeightedDraws, best: FloatArray
) -> RoughnessMoments | None:
    """Return the moments of the fitted surface within the wavelengths that it shows."""
    sample = likelihood.sample
    model = likelihood.model(best)
    short, long = shortest_wave(likelihood, model), longest_wave(sample)
    if not long > 2 * short:
        return None
    ends = (2 * np.pi / long, 2 * np.pi / short)
    at_best = spectral_moments([model], *ends)[0]
    values = spectral_moments([likelihood.model(x) for x in draws.parameters], *ends)
    parts = [
        draws.estimate(np.sqrt(values[:, k]), float(np.sqrt(at_best[k])))
        for k in range(3)
    ]
    return in_metres(sample.pitch, sample.scale, (short, long), parts, modelled=True)


def measured_moments(sample: LineSample) -> RoughnessMoments | None:
    """Return sums of the measured spectrum, for surfaces without a self-affine band.

    Known filters are divided out; the scatter of each bin is that of its ordinates.
    """
    found = _resolved_spectrum(sample)
    if found is None:
        return None
    omega, power, count = found
    short, long = _measured_ends(sample)
    width = np.gradient(omega)
    parts = []
    for k in (0, 2, 4):
        terms = 2 * power * width * omega**k
        total = float(terms.sum())
        spread = float(np.sqrt(np.sum(terms**2 / count))) / total
        reach = np.exp(0.5 * NORMAL_97_5 * spread)
        value = float(np.sqrt(total))
        parts.append(Interval95(value, float(value / reach), float(value * reach)))
    return in_metres(sample.pitch, sample.scale, (short, long), parts, modelled=False)


def measured_density(sample: LineSample) -> LineDensity | None:
    """Return the measured spectrum within those wavelengths; None as for the sums."""
    found = _resolved_spectrum(sample)
    if found is None:
        return None
    omega, power, count = found
    unit = sample.scale**2 * sample.pitch
    return LineDensity(omega / sample.pitch, power * unit, count)


def _measured_ends(sample: LineSample) -> tuple[float, float]:
    """Return the shortest and the longest wavelength of the sums [samples]."""
    return max(RESOLVED, 2 * np.pi / sample.transfer.highest), longest_wave(sample)


def _resolved_spectrum(
    sample: LineSample,
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return the spectrum within the wavelengths of the sums, filters divided out."""
    short, long = _measured_ends(sample)
    omega, power, count = _whole_spectrum(sample)
    inside = (omega <= 2 * np.pi / short) & (omega >= 2 * np.pi / long)
    if np.count_nonzero(inside) < 4 or not long > 2 * short:
        return None
    omega = omega[inside]
    return omega, power[inside] / sample.transfer.power(omega), count[inside]


def _whole_spectrum(
    sample: LineSample,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the spectrum from the longest waves on, by the means of blocks as well."""
    if sample.blocks is None:
        return sample.omega, sample.power, sample.count
    blocks, size = sample.blocks.means, sample.blocks.size
    trend, _ = np.linalg.qr(sample.blocks.trend)
    flat = blocks - trend @ (trend.T @ blocks)
    number = flat.shape[0]
    waves = np.arange(1, number // 2)
    window = np.sin(np.pi * (np.arange(number) + 0.5) / number)[:, None] ** 2
    means = np.fft.rfft(flat * window, axis=0)[waves]
    omega = 2 * np.pi * waves / (number * size)
    seen = np.sinc(omega * size / (2 * np.pi)) ** 2
    square = np.mean(np.abs(means) ** 2, axis=1) * size
    power = square / (2 * np.pi * np.sum(window**2)) / seen
    # A cosine-squared window correlates ordinates: 35/18 in the variance of a sum.
    count = np.full(waves.size, 18 / 35 * flat.shape[1])
    below = omega < sample.omega[0] if sample.omega.size else omega > 0
    return (
        np.concatenate([omega[below], sample.omega]),
        np.concatenate([power[below], sample.power]),
        np.concatenate([count[below], sample.count]),
    )
