# SPDX-License-Identifier: MIT
"""Start of the numbers of a plain table, and its column separator."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.table_cells import (
    DECIMAL_COMMA,
    MISSING_WORDS,
    NUMBER,
    split_row,
)

MAX_COLUMNS = 512


MAX_HEADER_LINES = 1000


_DELIMITERS = ("\t", ";", ",", "|", None)


DELIMITER_NAMES = {"\t": "tab", None: "blanks"}


_COMMENT = ("#", "%", "//")


_FIRST_OF_NUMBER = frozenset("0123456789+-.")


THOUSANDS = re.compile(r"(?<![\d,])[1-9]\d{0,2}(?:,\d{3})+(?![\d,])")


_GROUPED = re.compile(r"\d(?:\.\d{3})+,\d|\d(?:,\d{3})+\.\d")


@dataclass(frozen=True, slots=True)
class TableStart:
    """First row of numbers, and their layout."""

    line: int
    delimiter: str | None
    columns: int


def find_start(lines: Sequence[str], path: Path) -> TableStart:
    """Find the first two consecutive lines of numbers with the same layout."""
    seen: TableStart | None = None
    for i, line in enumerate(lines[: MAX_HEADER_LINES + 1]):
        if not is_row(line):
            continue
        start = _numeric_layout(i, line)
        if start and seen and _same_layout(start, seen):
            _refuse_rows_above(lines, seen, path)
            return seen
        seen = start
    if seen is not None:  # a table of one row
        return seen
    for i, line in enumerate(lines[: MAX_HEADER_LINES + 1]):
        if _GROUPED.search(line):
            raise FormatError(
                f"{named(path)}: line {i + 1}: {shown(line.strip())} has signs between "
                "thousands; write numbers without them"
            )
    raise FormatError(
        f"{named(path)} holds no table of numbers: no line of its first "
        f"{MAX_HEADER_LINES} is numbers only; its first reads "
        f"{shown(lines[0].strip())}"
    )


def _refuse_rows_above(lines: Sequence[str], start: TableStart, path: Path) -> None:
    """Raise where a row of the table is above the apparent header."""
    for i in range(start.line):
        above = _numeric_layout(i, lines[i]) if is_row(lines[i]) else None
        if above and _same_layout(above, start):
            commas = start.delimiter == ","
            hint = ", or export decimal commas with semicolons between columns"
            raise FormatError(
                f"{named(path)}: line {i + 1} is a row of {start.columns} columns, but "
                f"below it {shown(lines[i + 1].strip())} is none; mend or remove line "
                f"{i + 2}{hint if commas else ''}"
            )


def is_row(line: str) -> bool:
    """Return whether a line is neither empty nor a comment."""
    if line[:1] in _FIRST_OF_NUMBER and line:
        return True
    return bool(line.strip(" \t\x1a\f")) and not line.lstrip().startswith(_COMMENT)


def _numeric_layout(index: int, line: str) -> TableStart | None:
    """Return how a line of numbers is split, or None if it is no such line."""
    for delimiter in _DELIMITERS:
        if delimiter is not None and delimiter not in line:
            continue
        cells = split_row(line, delimiter)
        numeric = sum(_is_number(cell, delimiter) for cell in cells)
        missing = sum(cell.lower() in MISSING_WORDS for cell in cells)
        if numeric and numeric + missing >= len(cells) and len(cells) <= MAX_COLUMNS:
            return TableStart(index, delimiter, len(cells))
    return None


def _is_number(cell: str, delimiter: str | None) -> bool:
    if NUMBER.fullmatch(cell):
        return True
    return delimiter != "," and DECIMAL_COMMA.fullmatch(cell) is not None


def _same_layout(one: TableStart, other: TableStart) -> bool:
    return one.delimiter == other.delimiter and one.columns == other.columns
