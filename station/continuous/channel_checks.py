# SPDX-License-Identifier: MIT
"""Checks of channels while a run is recorded: overload, and channels that are dead."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel

FULL = 0.98
"""Share of the range from which a sample counts as overloaded [-]."""
DEAD = 1e-6
"""Share of the range below which the scatter of a channel counts as none [-]."""


@dataclass(slots=True)
class ChannelChecks:
    """What the samples of one run show of its channels.

    Attributes:
        channels: of the rows.
        overloaded: names of those that were, in their order of time.
    """

    channels: Sequence[Channel]
    overloaded: list[str] = field(default_factory=list)
    _count: int = 0
    _sums: FloatArray | None = None

    def feed(self, samples: FloatArray) -> Iterator[str]:
        """Take a block; yield a line for each channel that is overloaded first.

        Args:
            samples: SI units, shape (n_channels, n).
        """
        self._count += samples.shape[1]
        parts = np.array([samples.sum(axis=1), (samples**2).sum(axis=1)])
        self._sums = parts if self._sums is None else self._sums + parts
        peaks = np.abs(samples).max(axis=1)
        for channel, peak in zip(self.channels, peaks, strict=True):
            full = channel.range is not None and peak >= FULL * channel.range
            if full and channel.name not in self.overloaded:
                self.overloaded.append(channel.name)
                yield (
                    f"channel {channel.name!r} is overloaded: {peak:.4g} of "
                    f"{channel.range:.4g}; take a larger range, or a less sensitive "
                    "sensor"
                )

    def dead(self) -> Iterator[str]:
        """Yield a line for each channel that showed nothing during the run."""
        if self._sums is None or not self._count:
            return
        mean, square = self._sums / self._count
        scatter = np.sqrt(np.maximum(square - mean**2, 0.0))
        for channel, value in zip(self.channels, scatter, strict=True):
            if channel.range and value < DEAD * channel.range:
                yield (
                    f"channel {channel.name!r} stands still: it scatters by "
                    f"{value:.2g}, {value / channel.range:.1g} of its range; check "
                    "cable, supply and input"
                )
