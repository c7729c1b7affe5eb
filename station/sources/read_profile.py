# SPDX-License-Identifier: MIT
"""Read a roughness tester, and put what it measured where it belongs."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.formats.heights.height_facts import cautions, checked
from jointbench.acquisition.records.surfaces import Profile
from jointbench.acquisition.serial_lines import instruments
from jointbench.acquisition.serial_lines.line import SerialLine
from jointbench.acquisition.serial_lines.line_faults import ProfileBroken
from jointbench.acquisition.serial_lines.serial_instrument import ProfileOptions
from jointbench.acquisition.session_file.add_surface import add_surface, require_addable
from jointbench.acquisition.session_file.overwrite_guard import fresh_path
from jointbench.station.files.output_paths import (
    check_outputs,
    require_mark,
    write_text,
)
from jointbench.station.pipeline.roughness_words import caution_lines
from jointbench.station.screen.terminal import console, table, write_json
from jointbench.station.screen.value_text import engineering
from jointbench.station.sources.serial_port import line_name

TABLE_HEAD = "x [um],z [um]"
"""How the table of a profile begins."""


@dataclass(frozen=True, slots=True)
class ProfileRequest:
    """What is asked of which instrument.

    Attributes:
        instrument: name of a roughness tester, ``"diavite"``, ``"mitutoyo"`` or one
            that a package adds.
        line: name of its serial line, or of a simulator.
        name: of the profile.
        traverse: length that was traced, with its unit, as text; a DH-8 needs it.
        baud: bits per second, None for what is usual.
        filtered: the roughness profile of a DH-8.
        signed: whether heights of a DH-8 have a sign.
    """

    instrument: str
    line: str
    name: str
    traverse: str | None = None
    baud: int | None = None
    filtered: bool = False
    signed: bool = True


def run_profile(
    wanted: ProfileRequest,
    *,
    out: Path | None,
    session: Path | None,
    overwrite: bool,
    json_target: str | None,
) -> Profile:
    """Fetch a profile into a table, a session, or both.

    Args:
        wanted: what to ask of which instrument.
        out: table to write, ``*.csv``.
        session: file that the profile is added to.
        overwrite: replace a table that is there.
        json_target: where the JSON goes.

    Raises:
        UsageError: there is nowhere to put it, or something is there already.
        InstrumentError: the line breaks; what had come by then is in a table beside
            the one asked for, ``*.broken.csv``.
    """
    instruments.roughness_tester(wanted.instrument)
    _check_places(wanted, out, session, overwrite=overwrite, json_target=json_target)
    try:
        with line_name(wanted.line) as line:
            profile = read_profile(wanted, line)
    except ProfileBroken as error:
        place = out or (session or Path("profile")).with_suffix(".csv")
        saved = fresh_path(place, "broken")
        write_text(saved, _table(error.heights, error.spacing))
        raise InstrumentError(
            f"{error}; {error.heights.size} heights are in '{saved}'"
        ) from error
    if out is not None:
        write_text(out, _table(profile.heights, profile.spacing))
    if session is not None:
        add_surface(session, profile)
    _show(profile, out, session, json_target)
    return profile


def read_profile(wanted: ProfileRequest, line: str) -> Profile:
    """Read a profile from a line by its name.

    Raises:
        UsageError: there is no such instrument, or it needs the length of its
            traverse and none is given.
        InstrumentError: the line cannot be opened, or breaks.
        FormatError: the answer is not what the instrument's notes say.
    """
    tester = instruments.roughness_tester(wanted.instrument)
    options = ProfileOptions(
        name=wanted.name,
        traverse=_traverse(wanted),
        filtered=wanted.filtered,
        signed=wanted.signed,
    )
    port = SerialLine(line, baud=wanted.baud or tester.value.baud)
    try:
        return _checked(instruments.read_profile(tester, port, options), line)
    finally:
        port.close()


def _checked(profile: Profile, line: str) -> Profile:
    """Refuse a length that no tester traces, and note what looks wrong."""
    found = checked(profile, line)
    return replace(profile, provenance=found.provenance)


def _traverse(wanted: ProfileRequest) -> float | None:
    """Return the length that was traced [m], None where the instrument says it."""
    tester = instruments.roughness_tester(wanted.instrument).value
    if wanted.traverse is None:
        if tester.needs_traverse:
            raise UsageError(
                f"a {tester.title} does not report its traverse length; add "
                "--traverse '4.8 mm'"
            )
        return None
    length = parse_value(wanted.traverse, "length")
    if not length > 0:
        raise UsageError(f"traverse is {wanted.traverse!r}; give a length above zero")
    return length


def _check_places(
    wanted: ProfileRequest,
    out: Path | None,
    session: Path | None,
    *,
    overwrite: bool,
    json_target: str | None,
) -> None:
    if out is None and session is None:
        raise UsageError("no output for the profile; add --out trace.csv or --session")
    _traverse(wanted)
    if out is not None:
        if out.suffix.lower() != ".csv":
            raise UsageError(f"'{out}' is no table; name it *.csv")
        if out.is_file() and not overwrite:
            raise UsageError(f"'{out}' is there already; add --force to overwrite it")
        require_mark(out, TABLE_HEAD.encode(), "profile")
    check_outputs([], [json_target, None if out is None or out.is_file() else out])
    if session is not None:
        require_addable(session, wanted.name)


def _table(heights: FloatArray, spacing: float | None) -> str:
    """Return heights as text; without x where the spacing is not known."""
    if spacing is None:
        rows = [f"{1e6 * z:.6f}" for z in heights]
        return "\n".join(["z [um]", *rows, ""])
    along = 1e6 * spacing * np.arange(heights.size)
    rows = [f"{x:.6f},{1e6 * z:.6f}" for x, z in zip(along, heights, strict=True)]
    return "\n".join([TABLE_HEAD, *rows, ""])


def _show(
    profile: Profile, out: Path | None, session: Path | None, json_target: str | None
) -> None:
    deviation = float(np.abs(profile.heights - profile.heights.mean()).mean())
    rows = [
        ("instrument", profile.instrument.name),
        ("points", f"{profile.heights.size}"),
        ("length", engineering(profile.length, "m")),
        ("mean deviation (unfiltered)", engineering(deviation, "m")),
    ]
    screen = console(json_target)
    screen.print(table(profile.name, ("profile", ""), rows))
    said = cautions(profile.provenance)
    for text in caution_lines(profile.name, said):
        screen.print(f"  {text}", markup=False)
    places = [str(place) for place in (out, session) if place is not None]
    screen.print(f"in {' and '.join(places)}", soft_wrap=True)
    screen.print(f"\nnext: jointbench surface {places[0]}", soft_wrap=True)
    write_json(
        json_target,
        {
            "profile": profile.name,
            "points": profile.heights.size,
            "spacing_m": profile.spacing,
            "mean_deviation_m": deviation,
            "cautions": list(said),
            "files": places,
        },
    )
