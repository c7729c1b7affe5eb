# SPDX-License-Identifier: MIT
"""Channels as stated by a foreign file, and their recording.

A unit is taken from the file where the file states it, else from ``--columns``, whose
labels then are the file's names of the channels. Channels without a unit from either
are refused.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.basics.units import example_unit, is_unit, to_si
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.columns import (
    SKIP,
    Column,
    only_roles,
    parse_columns,
)
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording

MOST_VALUES = 100_000_000
MOST_CHANNELS = 4096
_VOLTAGE = "voltage"
QUANTITIES = tuple(quantity.value for quantity in Quantity)


@dataclass(frozen=True, slots=True)
class StatedChannel:
    """A channel of a foreign file.

    Attributes:
        name: as the file calls it.
        unit: as the file states it; empty where it does not.
        size: number of samples.
        read: returns them, in the file's unit, shape (size,).
        point: where it sits; empty if not stated.
        direction: ``"+z"`` and the like; empty if not stated.
        quantity: as the file states it; None where it does not.
    """

    name: str
    unit: str
    size: int
    read: Callable[[], FloatArray]
    point: str = ""
    direction: str = ""
    quantity: Quantity | None = None


def recording_of(
    path: Path,
    stated: Iterable[StatedChannel],
    *,
    sample_rate: float,
    columns: str | None,
    point: str,
    layout: str,
    name: str | None = None,
) -> Recording:
    """Return the channels of a foreign file as a recording.

    Args:
        path: of the file.
        stated: its channels, not read yet.
        sample_rate: [Hz].
        columns: their quantities, or None if the file states them.
        point: where the hammer struck, if neither the file nor `columns` states it.
        layout: name of the format, for the provenance.
        name: of the recording; that of the file if None.

    Raises:
        UnitError: a unit is missing, unknown, or not the one that the file states.
        UsageError: `columns` names a channel that is not there.
        SamplingError: the channels have no, or not the same number of samples, or an
            invalid rate.
        HostileFile: there are more samples than any measurement has.
        BadData: a sample is not finite.
    """
    stated = tuple(stated)
    _require_sane(path, stated, sample_rate)
    wanted = _as_stated(path, stated) if columns is None else _named(stated, columns)
    return recording_of_columns(
        path,
        wanted,
        sample_rate=sample_rate,
        columns=columns,
        point=point,
        layout=layout,
        name=name,
    )


def recording_of_columns(
    path: Path,
    wanted: Sequence[tuple[StatedChannel, Column]],
    *,
    sample_rate: float,
    columns: str | None,
    point: str,
    layout: str,
    name: str | None = None,
) -> Recording:
    """Return channels with their columns as a recording; see `recording_of`."""
    _require_sane(path, [channel for channel, _ in wanted], sample_rate)
    _require_even(path, [channel for channel, _ in wanted])
    samples = np.empty((len(wanted), wanted[0][0].size))
    for row, (channel, column) in zip(samples, wanted, strict=True):
        row[:] = _samples(path, channel)
        row *= column.factor
    origin = step(
        "import",
        file=path.name,
        sha256=file_digest(path),
        layout=layout,
        columns=columns or "as the file states",
    )
    return Recording(
        name=path.stem if name is None else name,
        samples=samples,
        sample_rate=sample_rate,
        channels=tuple(_channel(ch, column, point) for ch, column in wanted),
        provenance=(origin,),
    )


def _require_sane(
    path: Path, stated: Sequence[StatedChannel], sample_rate: float
) -> None:
    if not stated:
        raise FormatError(f"{named(path)} holds no channel of samples")
    if not (np.isfinite(sample_rate) and 0.0 < sample_rate < 1e9):
        raise SamplingError(
            f"{named(path)}: the sample rate is {sample_rate:g} Hz; export it with the "
            "rate it was recorded at"
        )
    total = sum(channel.size for channel in stated)
    if len(stated) > MOST_CHANNELS or total > MOST_VALUES:
        raise HostileFile(
            f"{named(path)} claims {len(stated)} channels and {total} samples, at most "
            f"{MOST_CHANNELS} and {MOST_VALUES} are read; cut it"
        )


def _require_even(path: Path, channels: Sequence[StatedChannel]) -> None:
    sizes = {channel.size for channel in channels}
    if len(sizes) != 1 or 0 in sizes:
        found = ", ".join(f"{shown(c.name)} {c.size}" for c in channels[:8])
        raise SamplingError(
            f"{named(path)}: channels must have the same number of samples, more than "
            f"none; they have {found}"
        )


def _as_stated(
    path: Path, stated: Sequence[StatedChannel]
) -> list[tuple[StatedChannel, Column]]:
    """Return each channel with a column from its stated unit.

    Raises:
        UnitError: a unit is missing, or belongs to no quantity.
    """
    found = []
    for channel in stated:
        quantity = channel.quantity or quantity_of_unit(channel.unit)
        if quantity is None or not is_unit(channel.unit, quantity.value):
            raise UnitError(_what_to_type(path, stated, channel))
        found.append((channel, Column(quantity.value, channel.unit)))
    return found


def quantity_of_unit(unit: str) -> Quantity | None:
    """Return the single quantity of a unit."""
    found = [quantity for quantity in Quantity if is_unit(unit, quantity.value)]
    return found[0] if len(found) == 1 else None


def _what_to_type(
    path: Path, stated: Sequence[StatedChannel], channel: StatedChannel
) -> str:
    items = []
    for number, one in enumerate(stated[:6]):
        role = "force" if number == 0 else "acceleration"
        unit = one.unit if is_unit(one.unit, role) else example_unit(role)
        items.append(f"{role}.{one.name}:{unit}")
    unit = "states no unit"
    if channel.unit:
        kinds = channel.quantity.value if channel.quantity else ", ".join(QUANTITIES)
        unit = f"states the unit {shown(channel.unit)}, which is none of {kinds}"
    return (
        f"{named(path)}: channel {shown(channel.name)} {unit}; describe the channels, "
        f"for example --columns '{','.join(items)}'"
    )


def _named(
    stated: Sequence[StatedChannel], columns: str
) -> list[tuple[StatedChannel, Column]]:
    """Return the channels that the columns name by label, or by order without."""
    wanted = parse_columns(columns)
    only_roles(wanted, QUANTITIES, "a recording whose file states the time")
    labelled = [column.label for column in wanted if column.role != SKIP]
    names = [channel.name for channel in stated]
    if not any(labelled):
        if len(wanted) != len(stated):
            raise UsageError(
                f"--columns names {len(wanted)} channels, the file has {len(stated)} "
                f"({', '.join(map(shown, names[:12]))}); name each, '-' for one that "
                "is not wanted"
            )
        pairs = list(zip(stated, wanted, strict=True))
        return [_agreeing(*pair) for pair in pairs if pair[1].role != SKIP]
    found = []
    for column in wanted:
        if column.role == SKIP:
            continue
        if names.count(column.label) != 1:
            raise UsageError(
                f"--columns names channel {column.label!r}; the file has "
                f"{', '.join(map(shown, names[:12]))}"
            )
        found.append(_agreeing(stated[names.index(column.label)], column))
    return found


def _agreeing(channel: StatedChannel, column: Column) -> tuple[StatedChannel, Column]:
    """Raise `UnitError` where the file states another unit than the user."""
    kinds = [kind for kind in (*QUANTITIES, _VOLTAGE) if is_unit(channel.unit, kind)]
    stated = _VOLTAGE if column.sensitivity is not None else column.role
    if kinds and stated not in kinds:
        way = f"write {channel.unit!r}, or correct the file"
        if kinds == [_VOLTAGE]:
            way = f"write '{channel.unit}@' and the sensitivity of the sensor"
        raise _contradiction(channel, column, way)
    if kinds and not np.isclose(
        to_si(channel.unit, stated), to_si(column.unit, stated)
    ):
        way = f"write {channel.unit!r}, or correct the file"
        raise _contradiction(channel, column, way)
    return channel, column


def _contradiction(channel: StatedChannel, column: Column, way: str) -> UnitError:
    return UnitError(
        f"channel {channel.name!r} is in {channel.unit!r} by its file, --columns says "
        f"{column.unit!r}; {way}"
    )


def _samples(path: Path, channel: StatedChannel) -> FloatArray:
    values = np.asarray(channel.read(), dtype=np.float64).ravel()
    if values.size != channel.size:
        raise FormatError(
            f"{named(path)}: channel {shown(channel.name)} holds {values.size} of "
            f"{channel.size} samples; it is cut short: use another copy"
        )
    if not np.isfinite(values).all():
        bad = np.flatnonzero(~np.isfinite(values))
        raise BadData(
            f"{named(path)}: channel {shown(channel.name)} holds {bad.size} values "
            f"that are not finite, the first at sample {bad[0]}; cut the record there"
        )
    return values


def _channel(channel: StatedChannel, column: Column, point: str) -> Channel:
    quantity = Quantity(column.role)
    default = point if quantity is Quantity.FORCE else ""
    return Channel(
        name=channel.name,
        quantity=quantity,
        point=column.point or channel.point or default,
        direction=channel.direction,
        unit=column.unit,
        sensitivity=column.sensitivity,
    )
