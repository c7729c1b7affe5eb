# SPDX-License-Identifier: MIT
"""Stylus profiles that Surfcom instruments export: TX1 (primary), TX2 (roughness).

Line 1 is the traced length [mm], line 2 the number of points, then one height [um] a
line. The units are part of the format.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.errors import FormatError, UnitError
from jointbench.acquisition.records import Step, step
from jointbench.acquisition.surfaces import Profile, SurfaceInstrument
from jointbench.acquisition.tables import NUMBER, parse_cell
from jointbench.acquisition.text_files import named, shown
from jointbench.acquisition.units import parse_value

SUFFIXES = {".tx1": "primary profile", ".tx2": "roughness profile (filtered)"}
_MILLIMETRE = 1e-3
_MICROMETRE = 1e-6
_HEADER_LINES = 2
_MOST_SETTINGS = 2**16
_CUTOFF_WORDS = ("onda de corte", "cutoff", "cut-off", "cut off", "grenzwellen")


def is_surfcom(lines: Sequence[str], path: Path) -> bool:
    """Tell by the ending, or by a count that fits, whether a file is such a profile."""
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
        path: the file, for messages; its ending tells what was exported.
        origin: what is known of the file, put first into the provenance.
        name: of the profile.

    Returns:
        The heights [m] at a spacing of length / (points - 1) [m].

    Raises:
        FormatError: the header is none, or the number of heights is not the declared.
    """
    length, count = _header(lines, path)
    cells = _cells(lines)
    if len(cells) != count:
        raise FormatError(
            f"{named(path)} declares {count} points and holds {len(cells)}; the file "
            "is cut short or mixed, export it again"
        )
    heights = np.array(
        [parse_cell(cell, i + 1 + _HEADER_LINES, path) for i, cell in enumerate(cells)]
    )
    missing = np.isnan(heights)
    if np.any(np.isinf(heights)):
        raise FormatError(f"{named(path)} holds an infinite height")
    what = SUFFIXES.get(path.suffix.lower(), "profile")
    cutoffs, settings = _settings(path)
    return Profile(
        name=name,
        heights=np.where(missing, 0.0, heights) * _MICROMETRE,
        spacing=length * _MILLIMETRE / (count - 1),
        valid=~missing,
        instrument=SurfaceInstrument(
            name=f"Surfcom, {what}",
            cutoff_short=cutoffs.get("short"),
            cutoff_long=cutoffs.get("long"),
        ),
        provenance=(
            origin,
            step(
                "recognise",
                format="Surfcom text",
                reason="traced length [mm], number of points, one height [um] a line",
                exported=what,
                length_mm=length,
                points=count,
                missing_points=int(missing.sum()),
                settings=settings,
            ),
        ),
    )


def _settings(path: Path) -> tuple[dict[str, float], str]:
    """Read the filter cut-offs [m] from the TX3 file beside a profile, if there is one.

    Its keys are in the language of the instrument; that of lambda_s holds "Ls".
    """
    beside = [path.with_suffix(ending) for ending in (".tx3", ".TX3")]
    found = next((file for file in beside if file.is_file() and file != path), None)
    if found is None:
        return {}, "no TX3 beside it"
    lines = found.read_bytes()[:_MOST_SETTINGS].decode("latin-1").splitlines()
    pairs = [line.partition("\t")[::2] for line in lines]
    cutoffs: dict[str, float] = {}
    for key, cell in pairs:
        words = key.casefold()
        if " ls" not in words and not any(word in words for word in _CUTOFF_WORDS):
            continue
        try:
            value = parse_value(cell, "length")
        except UnitError:
            continue
        if 0 < value < 1:
            cutoffs.setdefault("short" if " ls" in words else "long", value)
    return cutoffs, found.name


def _header(lines: Sequence[str], path: Path) -> tuple[float, int]:
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
    return float(head[0]), int(head[1])


def _cells(lines: Sequence[str]) -> list[str]:
    """Return the heights as text, without empty lines at the end."""
    end = len(lines)
    while end > _HEADER_LINES and not lines[end - 1].strip(" \t\x1a\f"):
        end -= 1
    return [line.strip() for line in lines[_HEADER_LINES:end]]
