# SPDX-License-Identifier: MIT
"""Cells of a line of text: splitting, numbers, missing values."""

import re
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown

MISSING_WORDS = frozenset({"", "nan", "bad", "n/a", "na", "null", "-", "--", "---"})
NUMBER = re.compile(r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf|nan)", re.I)
DECIMAL_COMMA = re.compile(r"[+-]?(?:\d+,\d*|,\d+)(?:[eE][+-]?\d+)?")


def split_row(line: str, delimiter: str | None) -> list[str]:
    """Split a line into cells without quotes and blanks."""
    return [cell.strip().strip('"').strip() for cell in line.split(delimiter)]


def parse_cell(cell: str, line: int, path: Path) -> float:
    """Read one cell; NaN where it is empty or a word for "no value".

    Raises:
        FormatError: it is no number; the message names the line.
    """
    if NUMBER.fullmatch(cell):
        return float(cell)
    if cell.lower() in MISSING_WORDS:
        return float("nan")
    if DECIMAL_COMMA.fullmatch(cell):
        raise FormatError(
            f"{named(path)}: line {line}: {shown(cell)} has a decimal comma, this "
            "format has points; export it with points"
        )
    raise FormatError(
        f"{named(path)}: line {line}: {shown(cell)} is not a number; every line below "
        "the header must hold numbers only"
    )
