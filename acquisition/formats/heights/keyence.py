# SPDX-License-Identifier: MIT
"""Height images that Keyence VK and VR microscopes export as CSV.

The layout is known from public parsers, not from the manufacturer: quoted cells; a
header of keys and values, in the language of the analyser, whose number of rows varies
with the model; a row that reads "Height"; then one row of cells for each row of the
image. A key may hold a line break inside its quotes, so a CSV reader reads it, never a
split by lines.
"""

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile, UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.heights.height_facts import caution
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.keyence_labels import (
    MARK,
    UNIT_WORDS,
    Language,
    decode_keyence,
    is_keyence,
)
from jointbench.acquisition.formats.table_cells import DECIMAL_COMMA, NUMBER, parse_cell
from jointbench.acquisition.formats.tables import MAX_CELLS
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, SurfaceInstrument

_MAX_HEADER_ROWS = 100
_NEEDED = ("calibration", "output", "columns", "rows", "unit")
_KEPT = ("measured", "data_name", "measurement_mode", "objective_lens_power")


@dataclass(frozen=True, slots=True)
class _Header:
    """Keys and values as read, and their language."""

    cells: dict[str, list[str]]
    language: Language

    def key(self, meaning: str) -> str:
        """Return the key that the file uses for a meaning, or the usual one."""
        words = self.language.words[meaning]
        return next((word for word in words if word in self.cells), words[0])

    def values(self, meaning: str) -> list[str]:
        """Return the non-empty cells after a key."""
        return [cell for cell in self.cells.get(self.key(meaning), []) if cell]

    def text(self, meaning: str) -> str:
        """Return the first of them, empty where there is none."""
        return next(iter(self.values(meaning)), "")


def parse_keyence(data: bytes, path: Path, origin: Step, name: str) -> Areal:
    """Read a height image.

    Args:
        data: content of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the surface.

    Returns:
        The heights [m]; empty cells are marked as missing. The header may declare
        more rows than the file holds: a caution and the provenance give both numbers.

    Raises:
        FormatError: no known language, not a height image, decimal commas, rows cut
            short, heights beyond the declared least or most.
        UnitError: a unit of length is missing or unknown.
    """
    text, encoding, language = decode_keyence(data, path)
    rows = _csv_rows(text, path, language)
    header = _read_header(rows, path, language)
    width, height, pitch, unit = _read_geometry(header, path)
    heights = _read_heights(rows, width, height, path)
    _require_within_declared(header, heights, path)
    missing = np.isnan(heights)
    return Areal(
        name=name,
        heights=np.where(missing, 0.0, heights) * unit,
        spacing=(pitch, pitch),
        valid=~missing,
        instrument=SurfaceInstrument(name=header.text("model")),
        provenance=(
            origin,
            _describe(header, heights, height, encoding),
            *_short_of_rows(heights.shape[0], height),
        ),
    )


def _short_of_rows(rows: int, declared: int) -> tuple[Step, ...]:
    """Return a caution for missing rows; the pitch of the others is correct."""
    if rows == declared:
        return ()
    said = (
        f"the header declares {declared} rows and the file holds {rows}: it is cut "
        "short, or was exported so; the rows that are there are read"
    )
    return (caution(said),)


def _csv_rows(
    text: str, path: Path, language: Language
) -> Iterator[tuple[int, list[str]]]:
    """Yield the line number and the cells of each row."""
    reader = csv.reader(
        io.StringIO(text), delimiter=_delimiter(text, language), strict=True
    )
    try:
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise FormatError(
            f"{named(path)}: line {reader.line_num}: {error}; the quotes of a cell do "
            "not close, export the file again"
        ) from error


def _delimiter(text: str, language: Language) -> str:
    """Return the separator after the key of the calibration."""
    key = language.words["calibration"][0]
    rest = text[text.index(key) + len(key) :].lstrip('" \n')
    return rest[0] if rest[:1] in {";", "\t"} else ","


def _read_header(
    rows: Iterator[tuple[int, list[str]]], path: Path, language: Language
) -> _Header:
    """Read keys and values down to the row that says that heights follow."""
    header = _Header({}, language)
    for _, row in rows:
        cells = [" ".join(cell.split()) for cell in row]
        filled = [cell for cell in cells if cell]
        if filled == [language.height] and header.text("unit"):
            break
        if filled:
            header.cells[cells[0]] = cells[1:]
        if len(header.cells) > _MAX_HEADER_ROWS:
            break
    else:
        raise FormatError(
            f"{named(path)} ends before a row that reads {language.height!r} below "
            f"{header.key('unit')!r}; it is cut short or has no value for the unit, "
            "export it again"
        )
    lacking = [meaning for meaning in _NEEDED if not header.values(meaning)]
    if lacking:
        raise FormatError(
            f"{named(path)} has no value for {header.key(lacking[0])!r} in its header; "
            "export the height image with its header"
        )
    return header


def _read_geometry(header: _Header, path: Path) -> tuple[int, int, float, float]:
    """Return declared width and height, pitch [m] and unit of the heights [m]."""
    kind = header.text("output")
    if kind != header.language.height:
        raise FormatError(
            f"{named(path)} holds {shown(kind)}, not {header.language.height!r}; "
            "export the heights"
        )
    width = _number(header, "columns", path)
    height = _number(header, "rows", path)
    if not (width.is_integer() and height.is_integer()) or min(width, height) < 1:
        raise FormatError(
            f"{named(path)} declares {width:g} by {height:g} points; whole numbers "
            "above zero are needed"
        )
    if width * height > MAX_CELLS:
        raise HostileFile(
            f"{named(path)} declares {width:g} by {height:g} points, at most "
            f"{MAX_CELLS} are read"
        )
    calibration = header.values("calibration")
    unit = calibration[1] if len(calibration) > 1 else ""
    key = header.key("calibration")
    pitch = _number(header, "calibration", path) * _length_unit(unit, key, path)
    if pitch <= 0:
        raise FormatError(f"{named(path)}: {key!r} is {pitch:g} m, must be above zero")
    heights_unit = _length_unit(header.text("unit"), header.key("unit"), path)
    return int(width), int(height), pitch, heights_unit


def _length_unit(unit: str, key: str, path: Path) -> float:
    try:
        return to_si(UNIT_WORDS.get(unit, unit), "length")
    except UnitError as error:
        raise UnitError(f"{named(path)}: {key!r}: {error}") from error


def _number(header: _Header, meaning: str, path: Path) -> float:
    cell, key = header.text(meaning), header.key(meaning)
    if DECIMAL_COMMA.fullmatch(cell):
        raise FormatError(
            f"{named(path)}: {key!r} is {shown(cell)}; decimal commas are not read, "
            "export with decimal points"
        )
    try:
        value = float(cell)
    except ValueError as error:
        raise FormatError(
            f"{named(path)}: {key!r} is {shown(cell)}, a number is needed"
        ) from error
    if not np.isfinite(value):
        raise FormatError(f"{named(path)}: {key!r} is {shown(cell)}, must be finite")
    return value


def _require_within_declared(header: _Header, heights: FloatArray, path: Path) -> None:
    """Refuse heights beyond the least and most that the header states."""
    for meaning, sign in (("least", -1.0), ("most", 1.0)):
        cell = header.text(meaning)
        if not NUMBER.fullmatch(cell) or not np.isfinite(heights).any():
            continue
        extreme = float(np.nanmax(sign * heights))
        last_digit = 10.0 ** -len(cell.partition(".")[2])
        if extreme > sign * float(cell) + 2 * last_digit:
            raise FormatError(
                f"{named(path)} holds a height of {sign * extreme:g}, beyond its "
                f"{header.key(meaning)!r} of {shown(cell)}; a decimal point is lost "
                "or the unit has changed, export it again"
            )


def _read_heights(
    rows: Iterator[tuple[int, list[str]]], width: int, height: int, path: Path
) -> FloatArray:
    image: list[FloatArray] = []
    ended = False
    for line, row in rows:
        cells = row[:-1] if len(row) == width + 1 and not row[-1].strip() else row
        if not cells or (len(cells) < width and not any(c.strip() for c in cells)):
            ended = bool(image)
            continue
        if ended or len(image) == height:
            raise FormatError(
                f"{named(path)}: line {line}: more than the {height} rows of "
                f"heights that the header declares: {shown(row[0])}"
            )
        if len(cells) != width:
            raise FormatError(
                f"{named(path)}: line {line} has {len(cells)} cells, the header "
                f"declares {width} ; the file is cut short or has decimal "
                "commas, export it again"
            )
        image.append(_parse_row(cells, line, path))
    if not image:
        raise FormatError(f"{named(path)} ends before the first row of heights")
    return np.stack(image)


def _parse_row(cells: list[str], line: int, path: Path) -> FloatArray:
    try:
        values = np.array(cells, dtype=np.float64)
    except ValueError:  # an empty cell or worse: look at each
        values = np.array([parse_cell(cell.strip(), line, path) for cell in cells])
    if np.any(np.isinf(values)):
        raise FormatError(f"{named(path)}: line {line} holds an infinite height")
    return values


def _describe(
    header: _Header, heights: FloatArray, declared: int, encoding: str
) -> Step:
    kept = {meaning: header.text(meaning) for meaning in _KEPT if header.text(meaning)}
    rows = heights.shape[0]
    note = f"declares {declared} rows, holds {rows}" if rows != declared else "complete"
    return step(
        "recognise",
        format=f"Keyence image CSV, {header.language.name}",
        reason=f"header holds {MARK} or {header.key('calibration')!r}",
        encoding=encoding,
        declared_rows=declared,
        rows=rows,
        completeness=note,
        xy_calibration=" ".join(header.values("calibration")),
        height_unit=header.text("unit"),
        missing_points=int(np.isnan(heights).sum()),
        **kept,
    )


def _recognise(file: HeightFile) -> bool:
    return is_keyence(file.data)


def _read_format(file: HeightFile) -> Areal:
    return parse_keyence(file.data, file.path, file.origin, file.label)


FORMAT = HeightFormat("keyence", _recognise, _read_format)
