# SPDX-License-Identifier: MIT
"""Recordings from named arrays, whatever file they come from: times and channels.

An array is a row of samples, or a table of samples and hits: each hit becomes a
recording. Where the force is one row and other arrays are tables, the tables hold
several sensors of that one hit. Without an array of times the user gives the rate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.column_roles import (
    QUANTITY_NAMES,
    RATE_EXAMPLE,
)
from jointbench.acquisition.formats.columns import (
    SKIP,
    Column,
    only_roles,
    parse_columns,
)
from jointbench.acquisition.formats.even_steps import fit_even_steps, roundest
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.stated_channels import (
    StatedChannel,
    recording_of_columns,
)
from jointbench.acquisition.records.recordings import Recording

Arrays = Mapping[str, NDArray[Any]]
ARRAYS_EXAMPLE = "time.t:s,force.F:N,acceleration.a1:m/s^2"
_TIME = "time"
_RATE_AGREES = 1e-3
"""Relative difference of a stated and a measured rate that is rounding."""
_TABLE = 2
_LEAST_COLUMNS = 2  # an excitation and a response, or an excitation and its times


@dataclass(frozen=True, slots=True, eq=False)
class _SampleRows:
    """The samples of one column of ``--columns``: one row for each hit or sensor."""

    column: Column
    values: FloatArray


def recordings_of_arrays(
    path: Path, arrays: Arrays, options: SampleOptions, layout: str
) -> tuple[Recording, ...]:
    """Return the recordings of named arrays, one for each hit.

    Args:
        path: of the file.
        arrays: by their names.
        options: `columns` names the arrays by label; without one, an array is called
            like its role. `rate` stands in for an array of times.
        layout: name of the format, for the provenance.

    Raises:
        UnitError: `columns` is missing; the message lists the arrays.
        UsageError: it names no time and no rate is given, or an array by no label.
        FormatError: an array is missing, or holds no rows of numbers.
        SamplingError: shapes or times do not fit each other.
    """
    for name, array in arrays.items():
        if "ordinate" in (array.dtype.names or ()):
            raise FormatError(
                f"{named(path)}: {shown(name)} holds records of SDynPy, without units; "
                "save the arrays, numpy.savez(name, t=d.abscissa[0], y=d.ordinate), or "
                "write a universal file"
            )
    if options.columns is None:
        raise UnitError(what_arrays_hold(path, arrays))
    wanted = [c for c in parse_columns(options.columns) if c.role != SKIP]
    only_roles(wanted, (_TIME, *QUANTITY_NAMES), "a recording of hits")
    times = [column for column in wanted if column.role == _TIME]
    channels = [column for column in wanted if column.role != _TIME]
    if channels and not times and options.rate is None:
        raise UsageError(
            f"--columns names no times of {named(path)}; give the rate, for example "
            "--rate '10 kHz', or a column of times, 'time.t:s'"
        )
    if not channels:
        raise UsageError(
            f"--columns {options.columns!r} must name one time and some channels of "
            f"{named(path)}, for example '{ARRAYS_EXAMPLE}'"
        )
    stamps = None if not times else _array(path, arrays, times[0])
    length = None if stamps is None else max(stamps.shape)
    rows = [_rows(path, _array(path, arrays, c), c, length) for c in channels]
    groups = _hits(path, rows)
    rates = _rates(path, times[:1], stamps, len(groups), options)
    several = len(groups) > 1
    return tuple(
        _recording(path, group, rate, options, (layout, f"-{k}" if several else ""))
        for k, (group, rate) in enumerate(zip(groups, rates, strict=True), 1)
    )


def what_arrays_hold(path: Path, arrays: Arrays) -> str:
    """Return the message for a file of arrays without units: what to type."""
    held = [f"{shown(n)} {a.shape}" for n, a in list(arrays.items())[:12]]
    names = [n for n, a in arrays.items() if a.size > 1 and a.dtype.kind in "fiu"]
    names.sort(key=lambda name: (not _ascends(arrays[name]), name[:1].lower() != "f"))
    timed = any(_ascends(arrays[name]) for name in names[:1])
    roles = (*[_TIME] * timed, "force", *["acceleration"] * 4)
    units = {_TIME: "s", "force": "N", "acceleration": "m/s^2"}
    pairs = list(zip(roles, names, strict=False))
    example = ",".join(f"{role}.{name}:{units[role]}" for role, name in pairs)
    if len(pairs) < _LEAST_COLUMNS:
        example, timed = ARRAYS_EXAMPLE, True
    rate = "" if timed else " --rate '10 kHz'"
    return (
        f"{named(path)} holds the variables {', '.join(held) or 'none'} and no units; "
        f"describe them, for example --columns '{example}'{rate}"
    )


def _ascends(array: NDArray[Any]) -> bool:
    """Return whether an array is one row of ascending numbers, as times are."""
    row = np.squeeze(array)
    return row.ndim == 1 and bool(np.all(np.diff(row) > 0))


def _array(path: Path, arrays: Arrays, column: Column) -> NDArray[Any]:
    """Return an array of numbers as a table, a row as one of a single row."""
    name = column.label or column.role
    if name not in arrays:
        held = ", ".join(shown(other) for other in list(arrays)[:12]) or "none"
        if not column.label:
            raise UsageError(
                f"--columns: {column.role!r} names no variable; write it after the "
                f"role, for example {column.role}.F:{column.unit}; {named(path)} holds "
                f"{held}"
            )
        raise FormatError(
            f"{named(path)} holds no variable {shown(name)}; it holds {held}"
        )
    array = arrays[name]
    whole = np.squeeze(array)
    if array.dtype.kind not in "fiu" or whole.ndim > _TABLE or not array.size:
        raise FormatError(
            f"{named(path)}: variable {shown(name)} has the type {array.dtype} and the "
            f"shape {array.shape}; rows of real numbers are read, or tables of samples "
            "and hits"
        )
    return np.atleast_2d(whole)


def _rows(
    path: Path, table: NDArray[Any], column: Column, length: int | None
) -> _SampleRows:
    """Return a table with the samples along its rows."""
    first, second = table.shape
    name = shown(column.label or column.role)
    if length is not None and length not in (first, second):
        raise SamplingError(
            f"{named(path)}: variable {name} has {max(first, second)} samples, the "
            f"time {length}; save them at the same moments"
        )
    if first == second and first > 1:
        raise FormatError(
            f"{named(path)}: variable {name} has the shape {table.shape}, which may be "
            "read either way; save each hit as a separate variable"
        )
    along_rows = second > first if length is None else second == length
    return _SampleRows(column, np.asarray(table if along_rows else table.T, np.float64))


def _hits(path: Path, rows: Sequence[_SampleRows]) -> list[list[_SampleRows]]:
    """Return the rows of each hit."""
    counts = [one.values.shape[0] for one in rows]
    if len(set(counts)) == 1:
        return [
            [replace(one, values=one.values[k : k + 1]) for one in rows]
            for k in range(counts[0])
        ]
    forces = [n for n, one in zip(counts, rows, strict=True) if _is_force(one)]
    if set(forces) == {1}:
        return [list(rows)]
    found = ", ".join(
        f"{shown(one.column.label or one.column.role)} {one.values.shape[0]}"
        for one in rows
    )
    raise SamplingError(
        f"{named(path)}: the tables have different numbers of rows ({found}); give the "
        "same number of hits of every channel, or one row of force and several sensors"
    )


def _is_force(one: _SampleRows) -> bool:
    return one.column.role == "force"


def _rates(
    path: Path,
    times: Sequence[Column],
    stamps: NDArray[Any] | None,
    hits: int,
    options: SampleOptions,
) -> list[float]:
    """Return the sample rate of each hit [Hz]."""
    if stamps is None:
        assert options.rate is not None  # checked before
        return [options.rate] * hits
    table = stamps if stamps.shape[1] >= stamps.shape[0] else stamps.T
    if table.shape[0] not in (1, hits):
        raise SamplingError(
            f"{named(path)}: {table.shape[0]} rows of time for {hits} hits; give one "
            "time for all, or one for each"
        )
    column = times[0]
    rates = [_rate(path, row, column) for row in np.asarray(table, np.float64)]
    for rate in rates:
        require_rate(path, rate, options.rate)
    return rates * (hits if len(rates) == 1 else 1)


def _rate(path: Path, stamps: FloatArray, column: Column) -> float:
    try:
        steps = fit_even_steps(
            stamps, what=_TIME, unit=column.unit, where=lambda i: f"sample {i + 1}"
        )
    except SamplingError as error:
        raise SamplingError(
            f"{named(path)}: {error}; if {shown(column.label or _TIME)} is no time, "
            f"leave it out and give the rate: {RATE_EXAMPLE}"
        ) from error
    second = column.factor
    return roundest(1 / (steps.high * second), 1 / (steps.low * second))


def require_rate(path: Path, rate: float, stated: float | None) -> None:
    """Raise where the user states another rate than the file.

    Args:
        path: of the file.
        rate: by the file [Hz].
        stated: by the user [Hz], or None.

    Raises:
        SamplingError: they differ.
    """
    if stated is not None and abs(stated - rate) > _RATE_AGREES * rate:
        raise SamplingError(
            f"{named(path)} is sampled at {rate:g} Hz by its own times, --rate says "
            f"{stated:g} Hz; leave --rate out, or mark the column of times '-'"
        )


def _recording(
    path: Path,
    rows: Sequence[_SampleRows],
    rate: float,
    options: SampleOptions,
    names: tuple[str, str],
) -> Recording:
    layout, suffix = names
    stated: list[tuple[StatedChannel, Column]] = []
    for one in rows:
        base = one.column.label or one.column.role
        count = one.values.shape[0]
        for number, values in enumerate(one.values, 1):
            name = f"{base}{number}" if count > 1 else base
            channel = StatedChannel(name, "", values.size, partial(np.asarray, values))
            stated.append((channel, one.column))
    return recording_of_columns(
        path,
        stated,
        sample_rate=rate,
        columns=options.columns,
        point=options.point,
        layout=layout,
        name=path.stem + suffix,
    )
