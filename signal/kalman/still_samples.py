# SPDX-License-Identifier: MIT
"""How often a channel repeats its last sample, counted block by block.

A channel that stands still for longer than quantisation explains has lost samples. The
memory is that of one block, whatever the length of the record.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, IntArray
from jointbench.acquisition.records.recordings import Samples

MOVING = 0.5
"""A channel moves where at least this share of its samples differ from the one before
[-]."""
# Constant samples in a row: the least number of a drop-out, and the number used before
# it is estimated how often quantisation repeats samples of a quiet channel.
_LEAST_STILL, _MANY_STILL = 3, 8
# Probability of so long a run anywhere in a record of a working channel.
_BY_CHANCE = 1e-6
# Pieces of a record; the one with most repeats is the reference.
_SHARES = 16
_BLOCK = 2**17  # samples read together


def stands_still(samples: Samples, row: int) -> bool:
    """Return whether a channel stands still although it varies elsewhere.

    Args:
        samples: of all channels, shape (n_channels, n_samples).
        row: of the channel.
    """
    count = samples.shape[1]
    if count < 2:
        return False
    found = StillSamples(count - 1)
    for first in range(0, count - 1, _BLOCK):
        # One sample more: each is compared with the one before.
        block = samples[row, first : first + _BLOCK + 1]
        found.feed(block[1:] == block[:-1])
    return found.stands_still()


class StillSamples:
    """Repeats of the sample before, and the runs that they form."""

    def __init__(self, count: int) -> None:
        """Begin without any.

        Args:
            count: of comparisons that will be fed.
        """
        sizes = [
            count // _SHARES + (piece < count % _SHARES) for piece in range(_SHARES)
        ]
        self._count, self._sizes = count, np.array(sizes)
        self._edges = np.r_[0, np.cumsum(self._sizes)]
        self._single = np.zeros(_SHARES, np.int64)
        self._still = self._done = self._longest = self._open = 0

    def feed(self, still: BoolArray) -> None:
        """Take the next comparisons: True where a sample is equal to the one before."""
        runs = runs_of(still) + self._done
        past = self._done + still.size
        self._still += int(np.count_nonzero(still))
        edges = np.clip(self._edges - self._done, 0, still.size)
        self._single += np.diff(np.r_[0, np.cumsum(still)][edges])
        self._done = past
        if self._open and (runs.size == 0 or runs[0, 0] != past - still.size):
            self._close(past - still.size - self._open, past - still.size)
        elif self._open:
            runs[0, 0] -= self._open
        self._open = 0
        if runs.size and runs[-1, 1] == past and past < self._count:
            self._open = int(runs[-1, 1] - runs[-1, 0])
            runs = runs[:-1]
        lengths = runs[:, 1] - runs[:, 0]
        self._longest = max(self._longest, int(lengths.max(initial=0)))
        for first, last in runs[lengths >= _MANY_STILL].tolist():
            self._close(first, last)

    def stands_still(self) -> bool:
        """Return whether one run is longer than quantisation explains."""
        if not self._still or 1 - self._still / self._count < MOVING:
            return False
        return self._longest >= self.least()

    def least(self) -> int:
        """Return the number of repeats in a row that quantisation does not explain.

        A quiet channel that varies by a few steps repeats a share p of its samples by
        chance; n samples then hold a run of m with a probability of at most n p^m.
        """
        sizes = np.maximum(self._sizes, 1)
        share = float(np.max(self._single / sizes))
        if share == 0.0:
            return _LEAST_STILL
        if share >= 1.0:  # a piece of a few samples
            return self._count + 1
        needed = np.log(_BY_CHANCE / self._count) / np.log(share)
        return max(_LEAST_STILL, int(np.ceil(needed)))

    def _close(self, first: int, last: int) -> None:
        """Take note of a run that is over; a long one is no matter of chance."""
        self._longest = max(self._longest, last - first)
        if last - first < _MANY_STILL:
            return
        edges = np.clip(self._edges, first, last)
        self._single -= np.diff(edges)


def runs_of(still: BoolArray) -> IntArray:
    """Return first and one past the last of each run of True, shape (n, 2)."""
    edges = np.flatnonzero(np.diff(np.r_[0, still.view(np.int8), 0]))
    return np.asarray(edges.reshape(-1, 2), np.int64)
