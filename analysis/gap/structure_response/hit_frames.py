# SPDX-License-Identifier: MIT
"""Transforms of hits on a damped Laplace line, for windows of any length."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.hit_campaign import HitRecords
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class HitFrame:
    """The damped line of a window, with the forces on it.

    Attributes:
        count: samples in the window.
        size: samples of the transform.
        s: Laplace variable of each line that the filter of the records passes [rad/s],
            shape (n_lines,).
        force: transformed forces [N], shape (n_records, n_lines).
        growth: factor that removes the damping, shape (size,).
    """

    count: int
    size: int
    s: ComplexArray
    force: ComplexArray
    growth: FloatArray

    def records(self, spectrum: ComplexArray) -> FloatArray:
        """Return records from their transforms, shape (..., count)."""
        values = self.damped(spectrum)[..., : self.count]
        values *= self.growth[: self.count]
        return np.asarray(values)

    def damped(self, spectrum: ComplexArray) -> FloatArray:
        """Return records as they are on the damped line, shape (..., size)."""
        return np.asarray(scipy.fft.irfft(spectrum, self.size, axis=-1))

    def empty_spectrum(self, shape: tuple[int, ...]) -> ComplexArray:
        """Return zeros with the lines of a whole transform, shape (*shape, n).

        Args:
            shape: of the records and channels.
        """
        return np.zeros((*shape, self.size // 2 + 1), dtype=np.complex128)

    def transform(self, values: FloatArray) -> ComplexArray:
        """Return the transforms of records, shape (..., n_lines).

        Args:
            values: shape (..., n_samples); more samples than the window has keep their
                end out of it.
        """
        inside = values[..., : self.size]
        damped = inside / self.growth[: inside.shape[-1]]
        found = scipy.fft.rfft(damped, self.size, axis=-1)
        return np.asarray(found[..., : self.s.size])


def window_count(hits: HitRecords, window: float | None) -> int:
    """Return the samples of a window that begins with the force [s]."""
    whole = int(hits.force.shape[1])
    if window is None:
        return whole
    return min(whole, hits.lead + int(np.ceil(window * hits.sample_rate)))


def hit_frame(hits: HitRecords, count: int) -> HitFrame:
    """Transform the forces of a window.

    Args:
        hits: filtered records.
        count: samples in the window.
    """
    size = int(scipy.fft.next_fast_len(count + _room(hits, count), real=True))
    decay = STRUCTURE.line_damping * hits.sample_rate / size
    growth = np.exp(decay * np.arange(size) / hits.sample_rate)
    frequency = np.fft.rfftfreq(size, 1.0 / hits.sample_rate)
    frequency = frequency[frequency <= hits.highest]
    force = scipy.fft.rfft(hits.force[:, :count] / growth[:count], size, axis=-1)
    return HitFrame(
        count,
        size,
        np.asarray(decay + 2j * np.pi * frequency, dtype=np.complex128),
        np.asarray(force[:, : frequency.size]),
        growth,
    )


def _room(hits: HitRecords, count: int) -> int:
    """Return the samples of a transform beyond its window.

    A filter ends what responses have before the hit, and the end of a short window is
    early on the damped line: what wraps around grows little there.
    """
    share, most = STRUCTURE.padding
    least = most
    if hits.filter.half:
        least = min(max(count, STRUCTURE.short_padding), most)
    return max(int(share * count), least)
