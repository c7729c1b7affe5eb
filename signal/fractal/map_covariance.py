# SPDX-License-Identifier: MIT
"""Sums of a covariance of S over the pairs of rows of a map.

Rows r apart, differences over lags a <= b have a covariance c(u, r) that is even in u,
the distance of their middles, and smooth but for u = (b - a) / 2 and (a + b) / 2 where
r is small. Its square is added up over u by a few places in runs that are as long as
the distance from these two, or from the row; over r by every row first, then by a few
of each octave.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled

Places = NDArray[np.uint32]
_RUN = 0.5
"""Length of a run of places over the distance from the next one where c is not smooth
[-]; with it and the rows below a covariance is within 2e-4 of the full sum."""
_FEWEST = 8
"""Places of the shortest run of which only four count [-]."""
_INNER, _OUTER = 0.3399810436, 0.8611363116
"""Nodes of Gauss over half the length of a run [-]."""
_ROOM = 64
"""Places of a pair of lags and a row for which there is room at first [-]."""
_FAR = 1e9
"""Distance of a place that is not there [samples]."""
_EVERY_ROW = 4
"""Rows of the nearest that all count; the first octave begins there [rows]."""
_ROWS = 3
"""Rows of each octave: polynomials up to degree 5 are added up exactly [-]."""

_KEPT = 8
"""Grids and lags whose places are kept: a fit of a map has two [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MapSums:
    """Sums over the pairs of rows of a map, for lags of whole samples.

    Attributes:
        lag: [samples], shape (n_lags,).
        points: of a row.
        row: distances of rows, as far as heights vary [samples], shape (n_rows,).
        weight: of each of them in the mean over all pairs of rows [-], same shape.
        place: distances d of the starts of two differences, plus `points` [samples],
            shape (n_places,).
        count: pairs of positions for which each stands, both signs of u [-], same
            shape.
        start: first place of each pair of lags and row, shape (n_pairs * n_rows + 1,).
    """

    lag: IntArray
    points: int
    row: FloatArray
    weight: FloatArray
    place: Places
    count: FloatArray
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

    Those of the last few grids are kept: an instrument's maps have one.

    Args:
        lag: [samples].
        points: of a row.
        profiles: rows of the map.
        row_distance: of neighbouring rows, as far as heights vary [samples].
    """
    return _sums_of_grid(tuple(lag.tolist()), points, profiles, row_distance)


@lru_cache(maxsize=_KEPT)
def _sums_of_grid(
    lags: tuple[int, ...], points: int, profiles: int, row_distance: float
) -> MapSums:
    """Return the sums of a grid, see `map_sums`."""
    lag = np.array(lags)
    rows, counts = zip(*_octaves(profiles), strict=True)
    row, count = np.concatenate(rows), np.concatenate(counts)
    # Rows r > 0 apart meet above and below.
    weight = np.where(row > 0, 2.0, 1.0) * count * (profiles - row) / profiles**2
    row = row * row_distance
    pairs = lag.size * (lag.size + 1) // 2
    start = np.empty(pairs * row.size + 1, dtype=np.int64)
    room = _ROOM * pairs * row.size + points
    while True:
        place, number = np.empty(room, dtype=np.uint32), np.empty(room)
        size = _runs(lag, points, row, start, place, number)
        if size:
            break
        room *= 2
    return MapSums(lag, points, row, weight, place[:size], number[:size], start)


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


@compiled(error_model="numpy")
def _size(ahead: float, passed: float, row: float) -> int:
    """Return the longest run of places in which c is smooth.

    Args:
        ahead: distance to the next place where c is not smooth, from the first of the
            run [samples].
        passed: distance from the last one [samples].
        row: distance of the rows: c is as smooth across it [samples].
    """
    left = max(passed, row)
    right = max(_RUN * row, ahead * _RUN / (1 + _RUN))
    return max(1, int(min(_RUN * left, right)))


@compiled(error_model="numpy")
def _fill_run(
    first: int, size: int, place: Places, weight: FloatArray, end: int
) -> int:
    """Fill in the places of a run that count, and for how many; return their end.

    Of a long run four that are nearly those of Gauss, with weights that add up
    polynomials up to degree 3 exactly.
    """
    if size < _FEWEST:
        for k in range(size):
            place[end + k], weight[end + k] = first + k, 1.0
        return end + size
    middle = 0.5 * (size - 1)
    # Places on both sides of the middle, which may be between two of them.
    near = round(middle + _INNER * 0.5 * size) - middle
    far = round(middle + _OUTER * 0.5 * size) - middle
    moment = size * (size * size - 1) / 24
    outer = (moment - 0.5 * size * near * near) / (far * far - near * near)
    inner = 0.5 * size - outer
    for k in range(4):
        sign = -1 if k % 2 else 1
        apart, own = (near, inner) if k < 2 else (far, outer)
        place[end + k] = first + round(middle + sign * apart)
        weight[end + k] = own
    return end + 4


@compiled(error_model="numpy")
def _runs(
    lag: IntArray,
    points: int,
    rows: FloatArray,
    start: IntArray,
    place: Places,
    weight: FloatArray,
) -> int:
    """Choose the places of each pair of lags and row; return their number.

    The differences begin d apart; of half the positions, u >= 0, d is >= (a - b) / 2,
    and c is not smooth at 0 and a.

    Args:
        lag: [samples].
        points: of a row.
        rows: distances of the rows [samples].
        start: first place of each pair and row, filled as far as there is room.
        place: filled.
        weight: filled.

    Returns:
        Their number, or 0 where there is no room.
    """
    end = 0
    k = 0
    for i in range(lag.size):
        for j in range(i, lag.size):
            a, b = lag[i], lag[j]
            for row in rows:
                start[k] = end
                k += 1
                here, last = -((b - a) // 2), points - b
                begin = end
                if end + last - here > place.size:
                    return 0
                if 2 * here == a - b:  # alone its own mirror image
                    place[end], weight[end] = points + here, 0.5
                    end, here = end + 1, here + 1
                while here < last:
                    ahead, passed, stop = _FAR, float(here - a), last
                    if here < 0:
                        ahead, passed, stop = -here, here - (a - b), 0
                    elif here < a:
                        ahead, passed, stop = a - here, here, a
                    size = min(_size(ahead, passed, row), stop - here, last - here)
                    end = _fill_run(points + here, size, place, weight, end)
                    here += size
                for at in range(begin, end):
                    apart = max(0, int(place[at]) - points)
                    weight[at] *= 2 * (points - b - apart)
    start[k] = end
    return end


@compiled(error_model="numpy")
def _sums(
    seen: FloatArray,
    lag: IntArray,
    weight: FloatArray,
    place: Places,
    count: FloatArray,
    start: IntArray,
) -> FloatArray:
    """Return twice the weighted mean of c^2 for each pair of lags."""
    rows, points = seen.shape
    # Both signs of a distance, so that no sign is looked at below.
    both = np.empty((rows, 2 * points))
    for row in range(rows):
        both[row, points:] = seen[row]
        both[row, 1:points] = seen[row, :0:-1]
    sums = np.zeros((lag.size, lag.size))
    k = 0
    for i in range(lag.size):
        for j in range(i, lag.size):
            a, b = np.uintp(lag[i]), np.uintp(lag[j])
            total = 0.0
            for row in range(rows):
                own, part = both[row], 0.0
                for at in range(start[k], start[k + 1]):
                    d = np.uintp(place[at])
                    near = own[d] + own[d + b - a]
                    c = own[d - a] + own[d + b] - near
                    part += count[at] * c * c
                total += weight[row] * part
                k += 1
            sums[i, j] = total / (2 * (points - lag[i]) * (points - lag[j]))
            sums[j, i] = sums[i, j]
    return sums
