# SPDX-License-Identifier: MIT
"""FRFs from universal files: data set 58 of function type 4, coherence of type 6.

A universal file prints the distance of its lines with six digits. A file that
`jointbench export` wrote also has the exact distance, the number of averages, the
exponential window, the excited band and the variance of each line, so that its FRFs
come back as they were.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data set 58 (function at nodal degree of freedom).
"""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError, UnitError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.frfs.checked_frf import (
    RawFrf,
    checked_frf,
    origin,
    require_count,
    unit_of,
)
from jointbench.acquisition.formats.frfs.degrees_of_freedom import degree_of_freedom
from jointbench.acquisition.formats.frfs.frf_columns import FrfColumn, stated_unit
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.frfs.frf_units import is_frf_unit
from jointbench.acquisition.formats.samples.universal import (
    function_types,
    read_universal_sets,
)
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.provenance import Provenance

TIME_RESPONSE, FRF, COHERENCE, GENERAL = 1, 4, 6, 0
_EVEN = 1
_FREQUENCY = 18
_OWN = "jointbench"
_NOISE = re.compile(r"(?P<name>variance|innovation_noise) of ")
_DETAIL = re.compile(r"(\w+)=(\S+)")
_DIGITS = 1e-5
"""Share of itself by which a printed number of six digits may differ, and more."""
Set = Mapping[str, Any]


def recognise_universal_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a file holds FRFs in data sets 58, and no time history."""
    types = function_types(path)
    return FRF in types and TIME_RESPONSE not in types


def read_universal_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read all FRFs of a universal file.

    Args:
        path: of the file.
        options: `columns` states the unit where the file does not: ``"frf:g/N"``.

    Raises:
        FormatError: it is damaged.
        HostileFile: a header claims more than the file holds.
        UnitError: a unit is missing or unknown; the message has what to type.
        BadData: see `checked_frf`.
    """
    given = stated_unit(options.columns, "frf:m/s^2/N")
    sets = read_universal_sets(path, kinds=(58,))
    found = [(n, one) for n, one in enumerate(sets, 1) if _type(one) == FRF]
    require_count(path, len(found), sum(np.size(one["data"]) for _, one in found))
    done = origin(path, "universal file, data set 58", options.columns)
    try:
        noise = _noise_sets(sets)
        return tuple(
            _function(path, where, one, noise, (given, options.averages, done))
            for where, one in found
        )
    except (ArithmeticError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, BadData):
            raise
        raise FormatError(
            f"{named(path)}: a data set is damaged ({shown(error)}); use another copy"
        ) from error


def _type(one: Set) -> int:
    return int(one.get("func_type", -1))


def _function(
    path: Path,
    number: int,
    one: Set,
    noise: Mapping[tuple[object, ...], Mapping[str, FloatArray]],
    stated: tuple[FrfColumn | None, int, Provenance],
) -> FrfFunction:
    """Return one FRF; `stated` is its unit and averages by the user, and its origin."""
    given, averages, done = stated
    output, point = _labels(one)
    where = f"FRF {number}" + (f" ({shown(f'{output} / {point}')})" if output else "")
    detail, values = _details(one), np.asarray(one["data"])
    if values.size != int(one["num_pts"]):
        raise FormatError(
            f"{named(path)}: {where} claims {int(one['num_pts'])} values and holds "
            f"{values.size}; it is cut short: use another copy"
        )
    raw = RawFrf(
        where,
        _frequencies(path, where, one, detail),
        values,
        output,
        point,
        dict(noise.get(_place(one), {})),
    )
    band = detail.get("from"), detail.get("to")
    return checked_frf(
        path,
        raw,
        unit_of(path, where, _unit(one), given),
        averages=int(detail.get("averages", averages)),
        decay_rate=detail.get("decay", 0.0),
        usable_band=None if band[0] is None or band[1] is None else (band[0], band[1]),
        provenance=done,
    )


def _noise_sets(
    sets: Sequence[Set],
) -> dict[tuple[object, ...], dict[str, FloatArray]]:
    """Return coherence and variances by the place of the FRF that they belong to."""
    found: dict[tuple[object, ...], dict[str, FloatArray]] = {}
    for one in sets:
        match = _NOISE.match(_text(one, "id1")) if _is_own(one) else None
        name = match["name"] if match and _type(one) == GENERAL else ""
        name = "coherence" if _type(one) == COHERENCE else name
        if name:
            values = np.asarray(one["data"]).real.astype(np.float64)
            found.setdefault(_place(one), {})[name] = values
    return found


def _place(one: Set) -> tuple[object, ...]:
    """Return response and reference of a set: entity, node and direction of each."""
    return tuple(
        str(one.get(f"{side}_{part}") or "").strip()
        for side in ("rsp", "ref")
        for part in ("ent_name", "node", "dir")
    )


def _labels(one: Set) -> tuple[str, str]:
    """Return the labels of output and input."""
    if _is_own(one):
        _, _, pair = _text(one, "id1").partition(" ")
        output, slash, point = pair.partition(" / ")
        if slash:
            return output.strip(), point.strip()
    name, *_ = _place(one)
    output, point = _degree(one, "rsp"), _degree(one, "ref")
    channel = "" if str(name).upper() in ("", "NONE") else str(name)
    if not output:
        return channel, point
    return (f"{channel}@{output}" if channel else output), point


def _degree(one: Set, side: str) -> str:
    """Return node and direction as one label; empty without a node."""
    node, way = (int(one.get(f"{side}_{part}") or 0) for part in ("node", "dir"))
    return degree_of_freedom(node, way)


def _unit(one: Set) -> str:
    above = _text(one, "ordinate_axis_units_lab")
    below = _text(one, "orddenom_axis_units_lab")
    if below and above and not is_frf_unit(above):
        return f"({above})/({below})"
    return above


def _frequencies(
    path: Path, where: str, one: Set, detail: Mapping[str, float]
) -> FloatArray:
    """Return the lines [Hz]; the exact distance where jointbench wrote the file.

    Raises:
        UnitError: the abscissa is no frequency.
    """
    unit = _text(one, "abscissa_axis_units_lab").lower()
    kind = int(one.get("abscissa_spec_data_type") or 0)
    factor = {"hz": 1.0, "rad/s": 1.0 / (2.0 * math.pi), "": 1.0}.get(unit)
    if factor is None or (not unit and kind != _FREQUENCY):
        raise UnitError(
            f"{named(path)}: {where}: its abscissa is in {shown(unit)}, an FRF is over "
            "frequency in Hz; export it over Hz"
        )
    axis: FloatArray = np.asarray(one["x"], np.float64)
    if int(one.get("abscissa_spacing") or 0) == _EVEN and "step" in detail:
        exact = detail.get("begin", 0.0) + detail["step"] * np.arange(axis.size)
        if np.allclose(axis, exact, rtol=_DIGITS, atol=0.0):
            axis = np.asarray(exact, np.float64)
    return axis * factor


def _details(one: Set) -> dict[str, float]:
    """Return the exact numbers that jointbench writes into the identification lines."""
    if not _is_own(one):
        return {}
    text = " ".join(_text(one, f"id{i}") for i in (3, 4, 5))
    found = {name: float(value) for name, value in _DETAIL.findall(text)}
    return {name: value for name, value in found.items() if math.isfinite(value)}


def _is_own(one: Set) -> bool:
    return _text(one, "id2") == _OWN


def _text(one: Set, name: str) -> str:
    text = str(one.get(name) or "").strip()
    return "" if text.upper() == "NONE" else text


FORMAT = FrfFormat("universal_frfs", recognise_universal_frfs, read_universal_frfs)
