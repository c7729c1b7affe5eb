# SPDX-License-Identifier: MIT
"""Gaussian regression filters of profiles and maps, open and closed, with gaps.

At each point a polynomial is fitted to the measured neighbours with Gaussian weights;
its value there is the filtered height. Where all neighbours are measured, order 0 and 1
are the linear Gaussian filter; at ends and gaps order 1 keeps mean and slope, the
moment criterion of ISO 16610-28.
"""

import numpy as np
import scipy.ndimage

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.roughness.gaussian_weights import (
    LineWeights,
    line_weights,
    weighted_sums,
)

_LEAST_WEIGHT = 1e-7
"""Sum of weights below which no neighbour is measured [-]."""
_LEAST_SPREAD = 1e-10
"""Determinant of the local design, relative, below which the order is reduced [-]."""
_SHORT_KERNEL = 48
"""Half width up to which direct sums are faster than transforms [points]."""


def smooth_line(
    heights: FloatArray,
    share: FloatArray,
    index: float,
    pitch: float,
    *,
    order: int = 1,
    closed: bool = False,
) -> FloatArray:
    """Return the long-wave part of a profile.

    Args:
        heights: [m], shape (n,).
        share: weight of each point [-], shape (n,): 0 where missing.
        index: nesting index [m].
        pitch: [m].
        order: of the local polynomial [-], 0 to 2.
        closed: whether the last point is a neighbour of the first.

    Returns:
        Filtered heights [m]; NaN where no neighbour is measured.

    Raises:
        UsageError: a nesting index below two samples.

    Source:
        ISO 16610-21:2011; ISO 16610-28:2016; ISO 16610-31:2016, formula (1).
    """
    weights = line_weights(index, pitch, order=order)
    middle = _middle(heights, share)
    moments = weighted_sums(
        share, tuple(weights.moment(k) for k in range(2 * order + 1)), closed=closed
    )
    sums = weighted_sums(
        share * (heights - middle),
        tuple(weights.moment(k) for k in range(order + 1)),
        closed=closed,
    )
    local = [[moments[i + j] for j in range(order + 1)] for i in range(order + 1)]
    return middle + _value_at_point(local, list(sums))


def smooth_map(
    heights: FloatArray,
    share: FloatArray,
    index: float,
    pitch: tuple[float, float],
    *,
    order: int = 1,
) -> FloatArray:
    """Return the long-wave part of a map.

    Args:
        heights: [m], shape (rows, columns).
        share: weight of each point [-], same shape: 0 where missing.
        index: nesting index [m].
        pitch: along (rows, columns) [m].
        order: of the local polynomial [-], 0 or 1.

    Returns:
        Filtered heights [m]; NaN where no neighbour is measured.

    Raises:
        UsageError: a nesting index below two samples.

    Source:
        ISO 16610-61:2015; ISO 16610-71:2014.
    """
    down, along = (line_weights(index, one, order=order) for one in pitch)
    middle = _middle(heights, share)
    if order <= 1 and bool((share == 1).all()):
        return middle + _smooth_complete(heights - middle, down, along, order)
    pairs = [(0, 0), (0, 1), (1, 0)][: 1 + 2 * order]
    sums = _map_sums(share * (heights - middle), down, along, pairs)
    steps = [(a + c, b + d) for a, b in pairs for c, d in pairs]
    moments = dict(
        zip(
            sorted(set(steps)),
            _map_sums(share, down, along, sorted(set(steps))),
            strict=True,
        )
    )
    local = [[moments[a + c, b + d] for c, d in pairs] for a, b in pairs]
    return middle + _value_at_point(local, sums)


def _middle(heights: FloatArray, share: FloatArray) -> float:
    """Return the weighted mean, taken out so that sums keep their digits."""
    return float((heights * share).sum() / max(share.sum(), 1e-300))


def _map_sums(
    values: FloatArray,
    down: LineWeights,
    along: LineWeights,
    pairs: list[tuple[int, int]],
) -> list[FloatArray]:
    """Return sums of offsets to the powers of each pair, (rows, columns)."""
    columns = {
        power: axis_sums(values, along.moment(power), 1)
        for power in {second for _, second in pairs}
    }
    return [axis_sums(columns[b], down.moment(a), 0) for a, b in pairs]


def axis_sums(values: FloatArray, kernel: FloatArray, axis: int) -> FloatArray:
    """Return weighted sums along one axis of a map, 0 beyond its ends."""
    if kernel.size // 2 <= _SHORT_KERNEL:
        direct: FloatArray = scipy.ndimage.correlate1d(
            values, kernel, axis=axis, mode="constant"
        )
        return direct
    return weighted_sums(values, (kernel,), axis=axis)[0]


def _value_at_point(
    local: list[list[FloatArray]], sums: list[FloatArray]
) -> FloatArray:
    """Solve the local regression for the height at its own point, by Cramer's rule."""
    plain = sums[0] / np.where(local[0][0] > _LEAST_WEIGHT, local[0][0], np.nan)
    if len(sums) == 1:
        return plain
    whole = _determinant(local)
    first = _determinant([[s, *row[1:]] for s, row in zip(sums, local, strict=True)])
    scale = np.ones_like(whole)
    for k, row in enumerate(local):
        scale = scale * row[k]
    spread = whole > _LEAST_SPREAD * np.abs(scale) + 1e-300
    with np.errstate(invalid="ignore", divide="ignore"):
        solved = first / np.where(spread, whole, 1.0)
    found: FloatArray = np.where(spread & np.isfinite(plain), solved, plain)
    return found


def _determinant(m: list[list[FloatArray]]) -> FloatArray:
    if len(m) == 2:
        return m[0][0] * m[1][1] - m[0][1] * m[1][0]
    (a, b, c), (d, e, f), (g, h, i) = m
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _smooth_complete(
    heights: FloatArray, down: LineWeights, along: LineWeights, order: int
) -> FloatArray:
    """Filter a map without gaps: its weights are products, so that lines suffice.

    With G the means and H the regression along a direction, the local plane is
    H z G' + G z H' - G z G'; H and G differ at the edges only.
    """
    columns = heights.shape[1]
    means = _line_means(heights, along, 1)
    if order == 0:
        return _line_means(means, down, 0)
    found = _line_regression(means, down, 0)
    for edge in _edges(columns, along.half):
        tilt = _slope_part(heights, along, edge)
        found[:, edge] += _line_means(tilt, down, 0)
    return found


def _line_means(values: FloatArray, weights: LineWeights, axis: int) -> FloatArray:
    """Return normalised weighted means along one axis."""
    known = np.ones(values.shape[axis])
    total = weighted_sums(known, (weights.weight,))[0]
    sums = axis_sums(values, weights.weight, axis)
    return sums / (total[:, None] if axis == 0 else total)


def _line_regression(values: FloatArray, weights: LineWeights, axis: int) -> FloatArray:
    """Return the local line along rows (axis 0): means, with slopes at the edges."""
    found = _line_means(values, weights, axis)
    turned = values.T
    for edge in _edges(values.shape[axis], weights.half):
        found[edge] += _slope_part(turned, weights, edge).T
    return found


def _edges(points: int, half: int) -> list[slice]:
    """Return where weights reach beyond an end: two pieces, or all."""
    if points <= 2 * half:
        return [slice(0, points)]
    return [slice(0, half), slice(points - half, points)]


def _slope_part(values: FloatArray, weights: LineWeights, edge: slice) -> FloatArray:
    """Return what a local line adds to the local mean, at columns within `edge`.

    The weights of these columns are a small dense matrix.
    """
    points = values.shape[1]
    middle = np.arange(points)[edge]
    first = max(0, int(middle[0]) - weights.half)
    last = min(points, int(middle[-1]) + weights.half + 1)
    apart = np.arange(first, last) - middle[:, None]
    inside = np.abs(apart) <= weights.half
    place = np.clip(apart + weights.half, 0, weights.weight.size - 1)
    weight = np.where(inside, weights.weight[place], 0.0)
    weight /= weight.sum(axis=1, keepdims=True)
    offset = weights.offset[place]
    mean = (weight * offset).sum(axis=1, keepdims=True)
    spread = (weight * (offset - mean) ** 2).sum(axis=1, keepdims=True)
    operator = -mean * (offset - mean) * weight / np.maximum(spread, 1e-300)
    part: FloatArray = values[:, first:last] @ operator.T
    return part


def known_share(valid: BoolArray) -> FloatArray:
    """Return the weights of measured (1) and missing (0) points."""
    return valid.astype(np.float64)
