# SPDX-License-Identifier: MIT
"""Profiles of a map along any direction, through measured points only.

Heights between points would have to be interpolated, which smooths them and biases D;
lines through the grid's own points do not.
"""

from itertools import product
from math import atan2, gcd, hypot, pi

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Areal, Profile

LONGEST_STEP = 5
"""Most grid steps along one axis between neighbouring points of a line [-]."""
SHORTEST_SHARE = 0.5
"""Lines shorter than this share of the longest are left out [-]."""


def profiles_along(areal: Areal, angle: float) -> tuple[Profile, ...]:
    """Return the lines of a map closest to a direction.

    Args:
        areal: the map.
        angle: from the rows towards the columns [rad], any.

    Returns:
        Lines of one spacing, through points of the grid, each adjacent to the previous
        one; their provenance holds the actual angle. Neighbouring lines are not
        independent: `structure_along` takes that into account.

    Raises:
        UsageError: no line of the map has 16 points in that direction.
    """
    down, across = _nearest_step(areal, angle)
    rows, columns = areal.heights.shape
    met = atan2(down * areal.spacing[0], across * areal.spacing[1])
    note = step("profiles_along", asked_rad=angle, met_rad=met)
    starts = [
        (row, column)
        for row, column in product(range(rows), range(columns))
        if not (0 <= row - down < rows and 0 <= column - across < columns)
    ]
    lines = []
    for row, column in sorted(starts, key=lambda s: s[0] * across - s[1] * down):
        length = min(_room(row, down, rows), _room(column, across, columns))
        index = np.arange(length)
        lines.append((row + down * index, column + across * index))
    longest = max(line[0].size for line in lines)
    if longest < 16:
        raise UsageError(
            f"surface {areal.name!r} has at most {longest} points along {angle:g} rad; "
            "choose a direction nearer to rows or columns"
        )
    spacing = hypot(down * areal.spacing[0], across * areal.spacing[1])
    return tuple(
        Profile(
            name=f"{areal.name} line {k}",
            heights=areal.heights[line],
            spacing=spacing,
            valid=areal.valid[line],
            instrument=areal.instrument,
            provenance=(*areal.provenance, note),
        )
        for k, line in enumerate(lines)
        if line[0].size >= SHORTEST_SHARE * longest
    )


def _nearest_step(areal: Areal, angle: float) -> tuple[int, int]:
    """Return the step down and across whose direction is nearest to an angle."""
    reach = range(-LONGEST_STEP, LONGEST_STEP + 1)
    steps = [
        (down, across)
        for down, across in product(range(LONGEST_STEP + 1), reach)
        if gcd(down, across) == 1 and (down or across > 0)
    ]

    def off(one: tuple[int, int]) -> tuple[float, int]:
        met = atan2(one[0] * areal.spacing[0], one[1] * areal.spacing[1])
        apart = abs((met - angle + pi / 2) % pi - pi / 2)
        return round(apart, 12), abs(one[0]) + abs(one[1])

    return min(steps, key=off)


def _room(start: int, move: int, size: int) -> int:
    """Return how many points a line has along one axis."""
    if move == 0:
        return size * LONGEST_STEP * size + 1
    return (size - 1 - start) // move + 1 if move > 0 else start // -move + 1
