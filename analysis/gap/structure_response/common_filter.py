# SPDX-License-Identifier: MIT
"""The filter that force and responses of a campaign have in common."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class CommonFilter:
    """A filter of linear phase, with the samples that are kept.

    Attributes:
        kernel: symmetric taps, shape (n_taps,).
        step: raw samples per sample.
    """

    kernel: FloatArray
    step: int

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
