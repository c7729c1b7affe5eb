# SPDX-License-Identifier: MIT
"""Columns of a table that are made piece by piece, for recordings of hours."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.netcdf_write import CHUNK_VALUES


@dataclass(frozen=True, slots=True, eq=False)
class LongValues:
    """Numbers along one dimension, indexed by slices as the array they stand for.

    Attributes:
        size: number of values.
        read: returns the values from a first one to one past the last.
    """

    size: int
    read: Callable[[int, int], FloatArray]

    @property
    def shape(self) -> tuple[int]:
        """Number of values."""
        return (self.size,)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Double precision."""
        return np.dtype(np.float64)

    def __getitem__(self, part: slice) -> FloatArray:
        """Return the values of a slice without a step."""
        first, past, _ = part.indices(self.size)
        return self.read(first, past)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> FloatArray:
        """Return all values."""
        return np.asarray(self.read(0, self.size), dtype)


def pieces(count: int) -> Iterator[slice]:
    """Yield slices that cover so many values, as long as a chunk of a file."""
    for first in range(0, count, CHUNK_VALUES):
        yield slice(first, min(first + CHUNK_VALUES, count))
