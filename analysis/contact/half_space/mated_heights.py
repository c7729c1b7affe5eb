# SPDX-License-Identifier: MIT
"""Two measured maps in contact: orientation, common grid, sum of their heights."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.surfaces import Areal
from jointbench.signal.surface.levelling import level

LEAST_POINTS = 16
"""Least points of a side of the common map [-]."""
MOST_MISSING = 0.2
"""Largest share of missing points [-]: they are taken as never in contact."""
_SAME = 1e-6
"""Relative difference of two spacings that are one [-]: rounding in the files."""


@dataclass(frozen=True, slots=True, eq=False)
class MatedHeights:
    """Sum of the outward heights of two surfaces where both were measured.

    Attributes:
        heights: [m], shape (n_rows, n_columns), mean 0, tilt removed, form kept.
        spacing: of rows and of columns [m].
        remarks: what was done to the maps, one line each.
    """

    heights: FloatArray
    spacing: tuple[float, float]
    remarks: tuple[str, ...]

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "heights")

    @property
    def area(self) -> float:
        """Area of the map [m^2]."""
        return float(np.prod(self.heights.shape) * np.prod(self.spacing))


def mated_heights(
    lower: Areal, upper: Areal | None, *, turn: int = 0, most_points: int = 512
) -> MatedHeights:
    """Mate two maps; one alone meets a plane.

    Both were measured from outside. The upper one is turned in its own plane as
    measured, then flipped about the direction of its columns, so that its left edge
    lies on the right edge of the lower one. Centres coincide. Form and waviness stay;
    the bodies find their own tilt.

    Args:
        lower: map of one side; its grid is kept.
        upper: map of the other side; None for a rigid plane.
        turn: of the upper one, anticlockwise, a multiple of 90 [deg].
        most_points: of the longer side; larger maps are averaged over blocks.

    Raises:
        UsageError: another angle.
        BadData: too few common points, or too many missing ones.
    """
    first = _complete(lower)
    heights, spacing, remarks = first, lower.spacing, [_missing(lower)]
    if upper is not None:
        other, step = _turned(_complete(upper), upper.spacing, turn)
        remarks.append(_missing(upper))
        heights, said = _sum(first, lower.spacing, other[:, ::-1], step)
        remarks.append(said)
    block = int(np.ceil(max(heights.shape) / most_points))
    if block > 1:
        heights = _averaged(heights, block)
        spacing = (spacing[0] * block, spacing[1] * block)
        remarks.append(
            f"averaged over blocks of {block} x {block} points: shorter waves are left "
            "out"
        )
    if min(heights.shape) < LEAST_POINTS:
        raise BadData(
            f"the maps have {heights.shape[0]} x {heights.shape[1]} points in common, "
            f"at least {LEAST_POINTS} a side are needed; measure a larger map"
        )
    flat = level(
        Areal(lower.name, heights, spacing, np.ones(heights.shape, dtype=np.bool_))
    )
    said_lines = tuple(one for one in remarks if one)
    return MatedHeights(flat.heights - flat.heights.mean(), spacing, said_lines)


def _complete(given: Areal) -> FloatArray:
    """Return levelled heights; missing points are as deep as the deepest."""
    share = 1 - float(given.valid.mean())
    if share > MOST_MISSING:
        raise BadData(
            f"surface {given.name!r} misses {100 * share:.0f} % of its points, at most "
            f"{100 * MOST_MISSING:.0f} % may be missing; measure again or crop the map"
        )
    flat = level(given)
    lowest = float(flat.heights[flat.valid].min())
    return np.where(flat.valid, flat.heights, lowest)


def _missing(given: Areal) -> str:
    share = 1 - float(given.valid.mean())
    if share == 0:
        return ""
    return f"{given.name}: {100 * share:.2g} % missing points are taken as valleys"


def _turned(
    heights: FloatArray, spacing: tuple[float, float], turn: int
) -> tuple[FloatArray, tuple[float, float]]:
    if turn % 90:
        raise UsageError(
            f"--turn is {turn} degrees; give a multiple of 90, which needs no "
            "interpolation of heights"
        )
    times = turn // 90 % 4
    step = spacing[::-1] if times % 2 else spacing
    return np.rot90(heights, times), (step[0], step[1])


def _sum(
    first: FloatArray,
    spacing: tuple[float, float],
    other: FloatArray,
    step: tuple[float, float],
) -> tuple[FloatArray, str]:
    """Return the sum of two maps, centres together, on the grid of the first."""
    if np.allclose(spacing, step, rtol=_SAME, atol=0):
        rows, columns = (min(a, b) for a, b in zip(first.shape, other.shape))  # noqa: B905
        both = _centre(first, rows, columns) + _centre(other, rows, columns)
        return both, ""
    sides = [
        min((a - 1) * s, (b - 1) * t)
        for a, s, b, t in zip(first.shape, spacing, other.shape, step, strict=True)
    ]
    rows, columns = (
        int(side / s * (1 + _SAME)) + 1 for side, s in zip(sides, spacing, strict=True)
    )
    kept = _centre(first, rows, columns)
    axes = [(np.arange(n) - (n - 1) / 2) * t for n, t in zip(other.shape, step)]  # noqa: B905
    places = [
        (np.arange(n) - (n - 1) / 2) * s
        for n, s in zip((rows, columns), spacing, strict=True)
    ]
    at = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)
    field = RegularGridInterpolator(axes, other, bounds_error=False, fill_value=None)
    said = "the second map has another spacing: interpolated, its shortest waves lose"
    return kept + field(at), said


def _centre(heights: FloatArray, rows: int, columns: int) -> FloatArray:
    top, left = (
        (have - want) // 2
        for have, want in zip(heights.shape, (rows, columns), strict=True)
    )
    return heights[top : top + rows, left : left + columns]


def _averaged(heights: FloatArray, block: int) -> FloatArray:
    rows, columns = (n // block for n in heights.shape)
    kept = heights[: rows * block, : columns * block]
    mean: FloatArray = kept.reshape(rows, block, columns, block).mean(axis=(1, 3))
    return mean
