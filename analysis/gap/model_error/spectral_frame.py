# SPDX-License-Identifier: MIT
"""Spectra of the records of a bench in logarithmic bands, and their signal."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.residuals.bench_protocol import MeasuredBench


@dataclass(frozen=True, slots=True, eq=False)
class SpectralFrame:
    """Lines, bands and signal of the records.

    Attributes:
        lines: first line that is compared, and one past the last.
        band: band of each line, shape (n_lines,), ascending.
        edges: of the bands [Hz], shape (n_bands + 1,).
        sigma: noise of each record and channel, shape (n_records, n_channels).
        force: spectrum of the force, shape (n_records, n_lines).
        signal: power of the response over that of the noise, less 1, shape
            (n_records, n_channels, n_bands).
        counted: bands with enough signal, same shape.
        point: hit point of each record, shape (n_records,), 0-based.
    """

    lines: tuple[int, int]
    band: IntArray
    edges: FloatArray
    sigma: FloatArray
    force: ComplexArray
    signal: FloatArray
    counted: BoolArray
    point: IntArray

    @property
    def count(self) -> FloatArray:
        """Lines of each band, shape (n_bands,)."""
        return np.bincount(self.band, minlength=self.edges.size - 1).astype(float)

    def in_bands(self, power: FloatArray) -> FloatArray:
        """Return the mean over the lines of each band, shape (..., n_bands)."""
        starts = np.searchsorted(self.band, np.arange(self.edges.size - 1))
        return np.asarray(np.add.reduceat(power, starts, axis=-1) / self.count)

    def spectrum(self, difference: FloatArray) -> ComplexArray:
        """Return the spectrum of a difference over sigma, noise of power 1.

        Args:
            difference: shape (n_records, n_channels, n_samples); changed in place.

        Returns:
            Shape (n_records, n_channels, n_lines).
        """
        difference /= self.sigma[:, :, None]
        found = scipy.fft.rfft(difference, axis=-1)[..., slice(*self.lines)]
        found /= np.sqrt(difference.shape[-1])
        return np.asarray(found)


def spectral_frame(bench: MeasuredBench) -> SpectralFrame:
    """Return the lines and bands in which the records of a bench have signal."""
    campaign, settings = bench.campaign, MODEL_ERROR_SETTINGS
    samples = campaign.response.shape[2]
    seen = campaign.response.copy()
    bench.mask(seen)
    spectrum = scipy.fft.rfft(seen, axis=-1) / np.sqrt(samples)
    power = np.abs(spectrum / bench.noise.sigma[:, :, None]) ** 2
    first, last = _reach(power)
    edges = np.geomspace(first, last, settings.bands + 1)
    band = np.searchsorted(edges[1:-1], np.arange(first, last), side="right")
    kept = np.unique(band)
    band = np.searchsorted(kept, band)
    edges = np.append(edges[kept], edges[kept[-1] + 1])
    force = scipy.fft.rfft(campaign.force, axis=-1)[:, first:last]
    _, point = np.unique(campaign.hit, return_inverse=True)
    frame = SpectralFrame(
        (first, last),
        band,
        edges * campaign.sample_rate / samples,
        bench.noise.sigma,
        force,
        np.zeros(0),
        np.zeros(0, dtype=bool),
        point,
    )
    signal = frame.in_bands(power[..., first:last]) - 1.0
    return SpectralFrame(
        frame.lines,
        band,
        frame.edges,
        frame.sigma,
        force,
        np.maximum(signal, 0.0),
        signal > settings.least_signal,
        point,
    )


def _reach(power: FloatArray) -> tuple[int, int]:
    """Return the first line with signal in any record, and one past the last."""
    settings = MODEL_ERROR_SETTINGS
    width = settings.least_lines
    kernel = np.ones(width) / width
    strongest = power.max(axis=(0, 1))
    smooth = np.convolve(strongest, kernel, mode="same")
    end = int(2 * settings.highest_line * (strongest.size - 1))
    seen = np.flatnonzero(smooth[width:end] > settings.least_signal) + width
    if seen.size < settings.bands * width:
        return width, end
    return int(seen[0]), int(seen[-1]) + 1
