# SPDX-License-Identifier: MIT
"""Common functions of readers of instrument texts: numbers, lengths, grids."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile, UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.table_cells import NUMBER, parse_cell
from jointbench.acquisition.formats.tables import MAX_CELLS

HIGHEST = 1e3
"""Largest height; larger ones are codes [m]."""


def count_of(cell: str, what: str, path: Path) -> int:
    """Read a number of points that a header declares.

    Raises:
        FormatError: it is no whole number above zero.
        HostileFile: it is more than any map has.
    """
    if not cell.isascii() or not cell.isdecimal() or len(cell) > 12 or int(cell) < 1:
        raise FormatError(
            f"{named(path)}: {what} is {shown(cell)}, a whole number above zero is "
            "needed; export it again"
        )
    if int(cell) > MAX_CELLS:
        raise HostileFile(
            f"{named(path)}: {what} is {shown(cell)}, at most {MAX_CELLS} are read"
        )
    return int(cell)


def number_of(cell: str, what: str, path: Path, *, positive: bool = True) -> float:
    """Read a finite number of a header, above zero by default.

    Raises:
        FormatError: it is none.
    """
    value = float(cell) if NUMBER.fullmatch(cell) else float("nan")
    if not np.isfinite(value) or (positive and value <= 0):
        rule = "a number above zero" if positive else "a number"
        raise FormatError(
            f"{named(path)}: {what} is {shown(cell)}, {rule} is needed; export it "
            "again with decimal points"
        )
    return value


def length_of(cell: str, what: str, path: Path) -> float:
    """Read a length with its unit in metres, above zero.

    Raises:
        UnitError: there is no number with a unit of length.
        FormatError: it is not above zero.
    """
    try:
        value = parse_value(cell, "length")
    except UnitError as error:
        raise UnitError(f"{named(path)}: {what}: {error}") from error
    if not 0 < value < float("inf"):
        raise FormatError(f"{named(path)}: {what} is {shown(cell)}, must be above zero")
    return value


def parse_cells(
    cells: Sequence[str], first_line: int, path: Path, *, each_own_line: bool = False
) -> FloatArray:
    """Read cells of one line, or one per line; NaN for "no value".

    Raises:
        FormatError: a cell is no number, or infinite.
    """
    try:
        values = np.array(cells, dtype=np.float64)
    except ValueError:
        lines = (first_line + i * each_own_line for i in range(len(cells)))
        values = np.array(
            [parse_cell(c.strip(), n, path) for c, n in zip(cells, lines, strict=True)]
        )
    if np.any(np.isinf(values)):
        raise FormatError(f"{named(path)}: line {first_line} on: a height is infinite")
    return values


def rows_of(
    lines: Iterator[tuple[int, list[str]]], shape: tuple[int, int], path: Path
) -> FloatArray:
    """Read rows of heights of a declared shape (n_rows, n_columns).

    Args:
        lines: number and cells of each line.
        shape: declared.
        path: for messages.

    Raises:
        FormatError: a row is shorter or longer, or rows are missing or too many.
        HostileFile: the shape has more points than any map.
    """
    rows, columns = shape
    if rows * columns > MAX_CELLS:
        raise HostileFile(
            f"{named(path)} declares {columns} by {rows} points, at most {MAX_CELLS} "
            "are read"
        )
    found: list[FloatArray] = []
    for number, cells in lines:
        if len(cells) != columns or len(found) == rows:
            raise FormatError(
                f"{named(path)}: line {number}: {len(cells)} cells in row "
                f"{len(found) + 1}, the header declares {rows} rows of {columns}; the "
                "file is cut short or mixed, export it again"
            )
        found.append(parse_cells(cells, number, path))
    if len(found) != rows:
        raise FormatError(
            f"{named(path)} holds {len(found)} rows of heights, its header declares "
            f"{rows}; the file is cut short, export it again"
        )
    return np.stack(found)


def masked(heights: FloatArray, path: Path) -> tuple[FloatArray, BoolArray]:
    """Return heights [m] with 0 for NaN, and the mask of valid ones.

    Raises:
        FormatError: no height is valid, or one is above the limit.
    """
    valid = ~np.isnan(heights)
    if not valid.any():
        raise FormatError(f"{named(path)} holds no height; export it again")
    plain = np.where(valid, heights, 0.0)
    far = float(np.abs(plain).max())
    if far > HIGHEST:
        raise FormatError(
            f"{named(path)} holds a height of {far:g} m, beyond {HIGHEST:g} m; it is "
            "a code for a missing point or a wrong unit: export it again"
        )
    return plain, valid
