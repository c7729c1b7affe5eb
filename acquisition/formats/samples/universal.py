# SPDX-License-Identifier: MIT
"""Time histories from universal files (data set 58) by pyuff, headers checked first.

pyuff makes an axis as long as a header says, whatever the file holds. So every header
is looked at before: none may claim more values than its data set has bytes.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data set 58 (function at nodal degree of freedom).
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    SamplingError,
)
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import read_bytes
from jointbench.acquisition.formats.columns import SKIP, only_roles, parse_columns
from jointbench.acquisition.formats.even_steps import roundest
from jointbench.acquisition.formats.samples.repeated_channels import hits_of_channels
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.samples.universal_repairs import (
    unpadded,
    with_latin_units,
)
from jointbench.acquisition.formats.samples.universal_units import unit_of_system
from jointbench.acquisition.formats.stated_channels import (
    QUANTITIES,
    StatedChannel,
    quantity_of_unit,
    recording_of,
)
from jointbench.acquisition.records.recordings import Quantity, Recording

SUFFIXES = (".uff", ".unv")
# As pyuff finds them: binary values need not end with a line.
_EDGE = re.compile(rb"    -1(?=[\r\n]|$| {74})")
_HEADER = 9
"""Lines of a data set up to the one with the number of values."""
_MOST_SETS = 10_000
_MOST_BYTES = 2**28
_BINARY_SET = re.compile(rb"\n {4}58b")
# What pyuff takes for a byte of the file: values of text pass through words.
_BINARY_NEEDED, _TEXT_NEEDED = 5.0, 7.5
_DIGITS = 5e-6
"""Half a unit of the last printed digit of a step, relative, at the most."""
_TIME_RESPONSE = 1
_COUNT = slice(10, 20)
_LONGEST_START, _LONGEST_HEADER = 200, 2000
"""First characters of a file, and of a data set up to its number of values."""
_QUANTITIES = {
    8: Quantity.DISPLACEMENT,
    11: Quantity.VELOCITY,
    12: Quantity.ACCELERATION,
    13: Quantity.FORCE,
}
_DIRECTIONS = {1: "+x", -1: "-x", 2: "+y", -2: "-y", 3: "+z", -3: "-z"}


def read_universal(
    path: Path, *, columns: str | None, point: str
) -> tuple[Recording, ...]:
    """Read the time histories of a universal file, one recording for each hit.

    Histories of the same node and direction that come again are further hits. Where a
    history states no unit, the units of data set 164 count.

    Args:
        path: of the file.
        columns: what the channels of a hit hold, where the file does not say.
        point: where the hammer struck.

    Raises:
        FormatError: it is no universal file, is damaged, or holds no time history.
        HostileFile: a header claims more than the file holds.
        SamplingError: the histories have different rates.
        UnitError: see `recording_of`.
    """
    whole = read_universal_sets(path, kinds=(58, 164))
    sets = [one for one in whole if one.get("func_type") == _TIME_RESPONSE]
    if not sets:
        raise FormatError(
            f"{named(path)} holds no time history (data set 58, function type 1); "
            "FRFs (type 4) are read by `jointbench modal`; `jointbench export` shows "
            "what it has"
        )
    units = next((one for one in whole if "units_code" in one), {})
    entities = [_entity(one) for one in sets]
    channels = [_stated(path, one, units) for one in sets]
    hits = _hits(channels, entities, columns)
    return tuple(
        _recording(
            path,
            [sets[i] for i in hit],
            [
                replace(channels[i], name=name)
                for i, name in zip(hit, _names([entities[i] for i in hit]), strict=True)
            ],
            (columns, point),
            path.stem + (f"-{number}" if len(hits) > 1 else ""),
        )
        for number, hit in enumerate(hits, 1)
    )


def _hits(
    channels: Sequence[StatedChannel], entities: Sequence[str], columns: str | None
) -> list[list[int]]:
    """Return the histories of each hit; `columns` may state what each is."""
    if columns is not None and any(one.quantity is None for one in channels):
        wanted = parse_columns(columns)
        only_roles(wanted, QUANTITIES, "a recording whose file states the time")
        if len(channels) % len(wanted) == 0 and not any(c.label for c in wanted):
            given = [wanted[i % len(wanted)] for i in range(len(channels))]
            channels = [
                replace(one, quantity=None if c.role == SKIP else Quantity(c.role))
                for one, c in zip(channels, given, strict=True)
            ]
    return hits_of_channels(channels, entities)


def _recording(
    path: Path,
    sets: Sequence[dict[str, Any]],
    channels: Sequence[StatedChannel],
    given: tuple[str | None, str],
    name: str,
) -> Recording:
    intervals = {float(one["abscissa_inc"]) for one in sets}
    uneven = any(int(one["abscissa_spacing"]) != 1 for one in sets)
    if uneven or len(intervals) != 1 or not 0.0 < min(intervals) < math.inf:
        raise SamplingError(
            f"{named(path)}: time histories must share one even step above zero, they "
            f"have {', '.join(f'{i:g} s' for i in sorted(intervals)[:5])}"
        )
    return recording_of(
        path,
        channels,
        sample_rate=_rate(intervals.pop()),
        columns=given[0],
        point=given[1],
        layout="universal file, data set 58",
        name=name,
    )


def _rate(interval: float) -> float:
    """Return the roundest rate that the six digits of a header allow [Hz]."""
    low, high = interval * (1.0 - _DIGITS), interval * (1.0 + _DIGITS)
    return roundest(1.0 / high, 1.0 / low)


def _stated(path: Path, one: dict[str, Any], units: dict[str, Any]) -> StatedChannel:
    data = np.asarray(one["data"])
    node = str(one.get("rsp_node") or "")
    kind = _QUANTITIES.get(int(one["ordinate_spec_data_type"]))
    unit = str(one["ordinate_axis_units_lab"]).strip()
    unit = "" if unit.upper() == "NONE" else unit
    return StatedChannel(
        name="",
        unit=unit or unit_of_system(path, kind, units),
        size=data.size,
        read=partial(_real, data),
        point="" if node == "0" else node,
        direction=_DIRECTIONS.get(int(one.get("rsp_dir") or 0), ""),
        quantity=kind or quantity_of_unit(unit),
    )


def _real(data: np.ndarray[Any, Any]) -> FloatArray:
    return np.asarray(data.real, dtype=np.float64)


def _entity(one: dict[str, Any]) -> str:
    entity = str(one.get("rsp_ent_name") or "").strip()
    return "" if entity.upper() == "NONE" else entity


def _names(entities: Sequence[str]) -> list[str]:
    """Return the entity of each set, with its number where that is not its own."""
    return [
        entity
        if entity and entities.count(entity) == 1
        else f"{entity} {number}".strip()
        for number, entity in enumerate(entities, 1)
    ]


def _sane_bytes(path: Path) -> tuple[bytes, list[int]]:
    """Return a file, and where its data sets begin, once its headers are checked."""
    data = read_bytes(path, limit=_MOST_BYTES)
    binary = _BINARY_SET.search(data) is not None
    require_room(path, (_BINARY_NEEDED if binary else _TEXT_NEEDED) * len(data))
    edges = [found.start() for found in _EDGE.finditer(data)]
    if not edges:
        raise FormatError(f"{named(path)} is no universal file: it has no data set")
    if len(edges) % 2:
        raise FormatError(
            f"{named(path)}: data set {len(edges) // 2 + 1} has no end; it is cut "
            "short: use another copy"
        )
    if len(edges) > 2 * _MOST_SETS:
        raise HostileFile(f"{named(path)} has {len(edges) // 2} data sets")
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        _require_sane_set(path, data[begin:end].split(b"\n", _HEADER))
    return data, edges[::2]


def _require_sane_set(path: Path, lines: Sequence[bytes]) -> None:
    """Raise `HostileFile` where a data set 58 claims more than it holds."""
    if len(lines) <= _HEADER or lines[1].split()[:1] not in ([b"58"], [b"58b"]):
        return
    size = sum(len(line) + 1 for line in lines)
    try:
        claimed = int(lines[8][_COUNT])
    except ValueError as error:
        raise FormatError(
            f"{named(path)}: a data set 58 has no number of values"
        ) from error
    if not 0 <= claimed <= size:
        raise HostileFile(
            f"{named(path)}: a header claims {claimed} values, its data set has {size} "
            "bytes; use another copy"
        )


def function_types(path: Path) -> frozenset[int]:
    """Return the function types of the data sets 58 of a file, by their headers.

    Args:
        path: of any file.

    Returns:
        1 is a time history, 4 an FRF, 6 coherence; nothing where the file is no
        universal file, or too large for one.
    """
    try:
        with path.open("rb") as file:
            if _EDGE.match(file.read(_LONGEST_START).lstrip(b"\r\n")) is None:
                return frozenset()
        data = read_bytes(path, limit=_MOST_BYTES)
    except (OSError, BadData):
        return frozenset()
    found = set()
    for edge in _EDGE.finditer(data):
        lines = data[edge.start() : edge.start() + _LONGEST_HEADER].split(b"\n", 8)
        if len(lines) == 9 and lines[1].split()[:1] in ([b"58"], [b"58b"]):
            number = lines[7][:5].strip()
            found |= {int(number)} if number.isdigit() else set()
    return frozenset(found)


def read_universal_sets(path: Path, *, kinds: Sequence[int]) -> list[dict[str, Any]]:
    """Read the data sets of some kinds, as pyuff calls what is in them.

    Args:
        path: of the file.
        kinds: numbers of data sets.

    Raises:
        FormatError: it is no universal file, or is damaged.
        HostileFile: a header claims more than the file holds.
    """
    import pyuff

    data, edges = _sane_bytes(path)
    binary = _BINARY_SET.search(data) is not None
    try:
        with unpadded(path, data, binary=binary) as source:
            file = pyuff.UFF(str(source))
            found = [
                (number, dict(file.read_sets(number)))
                for number, kind in enumerate(map(int, file.get_set_types()))
                if kind in kinds
            ]
    except Exception as error:  # it raises whatever the content makes it raise
        raise FormatError(
            f"{named(path)} cannot be read as a universal file ({shown(error)}); use "
            "another copy"
        ) from error
    heads = [data[edge : edge + _LONGEST_HEADER] for edge in edges]
    return [
        with_latin_units(one, heads[number]) if number < len(heads) else one
        for number, one in found
    ]


def _read_format(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    return read_universal(path, columns=options.columns, point=options.point)


FORMAT = SampleFormat("universal", SUFFIXES, _read_format)
