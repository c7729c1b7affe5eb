# SPDX-License-Identifier: MIT
"""Stylus profiles whose layout the manufacturer documents, but not the pitch.

Mitutoyo SJ-301, profile points as CSV (manual 99MBB091A, p. 8-4): the first line is a
comment in quotes and the number of points, settings follow line by line, and the
heights stand in the last column from the first line or the second on. Neither the unit
of the heights nor their distance is in the file.

Mahr MarSurf M 300, PS1 and M 400, profile as TXT (manual of the M 300, p. 39): whole
numbers, converted to micrometres by the vertical resolution after the word RES. Their
distance is in no public document.

What is missing comes from ``--columns z:um@0.5um``: heights in um, 0.5 um apart.
"""

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, UnitError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.columns import Column
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.number_grids import (
    count_of,
    masked,
    number_of,
    parse_cells,
)
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument

_HEAD = 60
_MICROMETRE = 1e-6
_MITUTOYO_FIRST = re.compile(r'\s*"[^"]*"\s*[,;]\s*\d{2,}\s*')
_MITUTOYO_PROFILE = re.compile(r"\s*\"?profile\s*=\s*\w+", re.I)
_RESOLUTION = re.compile(r"\s*\W?RES\W?\s*[=:;,\t ]\s*(?P<value>[^\s;,]+).*")
_WHOLE = re.compile(r"\s*[+-]?\d+\s*")
_EXAMPLE = "--columns 'z:um@0.5um'"


def is_stylus_list(lines: Sequence[str]) -> bool:
    """Recognise one of the two by its first lines."""
    return _is_mitutoyo(lines) or _resolution_line(lines) is not None


def parse_stylus_list(
    lines: Sequence[str], path: Path, origin: Step, name: str, column: Column | None
) -> Profile:
    """Read a profile of a Mitutoyo SJ or a Mahr MarSurf.

    Args:
        lines: of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the profile.
        column: unit of the heights and their distance, as typed; None where nothing
            was.

    Returns:
        The heights [m] at that distance.

    Raises:
        UnitError: `column` is None or has no distance.
        FormatError: heights are missing, or not as many as declared.
    """
    mitutoyo = _is_mitutoyo(lines)
    maker = "Mitutoyo SJ" if mitutoyo else "Mahr MarSurf"
    if column is None or column.spacing is None:
        lacks = "unit and distance" if mitutoyo else "distance"
        raise UnitError(
            f"{named(path)} is a {maker} profile, which does not say the {lacks} of "
            f"its heights; say them as set on the instrument, for example {_EXAMPLE}"
        )
    if mitutoyo:
        heights, note = _mitutoyo(lines, path)
        heights = heights * column.factor
    else:
        heights, note = _mahr(lines, path)
    plain, valid = masked(heights, path)
    return Profile(
        name=name,
        heights=plain,
        spacing=column.spacing,
        valid=valid,
        instrument=SurfaceInstrument(name=maker),
        provenance=(
            origin,
            step(
                "recognise",
                format=f"{maker} text",
                reason="a quoted comment with the number of points, then profile="
                if mitutoyo
                else "whole numbers below a resolution RES",
                spacing=f"{column.spacing:g} m, as given",
                missing_points=int((~valid).sum()),
                told=note,
            ),
        ),
    )


def _is_mitutoyo(lines: Sequence[str]) -> bool:
    first = bool(lines) and _MITUTOYO_FIRST.fullmatch(lines[0].rstrip(",;")) is not None
    return first and any(_MITUTOYO_PROFILE.match(line) for line in lines[1:_HEAD])


def _mitutoyo(lines: Sequence[str], path: Path) -> tuple[FloatArray, str]:
    """Return the heights in the unit of the file, and its settings in words."""
    rows = [row for row in csv.reader(lines) if any(cell.strip() for cell in row)]
    first = [cell.strip() for cell in rows[0] if cell.strip()]
    count = count_of(first[1], "the number of points", path)
    last = max(len(row) for row in rows[1:])
    cells = [row[last - 1].strip() for row in rows[1:] if len(row) == last]
    if last == 1 or len(cells) != count:
        found = 0 if last == 1 else len(cells)
        raise FormatError(
            f"{named(path)} declares {count} points and holds {found} in its last "
            "column; the file is cut short or mixed, export it again"
        )
    settings = [row[0].strip() for row in rows[1:_HEAD] if row[0].strip()]
    return parse_cells(cells, 2, path, each_own_line=True), "; ".join(settings[:8])


def _resolution_line(lines: Sequence[str]) -> int | None:
    """Return the line of the vertical resolution where whole numbers end the file."""
    for i, line in enumerate(lines[:_HEAD]):
        if _RESOLUTION.fullmatch(line):
            below = [text for text in lines[i + 1 :] if text.strip(" \t\x1a")]
            whole = bool(below) and _WHOLE.fullmatch(below[-1]) is not None
            return i if whole else None
    return None


def _mahr(lines: Sequence[str], path: Path) -> tuple[FloatArray, str]:
    """Return the heights in metres, and the header in words."""
    place = _resolution_line(lines) or 0
    match = _RESOLUTION.fullmatch(lines[place])
    cell = match["value"] if match else ""
    resolution = number_of(cell, "the resolution RES", path) * _MICROMETRE
    end = len(lines)
    while end > 0 and not lines[end - 1].strip(" \t\x1a"):
        end -= 1
    start = end
    while start > place + 1 and _WHOLE.fullmatch(lines[start - 1]):
        start -= 1
    head = [line.strip() for line in lines[:start] if line.strip()]
    broken = next((k for k in range(place + 1, start) if _is_data(lines, k)), None)
    if broken is not None:
        raise FormatError(
            f"{named(path)}: whole numbers begin at line {broken + 1} and are broken "
            f"by line {start}; the file is mixed, export it again"
        )
    heights = np.array([float(line) for line in lines[start:end]])
    return heights * resolution, "; ".join(head[:8])


def _is_data(lines: Sequence[str], k: int) -> bool:
    """Return whether there are three consecutive whole numbers from line k on."""
    return all(_WHOLE.fullmatch(line) is not None for line in lines[k : k + 3])


def _recognise(file: HeightFile) -> bool:
    single = file.columns is None or len(file.columns) == 1
    return single and is_stylus_list(file.lines)


def _read_format(file: HeightFile) -> Profile:
    column = None if file.columns is None else file.columns[0]
    return parse_stylus_list(file.lines, file.path, file.origin, file.label, column)


FORMAT = HeightFormat("stylus-list", _recognise, _read_format, with_columns=True)
