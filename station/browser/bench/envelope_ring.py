# SPDX-License-Identifier: MIT
"""Smallest and largest values of a stream, bin by bin, for a screen that draws pixels.

A curve of every n-th sample would lose the peak of a hammer hit; a pair of smallest and
largest values loses none.
"""

import struct

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray

_HEAD = struct.Struct("<4I")
"""First bin, number of bins, channels, samples of a bin."""


class EnvelopeRing:
    """The last bins of a stream.

    Attributes:
        past: number one past the last whole bin, counted from the first sample.
        per_bin: samples of a bin.
    """

    def __init__(self, channels: int, *, per_bin: int, kept: int) -> None:
        """Begin without a sample.

        Args:
            channels: of the stream.
            per_bin: samples of a bin.
            kept: bins that are kept.
        """
        self.past, self.per_bin = 0, per_bin
        self._kept = kept
        self._sent: tuple[int, int, bytes] = (-1, -1, b"")
        self._bins: NDArray[np.float32] = np.zeros((channels, 0, 2), np.float32)
        self._rest: FloatArray = np.zeros((channels, 0))

    def feed(self, samples: FloatArray) -> None:
        """Take samples that follow those before, shape (n_channels, n)."""
        waiting = np.hstack([self._rest, samples])
        count = waiting.shape[1] // self.per_bin
        whole = waiting[:, : count * self.per_bin]
        self._rest = waiting[:, count * self.per_bin :]
        if not count:
            return
        parts = whole.reshape(whole.shape[0], count, self.per_bin)
        fresh = np.stack([parts.min(axis=2), parts.max(axis=2)], axis=2)
        joined = np.concatenate([self._bins, fresh.astype(np.float32)], axis=1)
        self._bins = joined[:, -self._kept :]
        self.past += count

    def skip(self, count: int) -> None:
        """Count samples that are not looked at, before those that follow.

        Args:
            count: samples; part of a bin at the end is left to what follows.
        """
        self.past += count // self.per_bin
        self._bins, self._rest = self._bins[:, :0], self._rest[:, :0]

    def message(self, first: int) -> bytes:
        """Return the bins from a number on, as far as they are kept.

        Screens that have seen the same bins share one message.

        Args:
            first: number of the first bin that is wanted.

        Returns:
            Four little-endian unsigned integers: number of the first bin, bins,
            channels, samples of a bin; then single precision values, (channels, bins,
            2), SI units.
        """
        if self._sent[:2] == (first, self.past):
            return self._sent[2]
        held = self._bins.shape[1]
        start = min(max(first, self.past - held), self.past)
        wanted = self._bins[:, held - (self.past - start) :]
        channels, count = wanted.shape[:2]
        head = _HEAD.pack(start, count, channels, self.per_bin)
        self._sent = first, self.past, head + wanted.tobytes()
        return self._sent[2]
