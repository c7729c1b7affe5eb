# SPDX-License-Identifier: MIT
"""FRFs from netCDF files of labelled arrays, as xarray writes them.

A complex variable along an axis of frequency (or a pair ``H_re``, ``H_im``) holds the
FRFs; further axes are outputs and inputs, named by their coordinates. Variables
``coherence`` and ``variance`` of the same axes are read with it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError, UnitError
from jointbench.acquisition.basics.units import is_unit, to_si
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.column_roles import (
    QUANTITY_NAMES,
    roles_named,
)
from jointbench.acquisition.formats.frfs.checked_frf import (
    RawFrf,
    checked_frf,
    origin,
    require_count,
    unit_of,
)
from jointbench.acquisition.formats.frfs.frf_arrays import frfs_of_arrays
from jointbench.acquisition.formats.frfs.frf_columns import (
    names_frequency,
    stated_unit,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.netcdf_arrays import (
    NETCDF_SUFFIXES,
    LabelledArray,
    complex_pairs,
    read_labelled_arrays,
)
from jointbench.acquisition.records.frf_functions import FrfFunction

_FREQUENCIES = ("frequency", "freq", "f")
_INPUTS = ("input", "reference", "excitation", "force", "drive", "impact")
_NOISE = {"coherence": ("coherence", "coh"), "variance": ("variance", "var")}
_DEVIATIONS = ("sd", "std", "standard_deviation")
_MOST_AXES = 3
Arrays = Mapping[str, LabelledArray]


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Where the FRFs stand: their name, and the axes of outputs and inputs."""

    name: str
    axis: str
    outputs: str | None
    inputs: str | None


def recognise_netcdf_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a netCDF file holds complex values over frequency."""
    if path.suffix.lower() not in NETCDF_SUFFIXES:
        return False
    if roles_named(options.columns) & {"time", *QUANTITY_NAMES}:
        return False
    if names_frequency(options.columns):
        return True
    try:
        arrays = complex_pairs(read_labelled_arrays(path))
    except BadData:
        return False  # the reader of samples reports the fault
    return any(
        one.values.dtype.kind == "c" and _axis(arrays, one) for one in arrays.values()
    )


def read_netcdf_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a netCDF file.

    Args:
        path: of the file.
        options: `columns` states the unit where the file does not, ``"frf:g/N"``, or
            names plain variables, ``"frequency.f:Hz,real.re:m/N,imaginary.im:m/N"``.

    Raises:
        UnitError: a unit is missing or unknown; the message has what to type.
        FormatError: it is damaged, or its axes are not those of FRFs.
        BadData: see `checked_frf`.
    """
    read = read_labelled_arrays(path)
    if names_frequency(options.columns):
        plain = {name: one.values for name, one in read.items()}
        return frfs_of_arrays(path, plain, options, "netCDF, variables")
    arrays = complex_pairs(read)
    layout = _layout(path, arrays)
    whole = arrays[layout.name]
    unit = unit_of(
        path,
        f"variable {shown(layout.name)}",
        whole.units,
        stated_unit(options.columns, "frf:m/s^2/N"),
    )
    done = origin(path, "netCDF, labelled arrays", options.columns)
    require_count(path, whole.values[..., 0].size, whole.values.size)
    return tuple(
        checked_frf(path, raw, unit, averages=options.averages, provenance=done)
        for raw in _functions(path, arrays, layout, options.point)
    )


def _axis(arrays: Arrays, one: LabelledArray) -> str:
    """Return the axis of frequency of a variable; empty without one."""
    for axis in one.dims:
        along = arrays.get(axis)
        if along is not None and is_unit(along.units, "frequency"):
            return axis
    return next((axis for axis in one.dims if axis.lower() in _FREQUENCIES), "")


def _layout(path: Path, arrays: Arrays) -> _Layout:
    found = [
        name
        for name, one in arrays.items()
        if one.values.dtype.kind == "c" and _axis(arrays, one)
    ]
    if len(found) != 1:
        raise FormatError(
            f"{named(path)} holds {len(found)} complex variables over frequency "
            f"({', '.join(map(shown, found)) or 'none'}); name one, for example "
            "--columns 'frequency.frequency:Hz,frf.H:m/s^2/N'"
        )
    one = arrays[found[0]]
    axis = _axis(arrays, one)
    rest = [dim for dim in one.dims if dim != axis]
    if len(one.dims) > _MOST_AXES:
        raise FormatError(
            f"{named(path)}: variable {shown(found[0])} has the axes "
            f"{', '.join(one.dims)}; frequency, outputs and inputs are read"
        )
    inputs = [dim for dim in rest if any(word in dim.lower() for word in _INPUTS)]
    drive = inputs[0] if inputs else (rest[1] if len(rest) > 1 else None)
    answer = next((dim for dim in rest if dim != drive), None)
    return _Layout(found[0], axis, answer, drive)


def _functions(
    path: Path, arrays: Arrays, layout: _Layout, point: str
) -> Iterator[RawFrf]:
    whole = arrays[layout.name]
    cube = _cube(whole, layout)
    frequency = _frequency(path, arrays.get(layout.axis), layout.axis)
    outputs = _labels(arrays, layout.outputs, cube.shape[0])
    inputs = _labels(arrays, layout.inputs, cube.shape[1])
    noise = _noise(arrays, layout, cube.shape)
    for row, output in enumerate(outputs):
        for column, place in enumerate(inputs):
            yield RawFrf(
                f"FRF {output or row + 1} / {place or point}",
                frequency,
                cube[row, column],
                output,
                place or point,
                {name: values[row, column] for name, values in noise.items()},
            )


def _cube(one: LabelledArray, layout: _Layout) -> NDArray[Any]:
    """Return values in the shape (n_outputs, n_inputs, n_lines)."""
    values, dims = one.values, list(one.dims)
    for place, axis in ((0, layout.outputs), (1, layout.inputs)):
        if axis is None:
            values = np.expand_dims(values, place)
            dims.insert(place, f" {place}")
    wanted = [layout.outputs or " 0", layout.inputs or " 1", layout.axis]
    return np.moveaxis(values, [dims.index(axis) for axis in wanted], (0, 1, 2))


def _frequency(path: Path, along: LabelledArray | None, axis: str) -> FloatArray:
    if along is None or along.values.dtype.kind not in "fiu":
        raise FormatError(
            f"{named(path)}: the axis {shown(axis)} has no frequencies; save them as "
            "its coordinate, with the attribute units = 'Hz'"
        )
    if not is_unit(along.units, "frequency"):
        stated = f"states {shown(along.units)}" if along.units else "states no unit"
        raise UnitError(
            f"{named(path)}: the axis {shown(axis)} {stated}; give it the attribute "
            "units = 'Hz'"
        )
    factor = to_si(along.units, "frequency")
    return np.asarray(along.values, np.float64).ravel() * factor


def _labels(arrays: Arrays, axis: str | None, count: int) -> list[str]:
    along = arrays.get(axis) if axis is not None else None
    if along is not None and along.values.shape == (count,):
        return [str(value) for value in along.values]
    return [""] if count == 1 else [str(number + 1) for number in range(count)]


def _noise(
    arrays: Arrays, layout: _Layout, shape: tuple[int, ...]
) -> dict[str, FloatArray]:
    """Return coherence and variance where the file has them on the same axes."""
    dims = arrays[layout.name].dims
    found: dict[str, FloatArray] = {}
    for name, one in arrays.items():
        if one.dims != dims or one.values.dtype.kind not in "fiu":
            continue
        last = name.lower().rpartition("_")[2]
        values = np.asarray(_cube(one, layout), np.float64)
        for role, words in _NOISE.items():
            if last in words and values.shape == shape:
                found[role] = values
        if last in _DEVIATIONS and "variance" not in found:
            found["variance"] = values**2
    return found


FORMAT = FrfFormat("netcdf_frfs", recognise_netcdf_frfs, read_netcdf_frfs)
