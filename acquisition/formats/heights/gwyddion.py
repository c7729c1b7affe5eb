# SPDX-License-Identifier: MIT
"""Height maps that Gwyddion writes as a text matrix with a header of four lines."""

import re
from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError, UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.heights.height_facts import caution
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.number_grids import (
    length_of,
    masked,
    rows_of,
)
from jointbench.acquisition.formats.heights.stated_lengths import half_digit
from jointbench.acquisition.formats.table_cells import NUMBER
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal

# The labels are translated, their order and the signs around them are not.
# Japanese exports have a full-width colon.
_LINE = re.compile("#\\s*[^:\uff1a=]{1,40}[:\uff1a=]\\s*(\\S.*?)\\s*")
_HEADER_LINES = 4


def is_gwyddion(lines: Sequence[str]) -> bool:
    """Recognise such a map by four comment lines, the middle two with lengths."""
    found = [_LINE.fullmatch(text.strip()) for text in lines[:_HEADER_LINES]]
    return len(found) == _HEADER_LINES and all(found)


def parse_gwyddion(lines: Sequence[str], path: Path, origin: Step, name: str) -> Areal:
    """Read a Gwyddion text matrix.

    Args:
        lines: of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the map.

    Returns:
        The heights [m]; pixels are width / columns by height / rows, with a caution
        where they are not square.

    Raises:
        UnitError: width, height or the values have no unit of length.
        FormatError: rows differ in length.
    """
    values = [_LINE.sub(r"\1", text.strip()) for text in lines[:_HEADER_LINES]]
    width = length_of(values[1], "the width in line 2", path)
    height = length_of(values[2], "the height in line 3", path)
    try:
        unit = to_si(values[3], "length")
    except UnitError as error:
        raise UnitError(f"{named(path)}: line 4: {error}") from error
    body = [
        (i + 1, text.split())
        for i, text in enumerate(lines)
        if i >= _HEADER_LINES and text.strip()
    ]
    if not body:
        raise FormatError(f"{named(path)} ends after its header; export it again")
    shape = (len(body), len(body[0][1]))
    heights, valid = masked(rows_of(iter(body), shape, path) * unit, path)
    pixel = (height / shape[0], width / shape[1])
    rounding = sum(_rounding(values[i]) for i in (1, 2))
    return Areal(
        name=name,
        heights=heights,
        spacing=pixel,
        valid=valid,
        provenance=(
            origin,
            step(
                "recognise",
                format="Gwyddion text matrix",
                reason="four comment lines with width, height and unit",
                channel=values[0],
                missing_points=int((~valid).sum()),
            ),
            *_square_or_said(pixel, shape, rounding),
        ),
    )


def _rounding(cell: str) -> float:
    """Return the share of a printed length that its rounding leaves open [-]."""
    match = NUMBER.match(cell)
    value = float(match[0]) if match else 0.0
    return half_digit(match[0]) / value if match and value > 0 else 0.0


def _square_or_said(
    pixel: tuple[float, float], shape: tuple[int, int], rounding: float
) -> tuple[Step, ...]:
    """Return a caution for non-square pixels: some scans, and every truncated file.

    The header has the size of the map and no number of rows: a file that lost rows
    reads as a whole one of longer pixels.
    """
    if abs(pixel[0] / pixel[1] - 1) <= rounding + 0.5 / shape[0]:
        return ()
    wanted = shape[0] * pixel[0] / pixel[1]
    lost = (
        f" If the map was scanned with square pixels the file has lost "
        f"{wanted - shape[0]:.0f} of {wanted:.0f} rows"
        if wanted > shape[0]
        else " If the map was scanned with square pixels it holds rows too many"
    )
    said = (
        f"pixels are {1e6 * pixel[1]:.4g} um along the rows and {1e6 * pixel[0]:.4g} "
        f"um across them.{lost}, and the pitch across the rows is wrong; the pitch "
        "along them holds"
    )
    return (caution(said),)


def _recognise(file: HeightFile) -> bool:
    return is_gwyddion(file.lines)


def _read_format(file: HeightFile) -> Areal:
    return parse_gwyddion(file.lines, file.path, file.origin, file.label)


FORMAT = HeightFormat("gwyddion", _recognise, _read_format)
