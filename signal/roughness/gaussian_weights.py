# SPDX-License-Identifier: MIT
"""Weights of Gaussian regression filters, and their moments along a line."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.surface.gaussian_filter import GAUSSIAN_ALPHA

QUADRATIC_ALPHA = float(np.sqrt(1.6783469900166605 / np.pi))
"""The same constant of the regression of order 2 [-]: (1 + u) exp(-u) = 1/2 with
u = pi alpha^2 (ISO 16610-31 prints 0.7309)."""
REACH = 1.0
"""Half width of the weights over the nesting index [-]; beyond it they are below 1e-6
(ISO 16610-21 calls it the truncation constant)."""
HIGHEST_ORDER = 2


@dataclass(frozen=True, slots=True, eq=False)
class LineWeights:
    """Gaussian weights along one direction.

    Attributes:
        offset: of each weight from its point, over the nesting index [-], shape (w,).
        weight: unit sum, shape (w,).
    """

    offset: FloatArray
    weight: FloatArray

    @property
    def half(self) -> int:
        """Points on each side of the middle."""
        return self.offset.size // 2

    def moment(self, power: int) -> FloatArray:
        """Return weight times offset to a power, shape (w,)."""
        found: FloatArray = self.weight * self.offset**power
        return found


def line_weights(
    index: float, pitch: float, *, order: int = 1, reach: float = REACH
) -> LineWeights:
    """Return the weights of a nesting index.

    Args:
        index: nesting index (cut-off wavelength) [m].
        pitch: distance of neighbours [m].
        order: of the local polynomial [-], 0 to 2; the weights of order 2 are wider so
            that its transmission at the nesting index is 50 % as well.
        reach: half width over the nesting index [-].

    Raises:
        UsageError: a nesting index below two samples, or another order.

    Source:
        ISO 16610-21:2011, 4.1; ISO 16610-31:2016, 4.
    """
    if not 0 <= order <= HIGHEST_ORDER:
        raise UsageError(f"order is {order!r}, a regression filter has 0, 1 or 2")
    if not index >= 2 * pitch:
        raise UsageError(
            f"a nesting index of {index:g} m is below two samples ({2 * pitch:g} m); "
            "choose a longer one, or measure with a smaller pitch"
        )
    alpha = QUADRATIC_ALPHA if order == HIGHEST_ORDER else GAUSSIAN_ALPHA
    width = reach * (alpha / GAUSSIAN_ALPHA)
    half = int(np.ceil(width * index / pitch - 1e-9))
    offset = np.arange(-half, half + 1, dtype=np.float64) * (pitch / index)
    weight = np.asarray(np.exp(-np.pi * (offset / alpha) ** 2), dtype=np.float64)
    return LineWeights(offset, weight / weight.sum())


def weighted_sums(
    values: FloatArray,
    kernels: tuple[FloatArray, ...],
    *,
    axis: int = -1,
    closed: bool = False,
) -> tuple[FloatArray, ...]:
    """Return sum over j of kernel(j - i) values(j) for each kernel, at each point i.

    Args:
        values: any shape.
        kernels: of one odd length each, first entry at the most negative offset.
        axis: along which the sums run.
        closed: whether the last point is a neighbour of the first; otherwise values
            beyond the ends are 0.
    """
    points = values.shape[axis]
    half = kernels[0].size // 2
    size = points if closed else scipy.fft.next_fast_len(points + half, real=True)
    spectrum = scipy.fft.rfft(values, size, axis=axis)
    shape = [1] * values.ndim
    shape[axis] = -1
    found = []
    for kernel in kernels:
        wrapped = np.zeros(size)
        np.add.at(wrapped, -np.arange(-half, half + 1) % size, kernel)
        factor = scipy.fft.rfft(wrapped).reshape(shape)
        sums = scipy.fft.irfft(spectrum * factor, size, axis=axis)
        found.append(np.take(sums, range(points), axis=axis) if size > points else sums)
    return tuple(found)
