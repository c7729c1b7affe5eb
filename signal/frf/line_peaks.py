# SPDX-License-Identifier: MIT
"""Peaks of a curve by their distance and prominence.

The results are those of `scipy.signal.find_peaks`, whose import takes 20 MB and half a
second, as much as the rest of a short command.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray


def prominent_peaks(
    values: FloatArray, *, prominence: float, distance: int
) -> IntArray:
    """Return the indices of peaks, ascending; of equal values the middle.

    Args:
        values: finite, shape (n,).
        prominence: least height over the higher one of the two lowest values towards
            higher ground, or towards the end.
        distance: least number of values from one peak to the next; the higher stays.
    """
    peaks = _local_maxima(values)
    peaks = peaks[_apart(peaks, values[peaks], distance)]
    high = [_prominence(values, peak) >= prominence for peak in peaks.tolist()]
    return np.asarray(peaks[np.array(high, dtype=bool)])


def _local_maxima(values: FloatArray) -> IntArray:
    """Return the middle of each stretch of equal values with lower ones beside it."""
    edges = np.flatnonzero(np.diff(values)) + 1
    first, past = edges[:-1], edges[1:]
    level = values[first]
    higher = (values[first - 1] < level) & (values[past] < level)
    return np.asarray((first + past - 1)[higher] // 2)


def _apart(peaks: IntArray, height: FloatArray, distance: int) -> BoolArray:
    """Return which peaks stay where the highest ones clear their neighbourhood."""
    keep = np.ones(peaks.size, dtype=bool)
    for place in np.argsort(height)[::-1].tolist():
        if keep[place]:
            low = np.searchsorted(peaks, peaks[place] - distance, side="right")
            past = np.searchsorted(peaks, peaks[place] + distance)
            keep[low:past] = False
            keep[place] = True
    return keep


def _prominence(values: FloatArray, peak: int) -> float:
    higher = np.flatnonzero(values > values[peak])
    after = int(np.searchsorted(higher, peak))
    first = int(higher[after - 1]) + 1 if after else 0
    past = int(higher[after]) if after < higher.size else values.size
    lowest = values[first : peak + 1].min(), values[peak:past].min()
    return float(values[peak] - max(lowest))
