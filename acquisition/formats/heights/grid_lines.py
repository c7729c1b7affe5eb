# SPDX-License-Identifier: MIT
"""Grid lines of a map from the coordinates of its points, in any order."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, SamplingError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.even_steps import fit_even_steps
from jointbench.acquisition.formats.heights.height_facts import caution
from jointbench.acquisition.formats.tables import Table
from jointbench.acquisition.records.provenance import Step

# Largest distance of a coordinate from its grid line [step]; readings closer than
# `_SAME_LINE` of a typical step are the same line.
_OFF_GRID = 0.25
_SAME_LINE = 0.5


@dataclass(frozen=True, slots=True)
class GridAxis:
    """Grid lines of one coordinate.

    Attributes:
        index: number of the grid line of each point, shape (n,).
        count: number of grid lines.
        step: their distance [unit of the file].
    """

    index: IntArray
    count: int
    step: float


def grid_axis(table: Table, index: int, role: str) -> GridAxis:
    """Find the grid lines of a coordinate from all its values.

    Args:
        table: as read.
        index: of the column.
        role: ``"x"`` or ``"y"``, for messages.

    Raises:
        SamplingError: a point has no coordinate.
        FormatError: the values form no even grid.
    """
    values = table.values[index]
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise SamplingError(
            f"{named(table.path)}: {table.where(int(bad[0]))}: {role} is "
            f"{values[bad[0]]}; every point needs its place"
        )
    met, inverse = np.unique(values, return_inverse=True)
    line = _group_lines(met)
    centres = np.bincount(line, weights=met) / np.bincount(line)
    number, spacing = _number_lines(centres, table, role)
    return GridAxis(number[line[inverse]], int(number[-1]) + 1, spacing)


def _group_lines(met: FloatArray) -> IntArray:
    """Group readings of one grid line that differ by the encoder's noise."""
    gaps = np.diff(met)
    if gaps.size == 0:
        return np.zeros(met.size, dtype=np.int64)
    typical = float(np.median(gaps[gaps > _OFF_GRID * gaps.max()]))
    return np.concatenate(([0], np.cumsum(gaps > _SAME_LINE * typical))).astype(
        np.int64
    )


def _number_lines(
    centres: FloatArray, table: Table, role: str
) -> tuple[IntArray, float]:
    """Number the grid lines from 0; a missing line keeps its number."""
    if centres.size == 1:
        return np.zeros(1, dtype=np.int64), 1.0
    try:
        steps = fit_even_steps(centres, what=role, unit="", where=str)
    except SamplingError:
        pass
    else:
        return np.arange(centres.size), steps.step
    gaps = np.diff(centres)
    typical = float(np.median(gaps))
    number = np.concatenate(([0], np.cumsum(np.rint(gaps / typical)))).astype(np.int64)
    spacing = float(centres[-1] - centres[0]) / float(number[-1])
    off = np.abs(centres - centres[0] - number * spacing)
    if off.max() > _OFF_GRID * spacing:
        raise FormatError(
            f"{named(table.path)}: {role} = {centres[np.argmax(off)]:.9g} lies off the "
            f"even grid of step {spacing:.6g} that the other values form; export the "
            "map on a regular grid"
        )
    return number, spacing


def require_single(table: Table, cell: IntArray) -> None:
    """Refuse a table with a repeated grid point.

    Args:
        table: as read.
        cell: number of the grid cell of each row, shape (n_rows,).

    Raises:
        FormatError: it does.
    """
    order = np.argsort(cell, kind="stable")
    repeated = np.flatnonzero(np.diff(cell[order]) == 0)
    if repeated.size:
        first, second = order[repeated[0]], order[repeated[0] + 1]
        raise FormatError(
            f"{named(table.path)}: {table.where(int(second))} repeats the point of "
            f"{table.where(int(first))}; each point of the grid may appear once"
        )


def last_line(x: IntArray, y: IntArray) -> tuple[Step, ...]:
    """Return a caution if the points of a scan end within a line of the map.

    Args:
        x: grid line of each point along the rows, in the order of the file, shape (n,).
        y: the same down the columns.

    Returns:
        One caution, or none: points that were scanned in no lines show nothing.
    """
    turns = [np.flatnonzero(np.diff(one)) + 1 for one in (x, y)]
    fast, turn = (x, turns[1]) if turns[1].size < turns[0].size else (y, turns[0])
    slow = y if fast is x else x
    if turn.size == 0 or turn.size != np.unique(slow).size - 1:
        return ()
    count, width = fast.size - int(turn[-1]), int(fast.max()) + 1
    if count == width or (count > 1 and fast[-1] in (0, width - 1)):
        return ()
    return (
        caution(
            f"the last line of the map ends after {count} of {width} points: if the "
            "file was cut there, the rest is lost; compare it with the original"
        ),
    )
