# SPDX-License-Identifier: MIT
"""Levels of channels: largest value over the last half second against the range."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

WINDOW = 0.5  # [s]
NEAR_FULL = 0.98
"""Share of the range from which a channel counts as overloaded [-]."""


@dataclass(frozen=True, slots=True)
class Level:
    """Level of one channel.

    Attributes:
        name: of the channel.
        share: largest value over the range [-]; 0 without a range.
    """

    name: str
    share: float

    @property
    def full(self) -> bool:
        """Whether the channel is overloaded, or nearly so."""
        return self.share >= NEAR_FULL


@dataclass(slots=True)
class LevelMeter:
    """Largest values of the last blocks of a stream."""

    _peaks: deque[tuple[int, FloatArray]] = field(default_factory=deque)
    _held: int = 0

    def feed(self, samples: FloatArray, *, sample_rate: float) -> None:
        """Take a block, SI units, shape (n_channels, n)."""
        count = samples.shape[1]
        if not count:
            return
        self._peaks.append((count, np.abs(samples).max(axis=1)))
        self._held += count
        while self._held - self._peaks[0][0] >= WINDOW * sample_rate:
            self._held -= self._peaks.popleft()[0]

    def levels(self, channels: Sequence[Mapping[str, Any]]) -> tuple[Level, ...]:
        """Return the level of each channel, by name and range [SI unit]."""
        if not self._peaks:
            return tuple(Level(str(row["name"]), 0.0) for row in channels)
        peaks = np.max([peak for _, peak in self._peaks], axis=0)
        return tuple(
            Level(str(row["name"]), float(peak) / row["range"] if row["range"] else 0.0)
            for row, peak in zip(channels, peaks, strict=False)
        )
