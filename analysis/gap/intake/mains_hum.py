# SPDX-License-Identifier: MIT
"""Offset and mains hum of raw records: fitted before the hits, and what is left.

The quiet start holds about one period of the mains, so a hum that is continued from it
over a whole record is off by a part of the noise of the channel, and more with time. At
the lowest levels that is more than the noise after the filter. What is left is known by
its shape and covariance, with which the comparison weights it.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.intake.intake_settings import HITS


@dataclass(frozen=True, slots=True, eq=False)
class MainsHum:
    """What quiet starts show of offset and hum, over the white noise of a channel.

    Attributes:
        frequency: nominal one of the mains [Hz].
        sample_rate: of the raw records [Hz].
        quiet: samples before the hits.
        amplitude: typical one of the hum over the white noise [-].
        root: triangular root of the covariance of offset and hum after the fit to a
            quiet start, shape (n_terms, n_terms).
    """

    frequency: float
    sample_rate: float
    quiet: int
    amplitude: float
    root: FloatArray

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "root")

    def subtracted(self, values: FloatArray) -> FloatArray:
        """Return records without offset and hum as their quiet starts show them.

        Args:
            values: shape (n_rows, n_samples).
        """
        basis = self._basis(np.arange(values.shape[1], dtype=float))
        before = values[:, : self.quiet]
        weights = self.root @ self.root.T @ (basis[:, : self.quiet] @ before.T)
        return np.asarray(values - weights.T @ basis)

    def left(self, samples: FloatArray) -> FloatArray:
        """Return what may be left, in directions of unit sd over the white noise.

        Args:
            samples: raw ones of the records, shape (n,).

        Returns:
            Shape (n_directions, n): offset and hum, and its drift by the frequency.
        """
        basis = self._basis(samples)
        drift = 2 * np.pi * HITS.mains_sd * self.amplitude / self.sample_rate
        late = drift * (samples - 0.5 * self.quiet)
        return np.concatenate([self.root.T @ basis, late * basis[1:]])

    def _basis(self, samples: FloatArray) -> FloatArray:
        return _basis(self.frequency, samples / self.sample_rate)


def mains_hum(starts: FloatArray, sample_rate: float) -> MainsHum:
    """Return what the quiet starts of all hits show of offset and hum.

    Args:
        starts: samples before the hits, shape (n_traces, n_samples).
        sample_rate: [Hz].
    """
    white = np.sqrt(np.mean(np.diff(starts, axis=1) ** 2, axis=1) / 2)
    # A trace that never moves is a lost cable or a full converter: it shows no hum.
    moving = white > 0
    scaled = starts[moving] / white[moving, None]
    excess = float(np.median(np.var(scaled, axis=1))) - 1.0 if moving.any() else 0.0
    amplitude = float(np.sqrt(2.0 * max(excess, HITS.least_hum)))
    count = starts.shape[1]
    tried = []
    for frequency in HITS.mains:
        basis = _basis(frequency, np.arange(count) / sample_rate)
        precision = np.diag([0.0] + [(2.0 * amplitude) ** -2] * (len(basis) - 1))
        root = np.linalg.cholesky(np.linalg.inv(basis @ basis.T + precision))
        shown = float(np.sum((scaled @ basis.T @ root) ** 2))
        tried.append((shown, frequency, root))
    _, frequency, root = max(tried, key=lambda one: one[0])
    return MainsHum(frequency, sample_rate, count, amplitude, root)


def _basis(frequency: float, times: FloatArray) -> FloatArray:
    """Return offset, cosine and sine of each harmonic, shape (n_terms, n)."""
    rows = [np.ones(times.size)]
    for harmonic in HITS.mains_harmonics:
        angle = 2 * np.pi * harmonic * frequency * times
        rows += [np.cos(angle), np.sin(angle)]
    return np.stack(rows)
