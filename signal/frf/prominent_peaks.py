# SPDX-License-Identifier: MIT
"""Peaks by prominence and distance, as by `scipy.signal.find_peaks`.

Importing `scipy.signal` takes longer than the fit of a small record.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray


def prominent_peaks(level: FloatArray, *, prominence: float, distance: int) -> IntArray:
    """Return the indices of local maxima, ascending, the middle of flat ones.

    Args:
        level: shape (n,), n > 0.
        prominence: least height over the higher one of the two minima that separate a
            peak from higher ones, or from the ends.
        distance: least distance of two peaks [samples]; the higher one is kept.
    """
    edges = np.flatnonzero(np.diff(level)) + 1
    starts = np.concatenate([[0], edges])
    ends = np.concatenate([edges, [level.size]]) - 1
    height = level[starts]
    inner = (height[1:-1] > height[:-2]) & (height[1:-1] > height[2:])
    peaks = (starts[1:-1] + ends[1:-1])[inner] // 2
    apart = _apart(peaks, level[peaks], distance)
    high = [p for p in apart.tolist() if _prominence(level, p) >= prominence]
    return np.array(high, dtype=np.int64)


def _apart(peaks: IntArray, height: FloatArray, distance: int) -> IntArray:
    """Drop peaks that are too near to a higher one, the highest first."""
    kept = np.ones(peaks.size, dtype=bool)
    for i in np.argsort(height)[::-1]:
        if kept[i]:
            near = np.abs(peaks - peaks[i]) < distance
            near[i] = False
            kept &= ~near
    return np.asarray(peaks[kept])


def _prominence(level: FloatArray, peak: int) -> float:
    """Return the height of a peak over its higher base."""
    higher = np.flatnonzero(level > level[peak])
    at = int(np.searchsorted(higher, peak))
    first = int(higher[at - 1]) + 1 if at > 0 else 0
    last = int(higher[at]) if at < higher.size else level.size
    bases = level[first : peak + 1].min(), level[peak:last].min()
    return float(level[peak] - max(bases))
