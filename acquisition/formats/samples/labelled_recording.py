# SPDX-License-Identifier: MIT
"""Recordings from netCDF files of labelled arrays, as xarray writes them.

A variable along an axis of time is a channel; a further axis called ``hit`` (or run,
record, repeat ...) parts hits, any other one parts channels, named by its coordinate.
Units are the attributes ``units`` of the variables.
"""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import FormatError, UnitError
from jointbench.acquisition.basics.units import is_unit
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.column_roles import (
    RATE_EXAMPLE,
    roles_named,
)
from jointbench.acquisition.formats.even_steps import fit_even_steps, roundest
from jointbench.acquisition.formats.netcdf_arrays import (
    LabelledArray,
    read_labelled_arrays,
)
from jointbench.acquisition.formats.samples.array_recordings import (
    recordings_of_arrays,
    require_rate,
)
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.stated_channels import (
    StatedChannel,
    quantity_of_unit,
    recording_of,
)
from jointbench.acquisition.records.recordings import Recording

HIT_AXES = frozenset(
    "hit hits blow blows impact impacts record records recording run runs repeat "
    "repeats repetition trial measurement average averages shot".split()
)
_TIMES = ("time", "t")
Arrays = Mapping[str, LabelledArray]


def read_labelled_recordings(
    path: Path, options: SampleOptions
) -> tuple[Recording, ...]:
    """Read the recordings of a netCDF file, one for each hit.

    Args:
        path: of the file.
        options: `columns` names variables by label where the file states no units;
            `rate` stands in for an axis of time without coordinate.

    Raises:
        FormatError: it is damaged, or has no axis of time.
        UnitError: a unit is missing; the message has what to type.
        BadData: see `recordings_of_arrays`.
    """
    file_size(path)
    arrays = read_labelled_arrays(path)
    if "time" in roles_named(options.columns):
        plain = {name: one.values for name, one in arrays.items()}
        return recordings_of_arrays(path, plain, options, "netCDF")
    axis = _time_axis(path, arrays, options.rate)
    rate = _rate(path, arrays.get(axis), axis, options.rate)
    channels: list[list[StatedChannel]] = []
    for name, one in arrays.items():
        if axis not in one.dims or one.dims == (axis,) == (name,):
            continue
        if one.values.dtype.kind in "fiu":
            _add_channels(path, name, one, arrays, axis, channels)
    return tuple(
        recording_of(
            path,
            hit,
            sample_rate=rate,
            columns=options.columns,
            point=options.point,
            layout="netCDF, labelled arrays",
            name=path.stem + (f"-{number}" if len(channels) > 1 else ""),
        )
        for number, hit in enumerate(channels, 1)
    )


def _time_axis(path: Path, arrays: Arrays, rate: float | None) -> str:
    """Return the name of the axis of time."""
    axes = dict.fromkeys(axis for one in arrays.values() for axis in one.dims)
    for axis in axes:
        if axis in arrays and is_unit(arrays[axis].units, "time"):
            return axis
    for axis in axes:
        if axis.lower() in _TIMES:
            if rate is None and not (axis in arrays and arrays[axis].units):
                raise UnitError(
                    f"{named(path)}: the axis {shown(axis)} states no unit; give it "
                    "the attribute units = 's', or give the rate: --rate '10 kHz'"
                )
            return axis
    raise FormatError(
        f"{named(path)} has no axis of time (its axes are "
        f"{', '.join(map(shown, axes)) or 'none'}); FRFs are read by `jointbench "
        f"modal`, plain variables by --columns 'time.t:s,force.F:N'"
    )


def _rate(
    path: Path, along: LabelledArray | None, axis: str, stated: float | None
) -> float:
    """Return the sample rate [Hz]."""
    if along is None or not is_unit(along.units, "time"):
        if stated is None:
            raise UnitError(
                f"{named(path)}: the axis {shown(axis)} has no coordinate with a unit "
                f"of time; give the rate, {RATE_EXAMPLE}"
            )
        return stated
    from jointbench.acquisition.basics.units import to_si

    steps = fit_even_steps(
        np.asarray(along.values, np.float64),
        what=axis,
        unit=along.units,
        where=lambda i: f"sample {i + 1}",
    )
    second = to_si(along.units, "time")
    rate = roundest(1 / (steps.high * second), 1 / (steps.low * second))
    require_rate(path, rate, stated)
    return rate


def _add_channels(
    path: Path,
    name: str,
    one: LabelledArray,
    arrays: Arrays,
    axis: str,
    hits: list[list[StatedChannel]],
) -> None:
    """Append the channels of a variable to each hit."""
    rest = [dim for dim in one.dims if dim != axis]
    runs = [dim for dim in rest if dim.lower() in HIT_AXES]
    if len(runs) > 1 or len(rest) - len(runs) > 1:
        raise FormatError(
            f"{named(path)}: variable {shown(name)} has the axes "
            f"{', '.join(one.dims)}; time, one axis of hits and one of channels are "
            "read"
        )
    order = [*runs, *[d for d in rest if d not in runs], axis]
    values = np.moveaxis(
        one.values, [one.dims.index(d) for d in order], range(len(order))
    )
    values = values if runs else values[None]
    table = values if len(rest) > len(runs) else values[:, None]
    labels = _labels(arrays, rest, runs, table.shape[1])
    units = _units(arrays, one, rest, runs, table.shape[1])
    if hits and len(hits) != len(table):
        raise FormatError(
            f"{named(path)}: variable {shown(name)} holds {len(table)} hits, others "
            f"{len(hits)}; save the same hits of every channel"
        )
    hits.extend([] for _ in range(len(table) - len(hits)))
    for hit, rows in zip(hits, table, strict=True):
        for row, label, unit in zip(rows, labels, units, strict=True):
            own = label if labels != [""] else name
            if labels != [""] and any(channel.name == label for channel in hit):
                own = f"{name} {label}"
            read = partial(np.asarray, row, np.float64)
            quantity = quantity_of_unit(unit)
            hit.append(StatedChannel(own, unit, row.size, read, quantity=quantity))


def _labels(arrays: Arrays, rest: list[str], runs: list[str], count: int) -> list[str]:
    """Return the names of channels along their axis; one empty name without one."""
    axes = [dim for dim in rest if dim not in runs]
    if not axes:
        return [""]
    along = arrays.get(axes[0])
    if along is not None and along.values.shape == (count,):
        return [str(value) for value in along.values]
    return [f"{axes[0]} {number + 1}" for number in range(count)]


def _units(
    arrays: Arrays, one: LabelledArray, rest: list[str], runs: list[str], count: int
) -> list[str]:
    """Return the units of channels, from the variable or along their axis."""
    axes = [dim for dim in rest if dim not in runs]
    if axes and not one.units:
        for name in ("unit", "units"):
            along = arrays.get(name)
            if along is not None and along.dims == (axes[0],):
                return [str(value) for value in along.values]
    return [one.units] * count
