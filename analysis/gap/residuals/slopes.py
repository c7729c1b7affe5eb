# SPDX-License-Identifier: MIT
"""Sums over the slopes of a residual, which may be stored in single precision.

Slopes by all coordinates are the largest array of a fit. Rounded one by one they hardly
change a sum over a million rows, but summed in single precision they would: sums are
taken in double, of some rows at a time.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray

SlopeArray = NDArray[np.float64] | NDArray[np.float32]

_ROWS_AT_ONCE = 1 << 15


def curvature(slopes: SlopeArray) -> FloatArray:
    """Return J'J, shape (n, n).

    Args:
        slopes: J, shape (n_rows, n).
    """
    found = np.zeros((slopes.shape[1], slopes.shape[1]))
    for _, part in _parts(slopes):
        found += part.T @ part
    return found


def squared_norms(slopes: SlopeArray) -> FloatArray:
    """Return the diagonal of J'J, shape (n,).

    Args:
        slopes: J, shape (n_rows, n).
    """
    found = np.zeros(slopes.shape[1])
    for _, part in _parts(slopes):
        found += np.einsum("ij,ij->j", part, part)
    return found


def along_columns(slopes: SlopeArray, rows: FloatArray) -> FloatArray:
    """Return J'r, shape (n,).

    Args:
        slopes: J, shape (n_rows, n).
        rows: r, shape (n_rows,).
    """
    found = np.zeros(slopes.shape[1])
    for own, part in _parts(slopes):
        found += part.T @ rows[own]
    return found


def linear_change(slopes: SlopeArray, step: FloatArray) -> FloatArray:
    """Return Js, shape (n_rows,).

    Args:
        slopes: J, shape (n_rows, n).
        step: s, shape (n,).
    """
    found = np.empty(len(slopes))
    for own, part in _parts(slopes):
        np.matmul(part, step, out=found[own])
    return found


def _parts(slopes: SlopeArray) -> Iterator[tuple[slice, FloatArray]]:
    """Yield rows in double precision, all at once where they are stored so."""
    step = len(slopes) if slopes.dtype == np.float64 else _ROWS_AT_ONCE
    for first in range(0, len(slopes), max(step, 1)):
        own = slice(first, first + step)
        yield own, np.asarray(slopes[own], dtype=np.float64)
