# SPDX-License-Identifier: MIT
"""End of a plain table: a file that was cut within its last number."""

import re
from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.table_cells import split_row

_COMPARED = 50
"""Rows above the last one that show how many digits a column is printed with."""
_SURE = 10
"""Rows above it whose equal digits are no chance [-]."""
_PRINTED = re.compile(r"[+-]?\d*(?:\.(\d*))?(?:[eE][+-]?(\d*))?")


def require_whole_end(
    rows: Sequence[str], delimiter: str | None, line: int, path: Path
) -> bool:
    """Refuse a last number with fewer digits than its column has throughout.

    A cut number is a number: ``-0.000`` of ``-0.0004``. Only a file without a line end
    after its last row can be cut so, and only a column printed with one number of
    digits shows it; where zeros at the end are left out it cannot be seen.

    Args:
        rows: texts of all rows, the last of which ends the file.
        delimiter: of the columns; None for blanks.
        line: number of the last line, from 1.
        path: of the file.

    Returns:
        Whether the digits show that the last number is whole.

    Raises:
        FormatError: the last number is cut.
    """
    last = split_row(rows[-1], delimiter)
    above = [split_row(row, delimiter) for row in rows[-1 - _COMPARED : -1]]
    printed = {_digits(row[len(last) - 1]) for row in above if len(row) == len(last)}
    if len(above) < 2 or len(printed) != 1:
        return False
    (wanted,), found = printed, _digits(last[-1])
    if wanted is not None and found is not None and found < wanted:
        raise FormatError(
            f"{named(path)}: line {line} ends with {shown(last[-1])}, the numbers "
            f"above have {wanted[1]} digits after the point and no line end follows; "
            "the file is cut short: use another copy"
        )
    return found is not None and found == wanted and len(above) >= _SURE


def _digits(cell: str) -> tuple[int, int] | None:
    """Return the digits of exponent and fraction; None for no plain number."""
    found = _PRINTED.fullmatch(cell)
    if found is None:
        return None
    return len(found[2] or ""), len(found[1] or "")
