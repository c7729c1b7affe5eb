# SPDX-License-Identifier: MIT
"""Plain tables of numbers: delimited text of any common layout, and .npy arrays."""

import re
import tokenize
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import (
    decode,
    file_size,
    read_bytes,
    text_lines,
)
from jointbench.acquisition.formats.table_end import require_whole_end
from jointbench.acquisition.formats.table_rows import parse_rows, without_empty_tail
from jointbench.acquisition.formats.table_start import (
    DELIMITER_NAMES,
    MAX_COLUMNS,
    MAX_HEADER_LINES,
    THOUSANDS,
    TableStart,
    find_start,
    is_row,
)

_MAX_ROWS = 20_000_000
MAX_CELLS = 100_000_000
# Largest accepted value; its powers still fit a double [SI unit].
_LARGEST_VALUE = 1e30
_NPY_MAGIC = b"\x93NUMPY"
# Exceptions of NumPy for a header that is no Python literal.
_HEADER_ERRORS = (EOFError, SyntaxError, tokenize.TokenError, RecursionError)
_TEXT_NEEDED, _CELL_NEEDED = 3, 20
"""Of each character of a text, and of each number in it [bytes]."""
_NEEDED = 24
"""Of each number of an array: as read, in rows, and in its unit [bytes]."""
# ``"0,5","1,5"``: quoted commas separate no columns.
_QUOTED = re.compile(r'"\s*([+-]?\d*),(\d*(?:[eE][+-]?\d+)?)\s*"')


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Numbers of a plain table with their lines.

    Attributes:
        path: the file.
        values: one row for each column of the file, shape (n_columns, n_rows); NaN
            where a cell is empty or a word for "no value".
        lines: number of the line of each row, from 1; None for an array file.
        header: the lines above the numbers.
        layout: as recognised, for provenance.
        rows: the text of each row; empty for an array file.
        delimiter: what separates the columns; None for blanks.
        open_end: whether the text ends in its last row, which may lack digits.
    """

    path: Path
    values: FloatArray
    lines: IntArray | None
    header: tuple[str, ...]
    layout: str
    rows: Sequence[str] = ()
    delimiter: str | None = None
    open_end: bool = False

    def where(self, row: int) -> str:
        """Return the place of a row: its line, or its index in an array."""
        if self.lines is None:
            return f"index {row}"
        return f"line {self.lines[row]}"

    def require_sane(
        self, column: int, factor: float, what: str, *, skip: BoolArray | None = None
    ) -> None:
        """Raise `FormatError` where |value * factor| exceeds `_LARGEST_VALUE`.

        `what` names the quantity; rows in `skip`, shape (n_rows,), hold no value.
        """
        values = self.values[column]
        with np.errstate(over="ignore"):
            beyond = np.isfinite(values) & (np.abs(values * factor) > _LARGEST_VALUE)
        if skip is not None:
            beyond &= ~skip
        if np.any(beyond):
            row = int(np.argmax(beyond))
            raise FormatError(
                f"{named(self.path)}: {self.where(row)}: {what} is {values[row]:g}, "
                f"beyond {_LARGEST_VALUE:g} in SI; correct the number or its unit"
            )

    def printed_units(self, column: int) -> FloatArray:
        """Return the unit of the last printed digit of each number of a column.

        Returns:
            ``"2.50E-04"`` gives 1e-6; 0 for an array file, shape (n_rows,).
        """
        if not self.rows:
            return np.zeros(self.values.shape[1])
        parts = self.delimiter, column + 1
        digits = (_last_digit(row.split(*parts)[column]) for row in self.rows)
        return np.fromiter(digits, np.float64, len(self.rows))


def read_table(path: Path | str, *, columns: int | None = None) -> FloatArray:
    """Read the numbers of a table.

    Args:
        path: a .npy file, or delimited text with or without header lines.
        columns: expected number of columns, to distinguish (n, 3) from (3, n).

    Returns:
        One row for each column of the file, shape (n_columns, n_rows); NaN where a
        cell is empty or says that there is no value.

    Raises:
        BadData: the file cannot be opened.
        FormatError: it is no such table, or its rows differ in length.
        HostileFile: it is larger than any measurement.
    """
    return load_table(path, columns=columns).values


def load_table(path: Path | str, *, columns: int | None = None) -> Table:
    """Read a table with the line of each row; see `read_table`."""
    path = Path(path)
    if is_array_file(path):
        return _load_array(path, columns)
    text, encoding = decode(read_bytes(path), path)
    lines = text_lines(text, path)
    del text  # as large as the file
    return parse_table(lines, path, encoding)


def is_array_file(path: Path) -> bool:
    """Recognise a .npy array by its first bytes."""
    file_size(path)
    return read_head(path, len(_NPY_MAGIC)) == _NPY_MAGIC


def read_head(path: Path, count: int) -> bytes:
    """Return the first `count` bytes of a file, fewer where it is shorter."""
    try:
        with path.open("rb") as file:
            return file.read(count)
    except OSError as error:
        raise FormatError(f"{named(path)} cannot be read: {error.strerror}") from error


def parse_table(lines: Sequence[str], path: Path, encoding: str) -> Table:
    """Find the numbers in the lines of a text and read them; see `read_table`."""
    if any('"' in line for line in lines[: MAX_HEADER_LINES + 1]):
        lines = [_QUOTED.sub(r"\1.\2", line) for line in lines]
    start = find_start(lines, path)
    below = range(start.line, len(lines))
    numbers = np.fromiter((i for i in below if is_row(lines[i])), np.int64)
    if len(numbers) > _MAX_ROWS or len(numbers) * start.columns > MAX_CELLS:
        raise HostileFile(
            f"{named(path)} has {len(numbers)} rows of {start.columns} columns; "
            f"at most {_MAX_ROWS} rows and {MAX_CELLS} cells are read: cut it"
        )
    text = sum(map(len, lines))
    require_room(
        path, _TEXT_NEEDED * text + _CELL_NEEDED * numbers.size * start.columns
    )
    rows = _with_points([lines[i] for i in numbers], numbers, start, path)
    values = parse_rows(rows, numbers, start, path)
    open_end = bool(numbers[-1] == len(lines) - 1)
    if open_end:
        open_end = not require_whole_end(rows, start.delimiter, len(lines), path)
    delimiter = DELIMITER_NAMES.get(start.delimiter, start.delimiter)
    return Table(
        path=path,
        values=without_empty_tail(values),
        lines=numbers + 1,
        header=tuple(lines[: start.line]),
        layout=f"text, {encoding}, columns separated by {delimiter}",
        rows=rows,
        delimiter=start.delimiter,
        open_end=open_end,
    )


def _with_points(
    rows: list[str], numbers: IntArray, start: TableStart, path: Path
) -> list[str]:
    """Return rows with decimal commas replaced by points.

    A comma that separates no columns is a decimal comma.

    Raises:
        FormatError: points and commas are mixed, or every comma may separate thousands.
    """
    if start.delimiter == "," or not any("," in row for row in rows):
        return rows
    point = next((i for i, row in enumerate(rows) if "." in row), None)
    if point is not None:
        comma = next(row for row in rows if "," in row)
        raise FormatError(
            f"{named(path)}: line {numbers[point] + 1}: {shown(rows[point].strip())} "
            f"has points, another row, {shown(comma.strip())}, has commas; write all "
            "numbers with one decimal sign and without signs between thousands"
        )
    if all("," not in THOUSANDS.sub("", row) for row in rows):
        first = next(i for i, row in enumerate(rows) if "," in row)
        raise FormatError(
            f"{named(path)}: line {numbers[first] + 1}: {shown(rows[first].strip())}: "
            "the commas of this table may be decimal signs or part thousands; write "
            "points, or numbers without signs between thousands"
        )
    return [row.replace(",", ".") for row in rows]


def _last_digit(cell: str) -> float:
    mantissa, _, exponent = cell.strip(' "\t').lower().partition("e")
    point = mantissa.find(".")
    decimals = len(mantissa) - point - 1 if point >= 0 else 0
    return float(10.0 ** (int(exponent or 0) - decimals))


def _columns(array: NDArray[Any]) -> int:
    return 1 if array.ndim == 1 else min(array.shape)


def _load_array(path: Path, columns: int | None) -> Table:
    """Map a .npy file and copy it after a check of shape and type."""
    try:
        array = np.lib.format.open_memmap(path, mode="r")
    except (ValueError, OSError, OverflowError, TypeError, *_HEADER_ERRORS) as error:
        if "Python objects" in str(error):  # np.save wrote them, by pickle
            raise FormatError(
                f"{named(path)} holds Python objects, which are never read because "
                "that runs code; save numbers, as numpy.save(name, array.astype(float))"
            ) from error
        raise FormatError(
            f"{named(path)} is not a whole .npy array of numbers "
            f"({shown(error)}); use another copy"
        ) from error
    if array.dtype.kind not in "fiu":
        raise FormatError(
            f"{named(path)} holds values of type {array.dtype}, real numbers are needed"
        )
    if array.ndim not in {1, 2} or not array.size or _columns(array) > MAX_COLUMNS:
        raise FormatError(
            f"{named(path)} has shape {array.shape}; a table has shape "
            f"(n_columns, n_rows) or (n_rows, n_columns) with at most {MAX_COLUMNS} "
            "columns"
        )
    if array.size > MAX_CELLS:
        raise HostileFile(
            f"{named(path)} holds {array.size} numbers, at most {MAX_CELLS} are read; "
            "cut it"
        )
    require_room(path, _NEEDED * array.size)
    values = np.atleast_2d(np.array(array, dtype=np.float64))
    lying = values.shape[0] <= values.shape[1]
    if columns in values.shape:
        lying = values.shape[0] == columns
    return Table(
        path=path,
        values=np.ascontiguousarray(values if lying else values.T),
        lines=None,
        header=(),
        layout=f"npy, {array.dtype}, shape {array.shape}",
    )
