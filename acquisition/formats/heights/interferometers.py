# SPDX-License-Identifier: MIT
"""Height maps that Wyko/Veeco and Zygo interferometers export as text."""

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.number_grids import (
    count_of,
    masked,
    number_of,
    parse_cells,
    rows_of,
)
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, SurfaceInstrument

WYKO = "Wyko ASCII Data File Format"
ZYGO = "Zygo ASCII Data File - Format"
ZYGO_XYZ = "Zygo XYZ Data File - Format"
_NANOMETRE, _MICROMETRE, _MILLIMETRE = 1e-9, 1e-6, 1e-3
_HEADER_LINES = 200
_ZYGO_HEADER = 14
_ZYGO_COUNTS = {"0": 4096, "1": 32768, "2": 131072}
_ZYGO_INVALID = 2147483640


def is_interferometer(lines: Sequence[str]) -> bool:
    """Recognise such an export by its first line."""
    return lines[0].lstrip("\ufeff").startswith((WYKO, ZYGO, ZYGO_XYZ))


def parse_interferometer(
    lines: Sequence[str], path: Path, origin: Step, name: str
) -> Areal:
    """Read a Wyko or Zygo height map.

    Args:
        lines: of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the map.

    Returns:
        The heights [m]; "Bad" and invalid phases are marked as missing.

    Raises:
        BadData: a header entry is missing or no number, or rows are cut short.

    Source:
        Layouts as public readers take them: prysm (Zygo: heights = phase x scale x
        obliquity x wavelength / counts), Gwyddion and SurfaceTopography (Wyko).
    """
    first = lines[0]
    if first.startswith(WYKO):
        heights, spacing, kind = _wyko(lines, path)
    elif first.startswith(ZYGO_XYZ):
        heights, spacing, kind = _zygo_xyz(lines, path)
    else:
        heights, spacing, kind = _zygo(lines, path)
    plain, valid = masked(heights, path)
    said = step(
        "recognise",
        format=kind,
        reason=f"begins with {first.strip()[:40]!r}",
        missing_points=int((~valid).sum()),
    )
    return Areal(
        name=name,
        heights=plain,
        spacing=spacing,
        valid=valid,
        instrument=SurfaceInstrument(name=kind.split()[0]),
        provenance=(origin, said),
    )


def _wyko(
    lines: Sequence[str], path: Path
) -> tuple[FloatArray, tuple[float, float], str]:
    """Read blocks of name, type, length and value down to RAW_DATA."""
    flags = [*lines[0].split()[-3:], ""]
    header: dict[str, str] = {}
    start = None
    for i, text in enumerate(lines[1:_HEADER_LINES], start=1):
        cells = [cell.strip() for cell in text.split("\t")]
        if cells[0] == "RAW_DATA":
            start = i + 1
            break
        header[cells[0]] = cells[-1]
    if start is None:
        raise FormatError(f"{named(path)} has no block 'RAW_DATA'; export it again")
    # As public readers have it, "X Size" counts the lines of the file.
    rows = count_of(header.get("X Size", ""), "'X Size'", path)
    columns = count_of(header.get("Y Size", ""), "'Y Size'", path)
    pixel = number_of(header.get("Pixel_size", ""), "'Pixel_size'", path) * _MILLIMETRE
    aspect = number_of(header.get("Aspect", "1"), "'Aspect'", path)
    scale = _NANOMETRE
    if flags[1] == "0":  # in wavelengths
        scale *= number_of(header.get("Wavelength", ""), "'Wavelength'", path)
        scale /= number_of(header.get("Mult", "1"), "'Mult'", path)
    # Further blocks may follow the heights.
    body = islice(_numbered(lines, start, "\t"), rows)
    heights = rows_of(body, (rows, columns), path)
    return heights * scale, (pixel, pixel * aspect), "Wyko ASCII"


def _numbered(
    lines: Sequence[str], start: int, delimiter: str | None
) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of each line that holds anything."""
    for i in range(start, len(lines)):
        text = lines[i].strip()
        if text:
            cells = text.split(delimiter)
            yield i + 1, [cell.strip() for cell in cells]


def _zygo_header(lines: Sequence[str], path: Path) -> tuple[tuple[int, int], float]:
    """Return rows and columns of the phase map, and the pixel [m]."""
    if len(lines) <= _ZYGO_HEADER:
        raise FormatError(f"{named(path)} ends within its header; export it again")
    place, optics = lines[3].split(), lines[7].split()
    if len(place) < 4 or len(optics) < 7:
        raise FormatError(
            f"{named(path)}: lines 4 and 8 hold {len(place)} and {len(optics)} "
            "entries, at least 4 and 7 are needed; export it again"
        )
    columns = count_of(place[2], "the width in line 4", path)
    rows = count_of(place[3], "the height in line 4", path)
    return (rows, columns), number_of(optics[6], "the pixel in line 8", path)


def _zygo(
    lines: Sequence[str], path: Path
) -> tuple[FloatArray, tuple[float, float], str]:
    """Read the phases, which end with a '#', as those before them do."""
    shape, pixel = _zygo_header(lines, path)
    optics, counts = lines[7].split(), lines[10].split()[:1]
    if not counts or counts[0] not in _ZYGO_COUNTS:
        raise FormatError(
            f"{named(path)}: line 11 begins with {shown(lines[10].strip())}, a phase "
            f"resolution of {', '.join(_ZYGO_COUNTS)} is needed; export it again"
        )
    scale = number_of(optics[1], "the scale factor in line 8", path)
    scale *= number_of(optics[2], "the wavelength in line 8", path)
    scale *= number_of(optics[4], "the obliquity in line 8", path)
    marks = [i for i, text in enumerate(lines) if text.strip() == "#"]
    if len(marks) < 2:
        raise FormatError(f"{named(path)} lacks a '#' after its data; it is cut short")
    words = " ".join(lines[marks[-2] + 1 : marks[-1]]).split()
    if len(words) != shape[0] * shape[1]:
        raise FormatError(
            f"{named(path)} holds {len(words)} phases, its header declares "
            f"{shape[1]} by {shape[0]}; it is cut short, export it again"
        )
    phase = parse_cells(words, marks[-2] + 2, path).reshape(shape)
    phase = np.where(phase >= _ZYGO_INVALID, np.nan, phase)
    return phase * scale / _ZYGO_COUNTS[counts[0]], (pixel, pixel), "Zygo ASCII"


def _zygo_xyz(
    lines: Sequence[str], path: Path
) -> tuple[FloatArray, tuple[float, float], str]:
    """Read points 'column row height[um]' or 'column row No Data'."""
    shape, pixel = _zygo_header(lines, path)
    start = next((i for i, text in enumerate(lines) if text.strip() == "#"), None)
    if start is None:
        raise FormatError(f"{named(path)} has no '#' below its header; export it again")
    body = [
        (n, cells) for n, cells in _numbered(lines, start + 1, None) if cells != ["#"]
    ]
    if len(body) != shape[0] * shape[1]:
        raise FormatError(
            f"{named(path)} holds {len(body)} points, its header declares {shape[1]} "
            f"by {shape[0]}; it is cut short, export it again"
        )
    heights = np.full(shape, np.nan)
    seen = np.zeros(shape, dtype=np.bool_)
    for number, cells in body:
        if len(cells) < 3 or not all(c.isascii() and c.isdecimal() for c in cells[:2]):
            raise FormatError(
                f"{named(path)}: line {number} is no point of column, row and height"
            )
        place = (int(cells[1]), int(cells[0]))
        if place[0] >= shape[0] or place[1] >= shape[1] or seen[place]:
            raise FormatError(
                f"{named(path)}: line {number} repeats a point or leaves the map"
            )
        seen[place] = True
        if cells[2] != "No":
            heights[place] = parse_cells(cells[2:3], number, path)[0]
    return heights * _MICROMETRE, (pixel, pixel), "Zygo XYZ"


def _recognise(file: HeightFile) -> bool:
    return is_interferometer(file.lines)


def _read_format(file: HeightFile) -> Areal:
    return parse_interferometer(file.lines, file.path, file.origin, file.label)


FORMAT = HeightFormat("interferometer", _recognise, _read_format)
