# SPDX-License-Identifier: MIT
"""The filter that force and responses of a campaign have in common."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


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
        taps, count = self.kernel.size, -(-len(values) // self.step)
        some = STRUCTURE.filtered_at_once
        blocks = -(-count // some)
        padded = np.zeros(((blocks * some - 1) * self.step + taps, values.shape[1]))
        before = taps - 1 - self.half
        padded[before : before + len(values)] = values
        weights = np.zeros((some, (some - 1) * self.step + taps))
        for k, row in enumerate(weights):
            row[k * self.step : k * self.step + taps] = self.kernel[::-1]
        windows = sliding_window_view(padded, weights.shape[1], axis=0)
        windows = windows[:: some * self.step].transpose(0, 2, 1)
        found = (weights @ windows).reshape(-1, values.shape[1])
        return np.asarray(found[:count])
