# SPDX-License-Identifier: MIT
"""Samples that stay in their file: read when asked for, in place of a whole array.

A session of many channels and hits does not fit into memory. Its recordings hold
`StoredSamples`, which are indexed as the array they stand for; each access returns an
array of just what was asked for.
"""

from collections.abc import Callable, Hashable, Iterator
from functools import wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, final

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray

_Rest = ParamSpec("_Rest")
_Made = TypeVar("_Made")


class RowReader(Protocol):
    """Reads a part of one channel."""

    @property
    def shape(self) -> tuple[int, int]:
        """Number of channels, and of samples of each."""

    def read(self, row: int, first: int, past: int) -> FloatArray:
        """Return samples `first` to `past` of a channel, finite."""


@final
class StoredSamples:
    """Samples of a recording in a file, shape (n_channels, n_samples).

    Attributes:
        known: what was computed from these samples before, see `remembered`.
    """

    __slots__ = ("__weakref__", "_reader", "known")
    ndim = 2

    def __init__(self, reader: RowReader) -> None:
        """Hold a reader; nothing is read."""
        self._reader = reader
        self.known: dict[Hashable, Any] = {}

    @property
    def shape(self) -> tuple[int, int]:
        """Number of channels, and of samples of each."""
        return self._reader.shape

    @property
    def size(self) -> int:
        """Number of samples of all channels."""
        return self.shape[0] * self.shape[1]

    def __len__(self) -> int:
        """Return the number of channels."""
        return self.shape[0]

    def __iter__(self) -> Iterator[FloatArray]:
        """Yield one channel after the other."""
        for row in range(self.shape[0]):
            yield self._reader.read(row, 0, self.shape[1])

    def __getitem__(self, key: Any) -> FloatArray:
        """Return what the array would; only the span of samples asked for is read."""
        rows, columns = key if isinstance(key, tuple) else (key, slice(None))
        first, past, left = _span(columns, self.shape[1])
        if isinstance(rows, int | np.integer):
            row = range(self.shape[0])[int(rows)]
            return np.asarray(self._reader.read(row, first, past)[left])
        chosen = np.arange(self.shape[0])[rows]
        found = np.empty((chosen.size, past - first))
        for place, row in enumerate(chosen.tolist()):
            found[place] = self._reader.read(row, first, past)
        return np.asarray(found[:, left])

    def __array__(
        self, dtype: Any = None, copy: bool | None = None
    ) -> NDArray[np.float64]:
        """Return all samples."""
        return np.asarray(self[:], dtype)

    def copy(self) -> FloatArray:
        """Return all samples, to be written to."""
        return self[:]


def _span(columns: Any, count: int) -> tuple[int, int, Any]:
    """Return first and past of what is read, and the index into that."""
    if isinstance(columns, slice) and columns.step in (None, 1):
        first, past, _ = columns.indices(count)
        return first, max(first, past), slice(None)
    return 0, count, columns


class Sampled(Protocol):
    """A recording, as `remembered` knows it."""

    @property
    def samples(self) -> FloatArray | StoredSamples:
        """Samples of all channels."""

    @property
    def hits(self) -> tuple[Any, ...]:
        """Judged hits."""

    @property
    def channels(self) -> tuple[Any, ...]:
        """Channels, one a row."""

    @property
    def sample_rate(self) -> float:
        """Rate [Hz]."""


_Recording = TypeVar("_Recording", bound=Sampled)


def remembered(
    function: Callable[Concatenate[_Recording, _Rest], _Made],
) -> Callable[Concatenate[_Recording, _Rest], _Made]:
    """Keep what a function makes of stored samples: they are not read for it again.

    Args:
        function: of a recording and hashable arguments; it must depend on nothing of
            the recording but samples, hits, channels and rate.
    """

    @wraps(function)
    def call(
        recording: _Recording, /, *args: _Rest.args, **kwargs: _Rest.kwargs
    ) -> _Made:
        samples = recording.samples
        if not isinstance(samples, StoredSamples):
            return function(recording, *args, **kwargs)
        own = (recording.hits, recording.channels, recording.sample_rate)
        key = (function.__qualname__, *own, args, tuple(sorted(kwargs.items())))
        if key not in samples.known:
            samples.known[key] = function(recording, *args, **kwargs)
        made: _Made = samples.known[key]
        return made

    return call
