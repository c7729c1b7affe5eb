# SPDX-License-Identifier: MIT
"""Rows of a plain table as numbers: in blocks if plain, else cell by cell."""

import re
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.table_cells import (
    MISSING_WORDS,
    parse_cell,
    split_row,
)
from jointbench.acquisition.formats.table_start import (
    TableStart,
)

_BLOCK, _FEW = 65_536, 1024
"""Rows parsed at once, and in smaller blocks where a cell has no number."""


_MAX_SLOW_CELLS = 3_000_000
"""Cells in rows that must be read one by one, at about a microsecond each."""


_MISSING_WORD = re.compile(
    r"(?<!\S)(?:" + "|".join(sorted(MISSING_WORDS - {""}, reverse=True)) + r")(?!\S)",
    re.I,
)


def parse_rows(
    rows: list[str], numbers: IntArray, start: TableStart, path: Path
) -> FloatArray:
    """Read the rows, shape (n_columns, n_rows); empty cells become NaN."""
    values = np.empty((start.columns, len(rows)))
    slow = 0
    for first in range(0, len(rows), _BLOCK):
        block = rows[first : first + _BLOCK]
        found = _parse_fast(block, start)
        if found is not None:
            values[:, first : first + len(block)] = found
            continue
        for few in range(first, first + len(block), _FEW):
            some = slice(few, min(few + _FEW, first + len(block)))
            found = _parse_fast(_with_nan(rows[some], start), start)
            if found is None:
                slow += (some.stop - some.start) * start.columns
                _require_few(slow, path)
                found = _parse_carefully(rows[some], numbers[some], start, path)
            values[:, some] = found
    return values


def _require_few(cells: int, path: Path) -> None:
    if cells > _MAX_SLOW_CELLS:
        raise HostileFile(
            f"{named(path)} holds more than {_MAX_SLOW_CELLS} cells in rows that are "
            "no plain numbers; export it with numbers only"
        )


def _with_nan(rows: list[str], start: TableStart) -> list[str]:
    """Return rows with ``nan`` in each cell that is empty or says "no value"."""
    if start.delimiter is None:
        return [_MISSING_WORD.sub("nan", row) for row in rows]
    parted = re.escape(start.delimiter)
    words = "|".join(map(re.escape, sorted(MISSING_WORDS, key=len, reverse=True)))
    cell = re.compile(
        rf'(^|{parted})[ ]*+"?[ ]*+(?:{words})[ ]*+"?[ ]*+(?={parted}|$)', re.I
    )
    return [cell.sub(r"\1nan", row.rstrip()) for row in rows]


def _parse_fast(rows: list[str], start: TableStart) -> FloatArray | None:
    """Parse rows with NumPy; None if a cell has no number."""
    try:
        table = np.loadtxt(
            rows, delimiter=start.delimiter, comments=None, quotechar='"', ndmin=2
        )
    except ValueError:
        return None
    return table.T if table.shape == (len(rows), start.columns) else None


def _parse_carefully(
    rows: list[str], numbers: IntArray, start: TableStart, path: Path
) -> FloatArray:
    """Read row by row: empty cells become NaN, anything else names its line."""
    values = np.empty((len(rows), start.columns))
    for j, row in enumerate(rows):
        cells = split_row(row, start.delimiter)
        if len(cells) != start.columns:
            raise FormatError(
                f"{named(path)}: line {numbers[j] + 1} has {len(cells)} columns, the "
                f"table began with {start.columns}: {shown(row.strip())}; the file is "
                "cut short or mixed, export it again"
            )
        values[j] = [parse_cell(cell, int(numbers[j]) + 1, path) for cell in cells]
    return values.T


def without_empty_tail(values: FloatArray) -> FloatArray:
    """Drop empty columns due to a separator at the end of every line."""
    keep = values.shape[0]
    while keep > 1 and np.all(np.isnan(values[keep - 1])):
        keep -= 1
    return values[:keep]
