# SPDX-License-Identifier: MIT
"""Height images that Keyence VK and VR microscopes export as CSV, in English.

The layout is known from public parsers, not from the maker: quoted cells; a header of
keys and values whose number of rows varies with the model; a row that reads "Height";
then one row of cells for each row of the image. A key may hold a line break inside
its quotes, so a CSV reader reads it, never a split by lines.
"""

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import FormatError, HostileFile, UnitError
from jointbench.acquisition.records import Step, step
from jointbench.acquisition.surfaces import Areal, SurfaceInstrument
from jointbench.acquisition.tables import DECIMAL_COMMA, MAX_CELLS, parse_cell
from jointbench.acquisition.text_files import decode, named, shown
from jointbench.acquisition.units import to_si

_MARK = "ImageDataCsv"
_KEY = "XY Calibration"
_LABEL = "Height"
_HEAD_BYTES = 8192
_MAX_HEADER_ROWS = 100
_NEEDED = (_KEY, "Output image data", "Horizontal", "Vertical", "Unit")
_KEPT = {
    "Measured date": "measured",
    "Measurement data name": "data_name",
    "Measurement Mode": "measurement_mode",
    "Objective Lens Power": "objective_lens_power",
    "Lens power": "objective_lens_power",
}

_Header = dict[str, list[str]]


def is_keyence(data: bytes) -> bool:
    """Tell by the content whether a file is a Keyence image CSV of any language."""
    head = data[:_HEAD_BYTES].replace(b"\x00", b"")  # UTF-16 counts too
    return _MARK.encode() in head or _KEY.encode() in head


def parse_keyence(data: bytes, path: Path, origin: Step, name: str) -> Areal:
    """Read a height image.

    Args:
        data: content of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the surface.

    Returns:
        The heights [m]; empty cells are marked as missing. The header may declare
        more rows than the file holds: provenance tells both numbers.

    Raises:
        FormatError: not English, not a height image, decimal commas, rows cut short.
        UnitError: a unit of length is missing or unknown.
    """
    if _KEY.encode() not in data[:_HEAD_BYTES].replace(b"\x00", b""):
        raise FormatError(
            f"{named(path)} is a Keyence CSV whose labels are not English; only the "
            "English export is read: set the analyser to English and export again"
        )
    text, encoding = decode(data, path)
    rows = _csv_rows(text, path)
    header = _read_header(rows, path)
    width, height, pitch, unit = _read_geometry(header, path)
    heights = _read_heights(rows, width, height, path)
    missing = np.isnan(heights)
    return Areal(
        name=name,
        heights=np.where(missing, 0.0, heights) * unit,
        spacing=(pitch, pitch),
        valid=~missing,
        instrument=SurfaceInstrument(name=_text(header, "Model")),
        provenance=(origin, _describe(header, heights, height, encoding)),
    )


def _csv_rows(text: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the line number and the cells of each row."""
    reader = csv.reader(io.StringIO(text), delimiter=_delimiter(text), strict=True)
    try:
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise FormatError(
            f"{named(path)}: line {reader.line_num}: {error}; the quotes of a cell do "
            "not close, export the file again"
        ) from error


def _delimiter(text: str) -> str:
    """Return what stands behind the key of the calibration."""
    behind = text[text.index(_KEY) + len(_KEY) :].lstrip('" \n')
    return behind[0] if behind[:1] in {";", "\t"} else ","


def _read_header(rows: Iterator[tuple[int, list[str]]], path: Path) -> _Header:
    """Read keys and values down to the row that says that heights follow."""
    header: _Header = {}
    for _, row in rows:
        cells = [" ".join(cell.split()) for cell in row]
        filled = [cell for cell in cells if cell]
        if filled == [_LABEL] and "Unit" in header:
            break
        if filled:
            header[cells[0]] = cells[1:]
        if len(header) > _MAX_HEADER_ROWS:
            break
    else:
        raise FormatError(
            f"{named(path)} ends before a row that reads {_LABEL!r}; it is cut short, "
            "export it again"
        )
    lacking = [key for key in _NEEDED if not any(header.get(key, []))]
    if lacking:
        raise FormatError(
            f"{named(path)} has no value for {lacking[0]!r} in its header; export the "
            "height image with its header"
        )
    return header


def _read_geometry(header: _Header, path: Path) -> tuple[int, int, float, float]:
    """Return declared width and height, pitch [m] and unit of the heights [m]."""
    kind = _text(header, "Output image data")
    if kind != _LABEL:
        raise FormatError(
            f"{named(path)} holds {shown(kind)}, not {_LABEL!r}; export the heights"
        )
    width = _number(header, "Horizontal", path)
    height = _number(header, "Vertical", path)
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
    calibration = [cell for cell in header[_KEY] if cell]
    unit = calibration[1] if len(calibration) > 1 else ""
    pitch = _number(header, _KEY, path) * _length_unit(unit, _KEY, path)
    if pitch <= 0:
        raise FormatError(f"{named(path)}: {_KEY!r} is {pitch:g} m, must be above zero")
    heights_unit = _length_unit(_text(header, "Unit"), "Unit", path)
    return int(width), int(height), pitch, heights_unit


def _length_unit(unit: str, key: str, path: Path) -> float:
    try:
        return to_si(unit, "length")
    except UnitError as error:
        raise UnitError(f"{named(path)}: {key!r}: {error}") from error


def _number(header: _Header, key: str, path: Path) -> float:
    cell = _text(header, key)
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


def _text(header: _Header, key: str) -> str:
    return next((cell for cell in header.get(key, []) if cell), "")


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
                f"declares {width} (Horizontal); the file is cut short or has decimal "
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
    kept = {new: _text(header, old) for old, new in _KEPT.items() if _text(header, old)}
    rows = heights.shape[0]
    note = f"declares {declared} rows, holds {rows}" if rows != declared else "complete"
    return step(
        "recognise",
        format="Keyence image CSV, English",
        reason=f"header holds {_MARK} or {_KEY!r}",
        encoding=encoding,
        declared_rows=declared,
        rows=rows,
        completeness=note,
        xy_calibration=" ".join(header[_KEY]).strip(),
        height_unit=_text(header, "Unit"),
        missing_points=int(np.isnan(heights).sum()),
        **kept,
    )
