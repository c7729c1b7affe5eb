# SPDX-License-Identifier: MIT
"""Stylus profiles that Dektak instruments export as CSV.

A block "Scan Parameters" of keys and values, then "Scan Data", a row with the units,
and x and z a line. The x are rounded to a tenth of a micrometre, so the spacing is the
scanned length over the number of steps.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import FormatError, SamplingError, UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.even_steps import fit_even_steps
from jointbench.acquisition.formats.heights.height_facts import caution, range_caution
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.number_grids import (
    length_of,
    masked,
    parse_cells,
)
from jointbench.acquisition.formats.heights.stated_lengths import stated_length
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument

_PARAMETERS = "Scan Parameters"
_DATA = "Scan Data"
_WORDS = {"micrometer": "um", "nanometer": "nm", "angstrom": "angstrom"}
_ANGSTROM = 1e-10
# A scan may overshoot its length, and its steps may be off what is stated, by this [-].
_SLACK = 2e-3


def is_dektak(lines: Sequence[str]) -> bool:
    """Recognise such an export by its first line."""
    return bool(lines) and lines[0].strip().startswith(_PARAMETERS)


def parse_dektak(lines: Sequence[str], path: Path, origin: Step, name: str) -> Profile:
    """Read a Dektak profile.

    Args:
        lines: of the file.
        path: the file, for messages.
        origin: what is known of the file, put first into the provenance.
        name: of the profile.

    Returns:
        The heights [m], with the stylus radius the file states, and a caution where
        they end before the stated length or at the limit of the range.

    Raises:
        FormatError: there is no block of data, a line of it is none, or length and
            resolution of the header are those of another scan.
        SamplingError: x are not in even steps.
        UnitError: the row of units has none.
    """
    start = next((i for i, text in enumerate(lines) if text.strip() == _DATA), None)
    if start is None:
        raise FormatError(
            f"{named(path)} has {_PARAMETERS!r} and no {_DATA!r}; it is cut short, "
            "export it again"
        )
    header = _header(lines[:start])
    rows = [(i, text) for i, text in enumerate(lines) if i > start and text.strip()]
    units = _units(rows[0][1] if rows else "", path)
    _require_whole_last_line([text for _, text in rows[1:]], path)
    pairs = [_pair(text, i + 1, path) for i, text in rows[1:]]
    if len(pairs) < 2:
        raise FormatError(f"{named(path)} holds {len(pairs)} points; export it again")
    numbers = [i + 1 for i, _ in rows[1:]]
    x = parse_cells([pair[0] for pair in pairs], numbers[0], path, each_own_line=True)
    z = parse_cells([pair[1] for pair in pairs], numbers[0], path, each_own_line=True)
    decimals = [len(pair[0].partition(".")[2]) for pair in pairs]
    try:
        steps = fit_even_steps(
            x,
            what="x",
            unit="in its unit",
            where=lambda i: f"line {numbers[i]}",
            printed=lambda: 10.0 ** -np.array(decimals, dtype=np.float64),
        )
    except SamplingError as error:
        raise SamplingError(f"{named(path)}: {error}") from error
    heights, valid = masked(z * units[1], path)
    radius = header.get("Stylus", "").partition("Radius:")[2].strip()
    low, high = steps.low * units[0], steps.high * units[0]
    short = _require_agreeing(header, len(pairs), (low, high), path)
    profile = Profile(
        name=name,
        heights=heights,
        spacing=steps.step * units[0],
        valid=valid,
        instrument=SurfaceInstrument(
            name="Dektak",
            stylus_radius=length_of(radius, "Stylus", path) if radius else None,
        ),
        provenance=(origin, _describe(header, int((~valid).sum())), *short),
    )
    reached = range_caution(profile, _reach(header))
    return replace(profile, provenance=(*profile.provenance, *reached))


def _require_agreeing(
    header: dict[str, str], points: int, pitch: tuple[float, float], path: Path
) -> tuple[Step, ...]:
    """Check length and resolution of the header against the x of the points.

    Args:
        header: keys and values.
        points: that the file holds.
        pitch: least and largest that the printed x allow [m].
        path: for messages.

    Returns:
        A caution where the points end before the stated length.

    Raises:
        FormatError: the points reach farther, or stand at another pitch than stated.
    """
    resolution = stated_length(header.get("Resolution", "").partition("/")[0])
    if resolution is not None:
        slack = resolution.half_digit + _SLACK * resolution.value
        if not pitch[0] - slack <= resolution.value <= pitch[1] + slack:
            raise FormatError(
                f"{named(path)}: x is in steps of {1e6 * pitch[0]:.5g} um, 'Resolution'"
                f" says {shown(header['Resolution'])}; the header is that of another "
                "scan, or a unit is wrong: export it again"
            )
    length = stated_length(header.get("Length", ""))
    if length is None:
        return ()
    slack = length.half_digit + _SLACK * length.value
    if pitch[0] * (points - 1) > length.value + slack:
        raise FormatError(
            f"{named(path)}: {points} points reach to "
            f"{1e6 * pitch[0] * (points - 1):.5g} um, 'Length' says "
            f"{shown(header['Length'])}; the header is that of another scan, or a unit "
            "is wrong: export it again"
        )
    # Some scans end one step before the length, some at it.
    if pitch[1] * (points + 0.5) >= length.value - length.half_digit:
        return ()
    mean = 0.5 * (pitch[0] + pitch[1])
    said = (
        f"the header states a scan of {1e6 * length.value:g} um, about "
        f"{length.value / mean:.0f} points, and the file holds {points} over "
        f"{1e6 * mean * (points - 1):.5g} um: it is cut short or the scan ended early"
    )
    return (caution(said),)


def _reach(header: dict[str, str]) -> float:
    """Return the largest height to both sides of 0 [m]; infinite if not stated."""
    whole = stated_length(header.get("Measurement Range", ""))
    if whole is None:
        return float("inf")
    # Of hills and valleys the range is shared by both sides.
    return whole.value / (2 if "&" in header.get("Profile", "") else 1)


def _header(lines: Sequence[str]) -> dict[str, str]:
    pairs = (text.partition(",") for text in lines)
    return {key.strip(): value.strip() for key, _, value in pairs if key.strip()}


def _units(line: str, path: Path) -> tuple[float, float]:
    """Read a row like ``Lateral um,Raw Micrometer,``."""
    words = [cell.split()[-1] if cell.split() else "" for cell in line.split(",")[:2]]
    if len(words) < 2:
        raise UnitError(
            f"{named(path)}: {shown(line.strip())} below {_DATA!r} names no two units; "
            "export it again"
        )
    return _factor(words[0], path), _factor(words[1], path)


def _factor(word: str, path: Path) -> float:
    unit = _WORDS.get(word.lower(), word)
    if unit == "angstrom":
        return _ANGSTROM
    try:
        return to_si(unit, "length")
    except UnitError as error:
        raise UnitError(f"{named(path)}: {error}") from error


def _require_whole_last_line(rows: Sequence[str], path: Path) -> None:
    """Refuse a last line without the separators that end all others."""
    ends = [len(text.rstrip()) - len(text.rstrip().rstrip(",")) for text in rows]
    if len(ends) > 1 and ends[-1] < min(ends[:-1]):
        raise FormatError(
            f"{named(path)} ends within its last line, {shown(rows[-1].strip())}; it "
            "is cut short, export it again"
        )


def _pair(line: str, number: int, path: Path) -> tuple[str, str]:
    cells = [cell.strip() for cell in line.strip().rstrip(",").split(",")]
    if len(cells) != 2:
        raise FormatError(
            f"{named(path)}: line {number}: {shown(line.strip())} is no pair of x and "
            "height; the file is cut short or mixed, export it again"
        )
    return cells[0], cells[1]


def _describe(header: dict[str, str], missing: int) -> Step:
    kept = {"resolution": "Resolution", "scan_length": "Length", "scan": "Scan Type"}
    known = {new: header[old] for new, old in kept.items() if old in header}
    return step(
        "recognise",
        format="Dektak CSV",
        reason=f"begins with {_PARAMETERS!r}",
        missing_points=missing,
        **known,
    )


def _recognise(file: HeightFile) -> bool:
    return is_dektak(file.lines)


def _read_format(file: HeightFile) -> Profile:
    return parse_dektak(file.lines, file.path, file.origin, file.label)


FORMAT = HeightFormat("dektak", _recognise, _read_format)
