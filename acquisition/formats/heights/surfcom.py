# SPDX-License-Identifier: MIT
"""Stylus profiles that Surfcom instruments export: TX1 (primary), TX2 (roughness).

Line 1 is the nominal length [mm], line 2 the number of points, then one height [um] a
line. The units are part of the format. The length that was traced stands in the TX3
file beside it.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.heights.height_facts import caution, range_caution
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.stated_lengths import (
    StatedLength,
    half_digit,
)
from jointbench.acquisition.formats.heights.surfcom_settings import (
    SurfcomSettings,
    read_settings,
)
from jointbench.acquisition.formats.table_cells import NUMBER, parse_cell
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument

SUFFIXES = {".tx1": "primary profile", ".tx2": "roughness profile (filtered)"}
_MILLIMETRE = 1e-3
_MICROMETRE = 1e-6
_HEADER_LINES = 2


def is_surfcom(lines: Sequence[str], path: Path) -> bool:
    """Recognise such a profile by its suffix, or by a matching count."""
    if path.suffix.lower() in SUFFIXES:
        return True
    head = [line.strip() for line in lines[:_HEADER_LINES]]
    if len(head) < _HEADER_LINES or not NUMBER.fullmatch(head[0]):
        return False
    return head[1].isdecimal() and int(head[1]) == len(_cells(lines)) > 1


def parse_surfcom(lines: Sequence[str], path: Path, origin: Step, name: str) -> Profile:
    """Read a Surfcom profile.

    Args:
        lines: of the file.
        path: the file, for messages; its suffix gives the kind of profile.
        origin: what is known of the file, put first into the provenance.
        name: of the profile.

    Returns:
        The heights [m] at a spacing of length / (points - 1) [m]; of the nominal
        length, or of the evaluated one where the TX3 file shows that the trace ended
        early. A caution reports this, and heights at the limit of the range.

    Raises:
        FormatError: the header is none, the number of heights is not the declared, or
            the TX3 file is that of another trace.
    """
    cell, count = _header(lines, path)
    cells = _cells(lines)
    if len(cells) != count:
        raise FormatError(
            f"{named(path)} declares {count} points and holds {len(cells)}; the file "
            "is cut short or mixed, export it again"
        )
    heights = np.array(
        [parse_cell(text, i + 1 + _HEADER_LINES, path) for i, text in enumerate(cells)]
    )
    _require_whole_last_height(cells, path)
    missing = np.isnan(heights)
    if np.any(np.isinf(heights)):
        raise FormatError(f"{named(path)} holds an infinite height")
    settings = read_settings(path)
    spacing, said = _spacing(cell, count, settings, path)
    known = settings or SurfcomSettings()
    what = SUFFIXES.get(path.suffix.lower(), "profile")
    recognised = step(
        "recognise",
        format="Surfcom text",
        reason="nominal length [mm], number of points, one height [um] a line",
        exported=what,
        length_mm=float(cell),
        points=count,
        missing_points=int(missing.sum()),
        settings=known.source,
    )
    profile = Profile(
        name=name,
        heights=np.where(missing, 0.0, heights) * _MICROMETRE,
        spacing=spacing,
        valid=~missing,
        instrument=SurfaceInstrument(
            name=f"Surfcom, {what}",
            cutoff_short=known.cutoff_short,
            cutoff_long=known.cutoff_long,
        ),
        provenance=(origin, recognised, *said),
    )
    # A roughness profile has lost the waves that reach the limit.
    if known.reach is None or path.suffix.lower() == ".tx2":
        return profile
    reached = range_caution(profile, known.reach)
    return replace(profile, provenance=(*profile.provenance, *reached))


def _require_whole_last_height(cells: Sequence[str], path: Path) -> None:
    """Refuse a last height with fewer decimals than any other: it is cut off."""
    decimals = [len(cell.partition(".")[2]) for cell in cells]
    if len(decimals) > 1 and decimals[-1] < min(decimals[:-1]):
        raise FormatError(
            f"{named(path)} ends within its last height, {shown(cells[-1])}; it is cut "
            "short, export it again"
        )


def _spacing(
    cell: str, count: int, settings: SurfcomSettings | None, path: Path
) -> tuple[float, tuple[Step, ...]]:
    """Return the distance of the heights [m], and what to keep in mind about it.

    Line 1 is the length that was to be traced. A trace that ended early has fewer
    heights over the length that the TX3 file calls evaluated.
    """
    unit = _MILLIMETRE
    nominal = StatedLength(float(cell) * unit, half_digit(cell) * unit)
    evaluated = None if settings is None else settings.evaluated
    if settings is None or evaluated is None:
        lacks = "no TX3 file with an evaluation length stands beside it"
        said = (
            f"{lacks}: the pitch rests on line 1, the nominal length of {cell} mm, and "
            "is too large if the trace ended early"
        )
        return nominal.value / (count - 1), (caution(said),)
    if nominal.agrees(evaluated):
        return nominal.value / (count - 1), ()
    _require_of_this_trace(cell, nominal, evaluated, settings, path)
    doubt = 100 * evaluated.half_digit / evaluated.value
    said = (
        f"the trace ended early: {count} heights over the {1e3 * evaluated.value:g} mm "
        f"that {settings.source} states as evaluated, of {cell} mm nominal; the pitch "
        f"rests on the evaluated length, which is printed to {doubt:.1g} %"
    )
    return evaluated.value / (count - 1), (caution(said),)


def _require_of_this_trace(
    cell: str,
    nominal: StatedLength,
    evaluated: StatedLength,
    settings: SurfcomSettings,
    path: Path,
) -> None:
    """Refuse settings beside a trace that cannot be its own."""
    measured = settings.measured
    other = measured is not None and not nominal.agrees(measured)
    if not other and evaluated.value < nominal.value:
        return
    more = f" and {1e3 * measured.value:g} mm measured" if measured else ""
    raise FormatError(
        f"{named(path)}: line 1 states {cell} mm, {settings.source} beside it "
        f"{1e3 * evaluated.value:g} mm evaluated{more}; these are the settings of "
        "another trace: put the right TX3 beside it, or take this one away"
    )


def _header(lines: Sequence[str], path: Path) -> tuple[str, int]:
    """Return length [mm] as printed, and number of points."""
    head = [line.strip() for line in lines[:_HEADER_LINES]] + ["", ""]
    if not NUMBER.fullmatch(head[0]) or not 0 < float(head[0]) < float("inf"):
        raise FormatError(
            f"{named(path)}: line 1 is {shown(head[0])}, a Surfcom profile begins with "
            "its length in mm"
        )
    if not head[1].isdecimal() or len(head[1]) > 9 or int(head[1]) < 2:
        raise FormatError(
            f"{named(path)}: line 2 is {shown(head[1])}, a Surfcom profile has its "
            "number of points there"
        )
    return head[0], int(head[1])


def _cells(lines: Sequence[str]) -> list[str]:
    """Return the heights as text, without empty lines at the end."""
    end = len(lines)
    while end > _HEADER_LINES and not lines[end - 1].strip(" \t\x1a\f"):
        end -= 1
    return [line.strip() for line in lines[_HEADER_LINES:end]]


def _recognise(file: HeightFile) -> bool:
    return is_surfcom(file.lines, file.path)


def _read_format(file: HeightFile) -> Profile:
    return parse_surfcom(file.lines, file.path, file.origin, file.label)


FORMAT = HeightFormat("surfcom", _recognise, _read_format)
