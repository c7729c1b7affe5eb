# SPDX-License-Identifier: MIT
"""Sums of a covariance of S over the pairs of rows of a map.

Rows r apart, differences over lags a <= b have a covariance c(u, r) that is even in u,
the distance of their middles, and smooth but for u = (b - a) / 2 and (a + b) / 2 where
r is small. Its square is added up over u by steps that widen with the distance from
these places, or from the row; over r by every row first, then by a few of each octave.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled

Counts = NDArray[np.int32]
_STEP = 0.1
"""Longest step over the distance from the next place where c is not smooth [-]; with
it and the rows below a covariance is within 2e-4 of the full sum."""
_EVERY_ROW = 8
"""Rows of the nearest that all count; the first octave begins there [rows]."""
_ROWS = 4
"""Rows of each octave: polynomials up to degree 7 are added up exactly [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MapSums:
    """Sums over the pairs of rows of a map, for lags of whole samples.

    Attributes:
        lag: [samples], shape (n_lags,).
        points: of a row.
        row: distances of rows, as far as heights vary [samples], shape (n_rows,).
        weight: of each of them in the mean over all pairs of rows [-], same shape.
        place: distances d of the starts of two differences [samples], shape (n_steps,).
        count: positions for which each stands, both signs of u [-], same shape.
        start: first step of each pair of lags and row, shape (n_pairs * n_rows + 1,).
    """

    lag: IntArray
    points: int
    row: FloatArray
    weight: FloatArray
    place: Counts
    count: Counts
    start: IntArray

    @property
    def distance(self) -> FloatArray:
        """Distances at which S is needed [samples], shape (n_rows, points)."""
        return np.hypot(self.row[:, None], np.arange(self.points))

    def covariance(self, seen: FloatArray) -> FloatArray:
        """Return the covariance of the means of squares, shape (n_lags, n_lags).

        Args:
            seen: S at `distance` [m^2].
        """
        return _sums(seen, self.lag, self.weight, self.place, self.count, self.start)


def map_sums(lag: IntArray, points: int, profiles: int, row_distance: float) -> MapSums:
    """Choose the rows of the sums.

    Args:
        lag: [samples].
        points: of a row.
        profiles: rows of the map.
        row_distance: of neighbouring rows, as far as heights vary [samples].
    """
    rows, counts = zip(*_octaves(profiles), strict=True)
    row, count = np.concatenate(rows), np.concatenate(counts)
    # Rows r > 0 apart meet above and below.
    weight = np.where(row > 0, 2.0, 1.0) * count * (profiles - row) / profiles**2
    row = row * row_distance
    pairs = lag.size * (lag.size + 1) // 2
    start = np.empty(pairs * row.size + 1, dtype=np.int64)
    place, number = np.empty((2, 0), dtype=np.int32)
    size = _steps(lag, points, _STEP * row, start, place, number)
    place, number = np.empty((2, size), dtype=np.int32)
    _steps(lag, points, _STEP * row, start, place, number)
    return MapSums(lag, points, row, weight, place, number, start)


def _octaves(profiles: int) -> list[tuple[FloatArray, FloatArray]]:
    """Return rows and the number of rows for which each stands."""
    near = np.arange(float(min(_EVERY_ROW, profiles)))
    found = [(near, np.ones(near.size))]
    first = _EVERY_ROW
    while first < profiles:
        last = min(2 * first, profiles)
        offset, count = _gauss(last - first, _ROWS)
        found.append((first + offset, count))
        first = last
    return found


def _gauss(size: int, most: int) -> tuple[FloatArray, FloatArray]:
    """Return places and weights that add up a polynomial over 0, 1, ... size - 1.

    Source:
        Gauss's rule for the discrete Chebyshev polynomials by the eigenvalues of their
        recurrence: Golub and Welsch, Math. Comp. 23 (1969) 221; recurrence: Gautschi,
        Orthogonal Polynomials (2004), table 1.2.
    """
    order = np.arange(1.0, min(most, size))
    beside = order**2 * (size**2 - order**2) / (4 * (4 * order**2 - 1))
    recurrence = np.diag(np.full(order.size + 1, 0.5 * (size - 1)))
    recurrence += np.diag(np.sqrt(beside), 1) + np.diag(np.sqrt(beside), -1)
    places, vectors = np.linalg.eigh(recurrence)
    return places, size * vectors[0] ** 2


@compiled()
def _steps(
    lag: IntArray,
    points: int,
    least: FloatArray,
    start: IntArray,
    place: Counts,
    count: Counts,
) -> int:
    """Choose the steps of each pair of lags and row; return their number.

    The differences begin d apart; of half the positions, u >= 0, d is >= (a - b) / 2.
    Each step has an odd number of positions and stands for them by its middle.

    Args:
        lag: [samples].
        points: of a row.
        least: positions of a step at least, for each row [-].
        start: first step of each pair and row, filled.
        place: filled, unless it is empty.
        count: filled, unless it is empty.
    """
    end = 0
    k = 0
    for i in range(lag.size):
        for j in range(i, lag.size):
            a, b = lag[i], lag[j]
            for step in least:
                start[k] = end
                k += 1
                here = -((b - a) // 2)
                while here < points - b:
                    # Distance from the next and the last place where c is not smooth.
                    ahead, passed = points, points
                    if here <= 0:
                        ahead = -here
                    elif here <= a:
                        ahead, passed = a - here, here
                    else:
                        passed = here - a
                    size = max(step, _STEP * min(ahead, passed))
                    size = min(size, ahead, points - b - here)
                    middle = 2 * here == a - b  # alone its own mirror image
                    wide = 1 if middle or size < 3 else (int(size) - 1) | 1
                    if place.size:
                        place[end] = here + wide // 2
                        count[end] = 1 if middle else 2 * wide
                    end += 1
                    here += wide
    start[k] = end
    return end


@compiled()
def _sums(
    seen: FloatArray,
    lag: IntArray,
    weight: FloatArray,
    place: Counts,
    count: Counts,
    start: IntArray,
) -> FloatArray:
    """Return twice the weighted mean of c^2 for each pair of lags."""
    points = seen.shape[1]
    sums = np.zeros((lag.size, lag.size))
    k = 0
    for i in range(lag.size):
        for j in range(i, lag.size):
            a, b = lag[i], lag[j]
            total = 0.0
            for row in range(weight.size):
                own, part = seen[row], 0.0
                for at in range(start[k], start[k + 1]):
                    d = place[at]
                    near = own[abs(d)] + own[d + b - a]
                    c = own[abs(d - a)] + own[d + b] - near
                    # Pairs of positions, and the squares of twice c.
                    part += count[at] * (points - b - max(d, 0)) * c * c
                total += 0.25 * weight[row] * part
                k += 1
            sums[i, j] = 2 * total / ((points - a) * (points - b))
            sums[j, i] = sums[i, j]
    return sums
