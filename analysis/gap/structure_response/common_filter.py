# SPDX-License-Identifier: MIT
"""The filter that force and responses of a campaign have in common."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.compiled import compiled


@dataclass(frozen=True, slots=True, eq=False)
class CommonFilter:
    """A filter of linear phase, with the samples that are kept.

    Attributes:
        kernel: symmetric taps, shape (n_taps,).
        step: raw samples per sample.
        stop: frequency from which nothing passes [Hz]; infinite if everything does.
    """

    kernel: FloatArray
    step: int
    stop: float = np.inf

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "kernel")

    @property
    def half(self) -> int:
        """Raw samples by which the filter reaches to each side."""
        return len(self.kernel) // 2

    def __call__(self, values: FloatArray, start: int = 0) -> FloatArray:
        """Filter without delay, and keep every `step`-th sample from `start` on.

        Args:
            values: shape (..., n_samples).
            start: first raw sample that is kept.
        """
        taps = self.kernel.reshape((1,) * (values.ndim - 1) + (-1,))
        from scipy.signal import oaconvolve  # slow to import

        full = oaconvolve(values, taps, axes=-1)
        inside = full[..., self.half : self.half + values.shape[-1]]
        return np.asarray(inside[..., start :: self.step])

    def in_time(self, values: FloatArray) -> FloatArray:
        """Filter records side by side, and compute the kept samples alone.

        Args:
            values: shape (n_samples, n_records).

        Returns:
            As from a call from sample 0 on, shape (n_kept, n_records).
        """
        found = np.zeros((-(-len(values) // self.step), values.shape[1]))
        _kept(values, self.kernel, self.step, found)
        return found


@compiled(fastmath=True)
def _kept(values: FloatArray, kernel: FloatArray, step: int, found: FloatArray) -> None:
    """Add each kept sample of a symmetric filter to zeros."""
    half = kernel.size // 2
    for k in range(found.shape[0]):
        for tap in range(kernel.size):
            at = k * step + half - tap
            if 0 <= at < values.shape[0]:
                weight = kernel[tap]
                for record in range(found.shape[1]):
                    found[k, record] += weight * values[at, record]
