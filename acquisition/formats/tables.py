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
from jointbench.acquisition.formats.table_cells import (
    DECIMAL_COMMA,
    MISSING_WORDS,
    NUMBER,
    parse_cell,
    split_row,
)

_MAX_ROWS = 20_000_000
_MAX_COLUMNS = 512
MAX_CELLS = 100_000_000
_MAX_HEADER_LINES = 1000
# Beyond what any instrument reads, and its powers still fit a double [SI unit].
_LARGEST_VALUE = 1e30
_NPY_MAGIC = b"\x93NUMPY"
# What NumPy lets through where the header of an array is no Python literal.
_HEADER_ERRORS = (EOFError, SyntaxError, tokenize.TokenError, RecursionError)
_DELIMITERS = ("\t", ";", ",", "|", None)
_NAMES = {"\t": "tab", None: "blanks"}
_COMMENT = ("#", "%", "//")
_FIRST_OF_NUMBER = frozenset("0123456789+-.")
_BLOCK, _FEW = 65_536, 1024
"""Rows that are parsed at once, and again in fewer where one has no number."""
_TEXT_NEEDED, _CELL_NEEDED = 3, 20
"""Of each character of a text, and of each number in it [bytes]."""
_NEEDED = 24
"""Of each number of an array: as it is read, laid in rows, and in its unit [bytes]."""
_MAX_SLOW_CELLS = 3_000_000
"""Cells in rows that must be read one by one, at about a microsecond each."""
_MISSING_WORD = re.compile(
    r"(?<!\S)(?:" + "|".join(sorted(MISSING_WORDS - {""}, reverse=True)) + r")(?!\S)",
    re.I,
)
_THOUSANDS = re.compile(r"(?<![\d,])[1-9]\d{0,2}(?:,\d{3})+(?![\d,])")
_GROUPED = re.compile(r"\d(?:\.\d{3})+,\d|\d(?:,\d{3})+\.\d")
# ``"0,5","1,5"``: the quotes say that these commas part no columns.
_QUOTED = re.compile(r'"\s*([+-]?\d*),(\d*(?:[eE][+-]?\d+)?)\s*"')


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Numbers of a plain table and where they stood.

    Attributes:
        path: the file.
        values: one row for each column of the file, shape (n_columns, n_rows); NaN
            where a cell is empty or says that there is no value.
        lines: number of the line of each row, from 1; None for an array file.
        header: the lines above the numbers.
        layout: what was recognised, for provenance.
        rows: the text of each row; empty for an array file.
        delimiter: what separates the columns; None for blanks.
    """

    path: Path
    values: FloatArray
    lines: IntArray | None
    header: tuple[str, ...]
    layout: str
    rows: Sequence[str] = ()
    delimiter: str | None = None

    def where(self, row: int) -> str:
        """Name a row as the user finds it: by line, or by index in an array."""
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


@dataclass(frozen=True, slots=True)
class _Start:
    """Where the numbers begin and how they are told apart."""

    line: int
    delimiter: str | None
    columns: int


def read_table(path: Path | str, *, columns: int | None = None) -> FloatArray:
    """Read the numbers of a table.

    Args:
        path: a .npy file, or delimited text with or without header lines.
        columns: how many columns are expected; tells (n, 3) from (3, n) in an array.

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
    """Read a table and remember the line of each row; see `read_table`."""
    path = Path(path)
    if is_array_file(path):
        return _load_array(path, columns)
    text, encoding = decode(read_bytes(path), path)
    lines = text_lines(text, path)
    del text  # as large as the file
    return parse_table(lines, path, encoding)


def is_array_file(path: Path) -> bool:
    """Tell by its first bytes whether a file is a .npy array."""
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
    if any('"' in line for line in lines[: _MAX_HEADER_LINES + 1]):
        lines = [_QUOTED.sub(r"\1.\2", line) for line in lines]
    start = _find_start(lines, path)
    below = range(start.line, len(lines))
    numbers = np.fromiter((i for i in below if _is_row(lines[i])), np.int64)
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
    values = _parse(rows, numbers, start, path)
    delimiter = _NAMES.get(start.delimiter, start.delimiter)
    return Table(
        path=path,
        values=_without_empty_tail(values),
        lines=numbers + 1,
        header=tuple(lines[: start.line]),
        layout=f"text, {encoding}, columns separated by {delimiter}",
        rows=rows,
        delimiter=start.delimiter,
    )


def _with_points(
    rows: list[str], numbers: IntArray, start: _Start, path: Path
) -> list[str]:
    """Return rows whose decimal commas, where they have such, are points.

    A comma that parts no columns is a decimal comma, as most of Europe writes it.

    Raises:
        FormatError: points and commas stand in the same table, or every comma may
            as well part thousands.
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
    if all("," not in _THOUSANDS.sub("", row) for row in rows):
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


def _find_start(lines: Sequence[str], path: Path) -> _Start:
    """Find the first two lines of numbers in a row that agree in layout."""
    seen: _Start | None = None
    for i, line in enumerate(lines[: _MAX_HEADER_LINES + 1]):
        if not _is_row(line):
            continue
        start = _numeric_layout(i, line)
        if start and seen and _same_layout(start, seen):
            _refuse_rows_above(lines, seen, path)
            return seen
        seen = start
    if seen is not None:  # a table of one row
        return seen
    for i, line in enumerate(lines[: _MAX_HEADER_LINES + 1]):
        if _GROUPED.search(line):
            raise FormatError(
                f"{named(path)}: line {i + 1}: {shown(line.strip())} has signs between "
                "thousands; write numbers without them"
            )
    raise FormatError(
        f"{named(path)} holds no table of numbers: no line of its first "
        f"{_MAX_HEADER_LINES} is numbers only; its first reads "
        f"{shown(lines[0].strip())}"
    )


def _refuse_rows_above(lines: Sequence[str], start: _Start, path: Path) -> None:
    """Raise where a row of the table stands above what would pass for its header."""
    for i in range(start.line):
        above = _numeric_layout(i, lines[i]) if _is_row(lines[i]) else None
        if above and _same_layout(above, start):
            raise FormatError(
                f"{named(path)}: line {i + 1} is a row of {start.columns} columns, but "
                f"below it {shown(lines[i + 1].strip())} is none; mend or remove line "
                f"{i + 2}"
            )


def _is_row(line: str) -> bool:
    """Tell whether a line is neither empty nor a comment."""
    if line[:1] in _FIRST_OF_NUMBER and line:
        return True
    return bool(line.strip(" \t\x1a\f")) and not line.lstrip().startswith(_COMMENT)


def _numeric_layout(index: int, line: str) -> _Start | None:
    """Return how a line of numbers is split, or None if it is no such line."""
    for delimiter in _DELIMITERS:
        if delimiter is not None and delimiter not in line:
            continue
        cells = split_row(line, delimiter)
        numeric = sum(_is_number(cell, delimiter) for cell in cells)
        missing = sum(cell.lower() in MISSING_WORDS for cell in cells)
        if numeric and numeric + missing >= len(cells) and len(cells) <= _MAX_COLUMNS:
            return _Start(index, delimiter, len(cells))
    return None


def _is_number(cell: str, delimiter: str | None) -> bool:
    if NUMBER.fullmatch(cell):
        return True
    return delimiter != "," and DECIMAL_COMMA.fullmatch(cell) is not None


def _same_layout(one: _Start, other: _Start) -> bool:
    return one.delimiter == other.delimiter and one.columns == other.columns


def _parse(rows: list[str], numbers: IntArray, start: _Start, path: Path) -> FloatArray:
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


def _with_nan(rows: list[str], start: _Start) -> list[str]:
    """Return rows with ``nan`` in each cell that is empty or says "no value"."""
    if start.delimiter is None:
        return [_MISSING_WORD.sub("nan", row) for row in rows]
    parted = re.escape(start.delimiter)
    words = "|".join(map(re.escape, sorted(MISSING_WORDS, key=len, reverse=True)))
    cell = re.compile(
        rf'(^|{parted})[ ]*+"?[ ]*+(?:{words})[ ]*+"?[ ]*+(?={parted}|$)', re.I
    )
    return [cell.sub(r"\1nan", row.rstrip()) for row in rows]


def _parse_fast(rows: list[str], start: _Start) -> FloatArray | None:
    """Let NumPy read what has a number in every cell; None where one has not."""
    try:
        table = np.loadtxt(
            rows, delimiter=start.delimiter, comments=None, quotechar='"', ndmin=2
        )
    except ValueError:
        return None
    return table.T if table.shape == (len(rows), start.columns) else None


def _parse_carefully(
    rows: list[str], numbers: IntArray, start: _Start, path: Path
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


def _without_empty_tail(values: FloatArray) -> FloatArray:
    """Drop columns that only a separator at the end of every line made."""
    keep = values.shape[0]
    while keep > 1 and np.all(np.isnan(values[keep - 1])):
        keep -= 1
    return values[:keep]


def _columns(array: NDArray[Any]) -> int:
    return 1 if array.ndim == 1 else min(array.shape)


def _load_array(path: Path, columns: int | None) -> Table:
    """Map a .npy file and copy it, once its shape and type are known to be sane."""
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
    if array.ndim not in {1, 2} or not array.size or _columns(array) > _MAX_COLUMNS:
        raise FormatError(
            f"{named(path)} has shape {array.shape}; a table has shape "
            f"(n_columns, n_rows) or (n_rows, n_columns) with at most {_MAX_COLUMNS} "
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
