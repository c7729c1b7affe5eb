# SPDX-License-Identifier: MIT
"""Covariance of an estimated structure function, exact for Gaussian heights.

Differences dz_a(i) = z(i+a) - z(i) of heights with structure function S have

    cov(dz_a(i), dz_b(i+d)) = [S(d-a) + S(d+b) - S(d) - S(d+b-a)] / 2 = c(d),

and for Gaussian heights cov(S_a, S_b) is twice the mean of c^2 over all pairs of
positions. That holds for any S, so it includes noise and point spread without further
terms. The sum over d is smooth away from the four places where an argument of S is
zero, so its steps widen away from them: exact near them, at a cost that grows only with
    the logarithm of the length.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, read_only
from jointbench.acquisition.basics.compiled import compiled
from jointbench.signal.fractal.map_covariance import map_sums
from jointbench.signal.surface.structure_function import Sampling, StructureFunction

EXACT_STEPS = 20
"""Single steps on each side of a kink of c(d) [samples]."""
GROWTH = 1.08
"""Ratio of neighbouring steps beyond them [-]; with both the covariance of a profile is
within 1.5e-4 of the full sum, and within 4e-5 where it is not very jagged."""
EXACT_ROWS = 16
"""Single steps between rows [rows]."""
ROW_GROWTH = 1.08
"""Ratio of neighbouring steps between rows beyond them [-]."""
_KEPT = 64
"""Surfaces whose covariance is kept: a search comes back to them [-]."""
_SAME = 1e-3
"""Difference of ln S, but for its mean, up to which two surfaces have one covariance
[-]: chi2 changes by about as much."""
_PROBES = 12
"""Lags at which ln S of two surfaces is compared [-]."""

Places = NDArray[np.uint32]
"""Indices without a sign: no check for a count from the end, half the memory."""
Seen = Callable[[FloatArray], FloatArray]
"""Structure function of the sampled heights, at lags in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """Points of S and weights of the sums for one contact surface: see `_plan`.

    Attributes:
        first: index of the smaller lag of each pair of lags, shape (n_sums,).
        second: index of the larger lag, same shape.
        distance: distinct distances along the profile [samples], shape (n_distances,).
        places: indices into `distance` of the four terms, shape (4, n_points).
        weight: weight of each point of the sums, shape (n_points,).
        starts: first point of each sum, shape (n_sums,).
        row_distance: distances across the profiles [samples], shape (n_rows,).
        row_weight: their weights, same shape.
    """

    first: IntArray
    second: IntArray
    distance: FloatArray
    places: Places
    weight: FloatArray
    starts: IntArray
    row_distance: FloatArray
    row_weight: FloatArray


def structure_covariance(estimate: StructureFunction) -> Callable[[Seen], FloatArray]:
    """Prepare the covariance of a structure function for any model of S.

    The points of evaluation depend on lags and sampling only, so they are chosen once.

    Args:
        estimate: the structure function; its values are not used.

    Returns:
        A function that takes a model of S (called with distances [m] of any shape)
        and returns cov(S_a, S_b) / (S(a) S(b)), shape (n_lags, n_lags) [-],
        read-only. The last ones are kept: a model of nearly the form of one of them
        gets its covariance.
    """
    sums = [_sums_of(estimate.lag, sampling) for sampling in estimate.samplings]
    farthest = max(s.points * s.spacing for s in estimate.samplings)
    probes = np.geomspace(estimate.lag[0], farthest, _PROBES)
    kept: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=_KEPT)

    def covariance(seen: Seen) -> FloatArray:
        """Return the covariance of a model, or that of one of the same form."""
        form = np.log(seen(probes))
        form -= form.mean()
        for known, found in reversed(kept):
            if np.abs(form - known).max() < _SAME:
                return found
        kept.append((form, read_only(added_up(seen))))
        return kept[-1][1]

    def added_up(seen: Seen) -> FloatArray:
        """Add up the covariances of the contact surfaces, each with its share of S."""
        value = seen(estimate.lag)
        total = np.zeros((value.size, value.size))
        for sampling, part in zip(estimate.samplings, sums, strict=True):
            own = part(seen) / np.outer(value, value)
            total += sampling.share**2 * _for_gaps(own, sampling, estimate.lag)
        return total

    return covariance


def _sums_of(lag: FloatArray, sampling: Sampling) -> Callable[[Seen], FloatArray]:
    """Return the covariance of one contact surface for a model of S."""
    spacing = sampling.spacing
    steps = _steps(lag, spacing)
    if sampling.profiles > 1 and np.isfinite(sampling.row_distance):
        whole = np.rint(steps).astype(np.int64)
        if np.array_equal(whole, steps):
            distance = sampling.row_distance / spacing
            rows = map_sums(whole, sampling.points, sampling.profiles, distance)
            return lambda seen: rows.covariance(seen(spacing * rows.distance))
    plan = _plan(steps, sampling)
    return lambda seen: _evaluate(plan, spacing, seen)


def _steps(lag: FloatArray, spacing: float) -> FloatArray:
    """Return lags [samples]; those of the surface's own grid stay exact integers."""
    steps = lag / spacing
    whole = np.rint(steps)
    return np.where(np.abs(steps - whole) < 1e-6 * steps, whole, steps)


def _for_gaps(
    covariance: FloatArray, sampling: Sampling, lag: FloatArray
) -> FloatArray:
    """Widen a relative covariance where points are missing.

    Gaps in a block shorten the profile, so the covariance scales with the remaining
    pairs; scattered gaps also sample the pairs of each lag independently, which adds
    the variance 2 S^2 / pairs of a mean over fewer differences.
    """
    full = sampling.profiles * (sampling.points - lag / sampling.spacing)
    lost = np.maximum(full / np.maximum(sampling.pairs, 1.0), 1.0)
    widened: FloatArray = covariance * np.sqrt(np.outer(lost, lost))
    return widened + np.diag(2 * (lost - 1) / full)


def _evaluate(plan: _Plan, spacing: float, seen: Seen) -> FloatArray:
    """Add up the squares of c over all distances between two differences."""
    # All rows at once: a call of the model costs more than most of its points.
    across = np.hypot(plan.distance, plan.row_distance[:, None])
    sums = np.zeros(plan.starts.size)
    for values, weight in zip(seen(across * spacing), plan.row_weight, strict=True):
        sums += weight * _squares(values, plan.places, plan.weight, plan.starts)
    size = int(plan.second.max()) + 1
    covariance = np.empty((size, size))
    covariance[plan.first, plan.second] = sums
    covariance[plan.second, plan.first] = sums
    return covariance


@compiled()
def _squares(
    values: FloatArray, places: Places, weight: FloatArray, starts: IntArray
) -> FloatArray:
    """Return the weighted squares of c added up for each pair of lags, (n_sums,)."""
    sums = np.zeros(starts.size)
    for k in range(starts.size):
        end = starts[k + 1] if k + 1 < starts.size else weight.size
        for i in range(starts[k], end):
            near = values[places[2, i]] + values[places[3, i]]
            twice = values[places[0, i]] + values[places[1, i]] - near
            sums[k] += 0.25 * weight[i] * twice * twice
    return sums


def _plan(steps: FloatArray, sampling: Sampling) -> _Plan:
    """Prepare the sums of one surface for all pairs of lags [samples]."""
    first, second = np.triu_indices(steps.size)
    offsets = _graded(sampling.points, EXACT_STEPS, GROWTH)
    offsets = np.concatenate([-offsets[:0:-1], offsets])
    points, weights = [], []
    for a, b in zip(steps[first], steps[second], strict=True):
        distance, weight = _points(float(a), float(b), sampling.points, offsets)
        points.append(distance)
        weights.append(weight)
    counts = np.array([p.size for p in points])
    d = np.concatenate(points)
    a, b = np.repeat(steps[first], counts), np.repeat(steps[second], counts)
    distance, places = _distinct(np.abs(np.stack([d - a, d + b, d, d + b - a])))
    rows, row_weight = _rows(sampling.profiles)
    row_distance = sampling.row_distance
    if np.isinf(row_distance):  # unrelated profiles: no cross terms
        rows, row_weight, row_distance = rows[:1], row_weight[:1], 0.0
    return _Plan(
        first=first,
        second=second,
        distance=distance,
        places=places,
        weight=np.concatenate(weights),
        starts=np.concatenate([[0], np.cumsum(counts)[:-1]]),
        row_distance=rows * row_distance / sampling.spacing,
        row_weight=row_weight,
    )


def _distinct(values: FloatArray) -> tuple[FloatArray, Places]:
    """Return the distinct values, and the index of each value among them.

    Whole and half steps, the usual case, are marked instead of sorted.
    """
    halves = np.rint(2 * values)
    if not np.array_equal(halves, 2 * values):
        found, places = np.unique(np.round(values, 6), return_inverse=True)
        return found, places.reshape(values.shape).astype(np.uint32)
    index = halves.astype(np.int64)
    met = np.zeros(int(index.max()) + 1, dtype=np.bool_)
    met[index] = True
    return np.flatnonzero(met) / 2, (np.cumsum(met) - 1).astype(np.uint32)[index]


def _points(
    a: float, b: float, length: int, offsets: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return distances d and their weights in 2 mean c(d)^2 for one pair of lags.

    Each step is evaluated at its middle: at its end the sum would have a first-order
        error, the slope of c^2 times the growth of the steps.
    """
    count_a, count_b = length - a, length - b
    near = [np.rint(offsets + kink) for kink in (0.0, a, -b, a - b)]
    d = np.unique(np.concatenate(near))
    d = d[(d > -count_a) & (d < count_b)]
    edges = np.concatenate(
        [[0.5 - count_a], np.floor((d[1:] + d[:-1]) / 2) + 0.5, [count_b - 0.5]]
    )
    middle = (edges[1:] + edges[:-1]) / 2
    overlap = np.minimum(count_a, count_b - middle) - np.maximum(0, -middle)
    return middle, 2 * np.diff(edges) * overlap / (count_a * count_b)


def _rows(profiles: int) -> tuple[FloatArray, FloatArray]:
    """Return distances between profiles [rows] and their weights in the mean."""
    rows = _graded(profiles, EXACT_ROWS, ROW_GROWTH)
    rows = rows[rows < profiles]
    edges = np.concatenate(
        [[-0.5], np.floor((rows[1:] + rows[:-1]) / 2) + 0.5, [profiles - 0.5]]
    )
    middle = (edges[1:] + edges[:-1]) / 2
    weight = 2 * np.diff(edges) * (profiles - middle) / profiles**2
    weight[0] = 1 / profiles
    return rows, weight


def _graded(limit: int, exact: int, growth: float) -> FloatArray:
    """Return whole numbers from 0: single steps first, then steps that widen."""
    wide = exact * growth ** np.arange(
        1, max(1, int(np.log(max(limit, 1) / exact) / np.log(growth)) + 2)
    )
    numbers = np.concatenate([np.arange(exact + 1.0), np.rint(wide)])
    return np.unique(numbers)
