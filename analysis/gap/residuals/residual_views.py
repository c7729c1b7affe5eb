# SPDX-License-Identifier: MIT
"""Views of a residual: its excess by level, channel, time, frequency ..."""

import itertools
from collections.abc import Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.residuals.fit_records import Blocks
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS


def slice_views(
    residual: FloatArray,
    blocks: Blocks,
    channels: Sequence[str],
    sample_rate: float,
) -> tuple[View, ...]:
    """Divide a whitened residual by every view.

    Args:
        residual: shape (n_records, n_channels, n_samples).
        blocks: labels of the records.
        channels: names of the channels.
        sample_rate: [Hz].
    """
    power = residual**2
    views = [
        _by_label(name, power, [labels[name] for labels in blocks.labels])
        for name in blocks.labels[0]
    ]
    views.append(_view("output", {c: power[:, i] for i, c in enumerate(channels)}))
    views.append(_time(power, sample_rate))
    views.append(_frequency(residual, sample_rate))
    return tuple(views)


def _by_label(name: str, power: FloatArray, labels: Sequence[str]) -> View:
    array = np.array(labels)
    return _view(name, {x: power[array == x] for x in dict.fromkeys(labels)})


def _time(power: FloatArray, sample_rate: float) -> View:
    n = power.shape[-1]
    edges = np.linspace(0, n, RESIDUALS.view_bands + 1).astype(int)
    return _view(
        "time",
        {
            f"{1e3 * a / sample_rate:.3g} to {1e3 * b / sample_rate:.3g} ms": power[
                ..., a:b
            ]
            for a, b in itertools.pairwise(edges)
        },
    )


def _frequency(residual: FloatArray, sample_rate: float) -> View:
    n = residual.shape[-1]
    spectrum = scipy.fft.rfft(residual, axis=-1)
    power = np.abs(spectrum) ** 2 / n
    edges = np.concatenate([[0.0], np.geomspace(0.01, 0.5, RESIDUALS.view_bands)]) * n
    return _view(
        "frequency",
        {
            f"{a * sample_rate / n:.0f} to {b * sample_rate / n:.0f} Hz": power[
                ..., int(a) : int(b)
            ]
            for a, b in itertools.pairwise(edges)
        },
    )


def _view(name: str, slices: dict[str, FloatArray]) -> View:
    excess = {x: max(float(np.sum(p - 1.0)), 0.0) for x, p in slices.items()}
    total = sum(excess.values()) or 1.0
    return View(
        name,
        {x: float(np.mean(p)) for x, p in slices.items()},
        {x: e / total for x, e in excess.items()},
    )


def residual_peaks(
    residual: FloatArray, sample_rate: float, count: int = 3
) -> list[float]:
    """Return the frequencies [Hz] at which a whitened residual has its largest peaks.

    Args:
        residual: shape (n_records, n_channels, n_samples).
        sample_rate: [Hz].
        count: of peaks.
    """
    n = residual.shape[-1]
    spectrum = scipy.fft.rfft(residual * np.hanning(n), 4 * n, axis=-1)
    power = np.sum(np.abs(spectrum) ** 2, axis=(0, 1))
    inside = power[1:-1]
    tops = 1 + np.flatnonzero((inside > power[:-2]) & (inside >= power[2:]))
    best = tops[np.argsort(-power[tops])[:count]]
    return [float(k * sample_rate / (4 * n)) for k in best]
