# SPDX-License-Identifier: MIT
"""Structure function at all lags by Fourier transform, of profiles and maps.

The transform gives S as a difference of large sums, which loses digits where S is
small. The mean line or plane is removed first, the loss of digits is bounded, and lags
at which it matters are summed directly.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.surface.levelling import level

_LOST_DIGITS = 1e-9
"""Relative error of S by cancellation beyond which a lag is summed directly [-]."""
_MACHINE = 8 * float(np.finfo(np.float64).eps)
"""Relative error of a transform, over the root of the sum of squares [-]."""
_REACH = 0.1
"""Longest lag of a map over its sides, by default [-]."""
_DIRECTIONS = ((0, 1), (1, 1), (1, 0), (1, -1))
"""Steps along rows and columns of the directions that are compared [-]."""
_COMPARED_LAGS = 12
"""Lags at which directions are compared [-]."""
_CLEAR_LAY = 0.25
"""Least difference of ln S between directions of a lay [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class StructureMap:
    """S at all lags up to a reach.

    Attributes:
        value: S [m^2], NaN where no pair was measured; of a profile shape (n_lags,)
            from lag 0 upward, of a map shape (n_down, 2 n_across - 1) for lags from 0
            upward down the columns and from minus to plus along the rows.
        spacing: of the lags, as in the surface [m].
        summed: lags that were summed directly [-].
    """

    value: FloatArray
    spacing: tuple[float, ...]
    summed: int

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("value", self.value, (None,) * len(self.spacing))
        freeze(self, "value")


def structure_map(surface: Surface, *, reach: float = _REACH) -> StructureMap:
    """Return S at all lags up to a share of the sides.

    Args:
        surface: a profile or a map; levelled here.
        reach: longest lag over the length of each side, up to 1 [-].

    Raises:
        UsageError: the reach is not between 0 and 1.
        SurfaceTooSmall: too few measured points.
    """
    if not 0 < reach <= 1:
        raise UsageError(f"reach is {reach!r}, it must be above 0 and not above 1")
    flat = level(surface)
    lags = tuple(min(n - 1, max(1, round(reach * n))) for n in flat.heights.shape)
    shape = [
        scipy.fft.next_fast_len(n + k)
        for n, k in zip(flat.heights.shape, lags, strict=True)
    ]
    known = flat.valid.astype(np.float64)
    heights = flat.heights * known
    pairs = np.rint(_correlated(known, known, shape, lags))
    cross = _correlated(heights, heights, shape, lags)
    square = heights * heights
    forward = _correlated(known, square, shape, lags)
    backward = _correlated(square, known, shape, lags)
    sums = forward + backward - 2 * cross
    lost = _MACHINE * float(square.sum()) > _LOST_DIGITS * np.maximum(sums, 0)
    for place in np.argwhere(lost & (pairs > 0)):
        sums[tuple(place)] = _direct(heights, known, place, lags)
    value = np.where(pairs > 0, sums / np.maximum(pairs, 1), np.nan)
    spacing = surface.spacing
    return StructureMap(
        value=value,
        spacing=(spacing,) if isinstance(spacing, float) else spacing,
        summed=int(np.count_nonzero(lost)),
    )


def _correlated(
    first: FloatArray, second: FloatArray, shape: list[int], lags: tuple[int, ...]
) -> FloatArray:
    """Return the sums of first(x) second(x + lag), for the lags that are kept."""
    axes = tuple(range(first.ndim))
    one = scipy.fft.rfftn(first, shape, axes=axes)
    other = one if second is first else scipy.fft.rfftn(second, shape, axes=axes)
    product = np.conj(one) * other
    full = scipy.fft.irfftn(product, shape, axes=axes, overwrite_x=True)
    if first.ndim == 1:
        return np.array(full[: lags[0] + 1])
    down = full[: lags[0] + 1]
    return np.concatenate([down[:, -lags[1] :], down[:, : lags[1] + 1]], axis=1)


def _direct(
    heights: FloatArray, known: FloatArray, place: IntArray, lags: tuple[int, ...]
) -> float:
    """Return the sum of squared differences of one lag."""
    steps = [int(k) for k in place]
    if len(steps) > 1:
        steps[1] -= lags[1]
    here = tuple(
        slice(max(0, -k), n - max(0, k))
        for k, n in zip(steps, heights.shape, strict=True)
    )
    there = tuple(
        slice(max(0, k), n - max(0, -k))
        for k, n in zip(steps, heights.shape, strict=True)
    )
    apart = (heights[there] - heights[here]) * known[there] * known[here]
    return float(np.sum(apart * apart))


@dataclass(frozen=True, slots=True, eq=False)
class Isotropy:
    """Whether a map is equally rough in all directions.

    Attributes:
        angle: of the directions compared, from the rows [rad], shape (4,).
        ratio: S in each direction over the geometric mean of all [-], same shape.
        lag: at which they are compared [m], shape (n_lags,), ascending.
        value: S in each direction at these lags [m^2], shape (4, n_lags).
        isotropic: whether S differs by less than 25 % between them.
        reason: one line with the numbers.
    """

    angle: FloatArray
    ratio: FloatArray
    lag: FloatArray
    value: FloatArray
    isotropic: bool
    reason: str


def isotropy(areal: Areal, *, reach: float = _REACH) -> Isotropy:
    """Compare S of a map along its rows, its columns and between them.

    Args:
        areal: the map.
        reach: longest lag over its sides [-].

    Returns:
        Directions and S of each at equal lags, from one step of the coarsest to the
        reach of the shortest.

    Raises:
        UsageError: the map is too small, or too full of gaps, to compare them.
        SurfaceTooSmall: too few measured points.
    """
    found = structure_map(areal, reach=reach)
    middle = (found.value.shape[1] - 1) // 2
    curves = []
    for down, across in _DIRECTIONS:
        ends = [found.value.shape[0] - 1] * bool(down) + [middle] * bool(across)
        most = min(ends)
        steps = np.arange(1, most + 1)
        lag = steps * float(
            np.hypot(down * found.spacing[0], across * found.spacing[1])
        )
        curves.append((lag, found.value[down * steps, middle + across * steps]))
    low, high = max(c[0][0] for c in curves), min(c[0][-1] for c in curves)
    if not high > low or any(np.isnan(value).any() for _, value in curves):
        rows, columns = areal.heights.shape
        raise UsageError(
            f"map {areal.name!r} of {rows} x {columns} points is too small or has too "
            "many gaps to compare directions; measure a larger map"
        )
    lags = np.geomspace(low, high, _COMPARED_LAGS)
    logs = np.array(
        [
            np.interp(np.log(lags), np.log(lag), np.log(np.maximum(value, 1e-300)))
            for lag, value in curves
        ]
    )
    gap = np.mean(logs - logs.mean(axis=0), axis=1)
    angle = np.array(
        [np.arctan2(d * found.spacing[0], a * found.spacing[1]) for d, a in _DIRECTIONS]
    )
    alike = bool(np.ptp(gap) < _CLEAR_LAY)
    top = int(np.argmax(gap))
    reason = (
        f"S is largest at {np.degrees(angle[top]):.0f} degrees from the rows, "
        f"{np.exp(gap[top]):.2f} times the mean of four directions"
    )
    return Isotropy(angle, np.exp(gap), lags, np.exp(logs), alike, reason)
