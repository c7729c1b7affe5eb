# SPDX-License-Identifier: MIT
"""Force laws given as curves: tabulated once, interpolated in the time integration.

The motion of a joint ranges from nanometres to tenths of a millimetre. The points of a
table are therefore spaced by asinh: evenly about zero, by a constant ratio further out.
A cubic through four points is within 1e-6 of any power of the motion up to the seventh;
a corner is rounded over 0.4 % of its distance from zero.
"""

import math
from collections.abc import Callable

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.response.response_settings import RESPONSE

_POINTS = RESPONSE.table_points
GRADE = RESPONSE.table_grading
REACH = RESPONSE.table_motion
FASTEST = RESPONSE.table_speed

Curve = Callable[[FloatArray], FloatArray]


@compiled(fastmath=True, forceinline=True)
def look_up(tables: FloatArray, row: int, finest: float, x: float) -> float:
    """Interpolate a row of a table at x by cubics of continuous slope.

    Each cubic passes through two points, with the slopes given by their neighbours
    (Catmull and Rom 1974, A class of local interpolating splines).

    Args:
        tables: shape (n_rows, POINTS).
        row: index of the row.
        finest: spacing scale at zero, in units of x.
        x: argument.
    """
    middle = (tables.shape[1] - 1) // 2
    position = math.asinh(x / finest) * (middle / GRADE) + middle
    index = min(max(math.floor(position), 1), 2 * middle - 2)
    t = min(max(position - index, -1.0), 2.0)
    a, b = tables[row, index - 1], tables[row, index]
    c, d = tables[row, index + 1], tables[row, index + 2]
    bend = 2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)
    return float(b + 0.5 * t * (c - a + t * bend))


@compiled(fastmath=True, forceinline=True)
def curve_force(
    tables: FloatArray, row: int, travel: float, speed: float, r: float, v: float
) -> float:
    """Return spring(r) + damping(r) v + drag(v) [N].

    Args:
        tables: of curves, shape (n_rows, POINTS).
        row: first of the three rows of this law.
        travel: spacing scale of the motion [m].
        speed: spacing scale of the speed [m/s].
        r: motion across the link [m].
        v: its rate [m/s].
    """
    force = look_up(tables, row, travel, r) + look_up(tables, row + 1, travel, r) * v
    return float(force + look_up(tables, row + 2, speed, v))


def tabulate(curve: Curve | None, reach: float) -> FloatArray:
    """Return a curve at the points of a table, shape (POINTS,).

    Args:
        curve: function of an array that returns an array; None for zero.
        reach: largest argument.

    Raises:
        UsageError: the curve returns another shape or non-finite values.
    """
    if curve is None:
        return np.zeros(_POINTS)
    grid = finest_of(reach) * np.sinh(np.linspace(-GRADE, GRADE, _POINTS))
    values = np.asarray(curve(grid), dtype=np.float64)
    if values.shape != grid.shape or not np.all(np.isfinite(values)):
        raise UsageError(
            f"the curve of a force law gives shape {values.shape} with "
            f"{np.count_nonzero(~np.isfinite(values))} values that are not finite; "
            f"it must give {_POINTS} finite values for as many between "
            f"-{reach:g} and {reach:g}"
        )
    return values


def finest_of(reach: float) -> float:
    """Return the spacing scale of a table at zero."""
    return float(reach / np.sinh(GRADE))
