# SPDX-License-Identifier: MIT
"""Height maps that Gwyddion writes as a text matrix with a header of four lines."""

import re
from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.errors import FormatError, UnitError
from jointbench.acquisition.grids import length_of, masked, rows_of
from jointbench.acquisition.records import Step, step
from jointbench.acquisition.surfaces import Areal
from jointbench.acquisition.text_files import named
from jointbench.acquisition.units import to_si

# The labels are translated, their order and the signs around them are not.
# Japanese exports have a full-width colon.
_LINE = re.compile("#\\s*[^:\uff1a=]{1,40}[:\uff1a=]\\s*(\\S.*?)\\s*")
_HEADER_LINES = 4


def is_gwyddion(lines: Sequence[str]) -> bool:
    """Tell by four comment lines, the middle two lengths, whether it is such a map."""
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
        The heights [m]; pixels are width / columns by height / rows.

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
    return Areal(
        name=name,
        heights=heights,
        spacing=(height / shape[0], width / shape[1]),
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
        ),
    )
