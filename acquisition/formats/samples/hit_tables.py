# SPDX-License-Identifier: MIT
"""Hits from plain tables: one row per time stamp, one column per channel."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.column_roles import (
    RATE_EXAMPLE,
)
from jointbench.acquisition.formats.columns import (
    HITS_EXAMPLE,
    Column,
    only_roles,
    parse_columns,
)
from jointbench.acquisition.formats.even_steps import (
    EvenSteps,
    fit_even_steps,
    roundest,
)
from jointbench.acquisition.formats.header_units import hit_columns_stated, units_words
from jointbench.acquisition.formats.samples.array_recordings import require_rate
from jointbench.acquisition.formats.tables import Table, load_table
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording

_TIME = "time"
_QUANTITIES = tuple(quantity.value for quantity in Quantity)


def read_recording(
    path: Path | str,
    *,
    columns: str | None,
    name: str | None = None,
    point: str = "1",
    rate: float | None = None,
) -> Recording:
    """Read a table of time and measured columns as a recording.

    Args:
        path: delimited text or a .npy file.
        columns: what each column holds and in which unit; see `parse_columns`. None if
            the header of the table states it.
        name: of the recording; the name of the file without its ending if None.
        point: where the hammer struck.
        rate: sample rate of a table without a column of times [Hz], or None.

    Returns:
        The recording in SI units. Its sample rate is the roundest one that the
        printed time stamps allow, so that rounded stamps give 4000 Hz, not 4000.3.

    Raises:
        UnitError: `columns` is None and the header does not say the units either, or
            a unit is missing or wrong.
        UsageError: `columns` names no time, no channel, or something unknown.
        FormatError: the file is no such table, or has another number of columns.
        SamplingError: time stamps or samples are missing, or not in an even row.
    """
    path = Path(path)
    wanted = None if columns is None else _hit_columns(columns, rate)
    table = load_table(path, columns=None if wanted is None else len(wanted))
    if wanted is None:
        wanted = hit_columns_stated(table, timed=rate is None)
    if wanted is None:
        raise UnitError(_what_to_type(table))
    if len(wanted) != table.values.shape[0]:
        raise FormatError(
            f"{named(path)} has {table.values.shape[0]} columns, --columns names "
            f"{len(wanted)} ({columns}); name each, '-' for one that is not wanted"
        )
    rows = [i for i, c in enumerate(wanted) if c.role in _QUANTITIES]
    channels = _channels([wanted[i] for i in rows], point)
    samples = np.stack([_samples(table, i, wanted[i]) for i in rows])
    time = next((i for i, c in enumerate(wanted) if c.role == _TIME), None)
    timing = _stated_rate(rate) if time is None else _timing(table, wanted, time)
    require_rate(path, timing.rate, rate)
    return Recording(
        name=path.stem if name is None else name,
        samples=samples,
        sample_rate=timing.rate,
        channels=channels,
        start_time=timing.start,
        provenance=(_origin(table, columns or _as_stated(wanted), timing),),
    )


@dataclass(frozen=True, slots=True)
class _Timing:
    """Rate and start of a recording [Hz, s], and what a column of times showed."""

    rate: float
    start: float
    facts: tuple[tuple[str, float], ...]


def _stated_rate(rate: float | None) -> _Timing:
    assert rate is not None  # checked with the columns
    return _Timing(rate, 0.0, (("rate_stated", rate),))


def _timing(table: Table, columns: Sequence[Column], time: int) -> _Timing:
    """Return the roundest rate that the printed times allow."""
    steps = _time_steps(table, columns)
    second = columns[time].factor
    facts = (
        ("rate_from_time_span", 1 / (steps.step * second)),
        ("time_resolution", steps.resolution * second),
    )
    rate = roundest(1 / (steps.high * second), 1 / (steps.low * second))
    return _Timing(rate, float(table.values[time, 0]) * second, facts)


def _origin(table: Table, columns: str, timing: _Timing) -> Step:
    return step(
        "import",
        file=table.path.name,
        sha256=file_digest(table.path),
        layout=table.layout,
        columns=columns,
        **dict(timing.facts),
    )


def _as_stated(columns: Sequence[Column]) -> str:
    words = ",".join(f"{column.role}:{column.unit}" for column in columns)
    return f"as the file states: {words}"


def _hit_columns(spec: str, rate: float | None) -> tuple[Column, ...]:
    columns = parse_columns(spec)
    only_roles(columns, (_TIME, *_QUANTITIES), "a recording of hits")
    if not any(column.role in _QUANTITIES for column in columns):
        raise UsageError(
            f"--columns {spec!r} names no measured column; write for example "
            f"'{HITS_EXAMPLE}'"
        )
    if rate is None and not any(column.role == _TIME for column in columns):
        raise UsageError(
            f"--columns {spec!r} names no time column; write for example "
            f"'{HITS_EXAMPLE}', or give the rate of samples without times: "
            f"{RATE_EXAMPLE}"
        )
    return columns


def _what_to_type(table: Table) -> str:
    count = table.values.shape[0]
    first = HITS_EXAMPLE.split(",")
    items = first[: max(2, count)] + [first[-1]] * (count - len(first))
    return (
        f"{named(table.path)} has {count} columns and {units_words(table)}; "
        f"describe them (give --rate where no column is the time), for example "
        f"--columns '{','.join(items)}'"
    )


def _time_column(columns: Sequence[Column]) -> int:
    return next(i for i, column in enumerate(columns) if column.role == _TIME)


def _time_steps(table: Table, columns: Sequence[Column]) -> EvenSteps:
    index = _time_column(columns)
    unit = columns[index].unit
    to_si(unit, "time")
    table.require_sane(index, columns[index].factor, "time")
    try:
        return fit_even_steps(
            table.values[index],
            what="time",
            unit=unit,
            where=table.where,
            printed=lambda: table.printed_units(index),
        )
    except BadData as error:
        raise SamplingError(f"{named(table.path)}: {error}") from error


def _samples(table: Table, index: int, column: Column) -> FloatArray:
    values = table.values[index]
    bad = ~np.isfinite(values)
    if column.code is not None:
        bad |= values == column.code
    if np.any(bad):
        row = int(np.flatnonzero(bad)[0])
        raise SamplingError(
            f"{named(table.path)}: {table.where(row)}: {column.role} is "
            f"{values[row]:g}, every sample needs a number; cut the record there, or "
            "export it without gaps"
        )
    table.require_sane(index, column.factor, column.role)
    return np.asarray(values * column.factor)


def _channels(columns: Sequence[Column], point: str) -> tuple[Channel, ...]:
    """Name the channels: by label, else by quantity, numbered where it repeats."""
    total = Counter(column.role for column in columns if not column.label)
    seen: Counter[str] = Counter()
    channels = []
    for column in columns:
        name = column.label or column.role
        if not column.label and total[column.role] > 1:
            seen[column.role] += 1
            name = f"{column.role}_{seen[column.role]}"
        channels.append(_channel(column, name, point))
    names = [channel.name for channel in channels]
    if len(set(names)) != len(names):
        raise UsageError(
            f"--columns gives the same name to two channels: {', '.join(names)}"
        )
    return tuple(channels)


def _channel(column: Column, name: str, point: str) -> Channel:
    quantity = Quantity(column.role)
    hammer_point = point if quantity is Quantity.FORCE else ""
    return Channel(
        name=name,
        quantity=quantity,
        point=column.point or hammer_point,
        unit=column.unit,
        sensitivity=column.sensitivity,
    )
