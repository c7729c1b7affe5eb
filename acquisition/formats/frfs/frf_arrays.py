# SPDX-License-Identifier: MIT
"""FRFs from named arrays, whatever file they come from: frequency, FRF, its noise.

An FRF has the shape (n_lines,), (n_outputs, n_lines) or (n_outputs, n_inputs, n_lines);
the axis of the lines may come first as well.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.frfs.checked_frf import (
    RawFrf,
    checked_frf,
    origin,
    require_count,
)
from jointbench.acquisition.formats.frfs.frf_columns import (
    COHERENCE,
    COMPLEX,
    DEVIATION,
    IMAGINARY,
    MAGNITUDE,
    PHASE,
    REAL,
    VARIANCE,
    FrfColumn,
    one_frequency,
    parse_frf_columns,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.recordings import Quantity

Arrays = Mapping[str, NDArray[Any]]
ARRAYS_EXAMPLE = "frequency.f:Hz,frf.H:m/s^2/N"


def frfs_of_arrays(
    path: Path, arrays: Arrays, options: FrfOptions, layout: str
) -> tuple[FrfFunction, ...]:
    """Return the FRFs of named arrays.

    Args:
        path: of the file.
        arrays: by their names.
        options: `columns` names the arrays by label; without one, an array is called
            like its role.
        layout: name of the format, for the provenance.

    Raises:
        UsageError: `columns` names an array that is not there, or an FRF by half.
        FormatError: shapes do not fit each other.
        BadData: see `checked_frf`.
    """
    text = options.columns or ""
    columns = {column.role: column for column in parse_frf_columns(text)}
    frequency = _frequencies(path, arrays, columns, text)
    cubes = {
        role: _cube(path, _array(path, arrays, column), column, frequency.size)
        for role, column in columns.items()
        if role != "frequency" and role != "skip"
    }
    quantity = next(c.quantity for c in columns.values() if c.quantity is not None)
    response = _response(cubes, text)
    require_count(path, response[..., 0].size, response.size)
    for role in (COHERENCE, VARIANCE, DEVIATION):
        if role in cubes and cubes[role].shape != response.shape:
            raise FormatError(
                f"{named(path)}: {role} has shape {cubes[role].shape}, the FRFs "
                f"{response.shape}; give one value for each value of the FRFs"
            )
    done = origin(path, layout, options.columns)
    return tuple(
        _function(path, frequency, response, cubes, quantity, pair, options, done)
        for pair in np.ndindex(response.shape[:2])
    )


def _function(
    path: Path,
    frequency: FloatArray,
    response: NDArray[Any],
    cubes: Mapping[str, NDArray[Any]],
    quantity: Quantity,
    pair: tuple[int, ...],
    options: FrfOptions,
    done: Any,
) -> FrfFunction:
    noise: dict[str, FloatArray | None] = {
        role: cubes[role][pair].real for role in (COHERENCE, VARIANCE) if role in cubes
    }
    if DEVIATION in cubes:
        noise[VARIANCE] = cubes[DEVIATION][pair].real ** 2
    row, column = pair
    several = response.shape[1] > 1
    raw = RawFrf(
        f"FRF {row + 1}, {column + 1}",
        frequency,
        response[pair],
        str(row + 1) if response.shape[0] > 1 else "",
        str(column + 1) if several else options.point,
        noise,
    )
    return checked_frf(
        path, raw, (quantity, 1.0), averages=options.averages, provenance=done
    )


def _array(path: Path, arrays: Arrays, column: FrfColumn) -> NDArray[Any]:
    name = column.label or column.role
    if name not in arrays:
        held = ", ".join(shown(n) for n in list(arrays)[:12]) or "none"
        raise UsageError(
            f"{named(path)} holds no array {name!r}; it holds {held}: name each after "
            f"its role, for example --columns '{ARRAYS_EXAMPLE}'"
        )
    array = arrays[name]
    if array.dtype.kind not in "fiuc" or array.ndim > 3 or not array.size:
        raise FormatError(
            f"{named(path)}: array {name!r} has the type {array.dtype} and the shape "
            f"{array.shape}; numbers in one to three dimensions are read"
        )
    return array


def _frequencies(
    path: Path, arrays: Arrays, columns: Mapping[str, FrfColumn], text: str
) -> FloatArray:
    """Return the lines [Hz], given or by their distance."""
    for column in columns.values():
        if column.spacing is not None:
            count = _array(path, arrays, column).shape[-1]
            return np.asarray(column.spacing * np.arange(count), np.float64)
    column = one_frequency(tuple(columns.values()), text)
    values = np.squeeze(_array(path, arrays, column))
    if np.iscomplexobj(values) or values.ndim != 1:
        raise FormatError(
            f"{named(path)}: array {column.label or column.role!r} has the shape "
            f"{values.shape}; frequencies are one row of real numbers"
        )
    return np.asarray(values, np.float64) * column.factor


def _cube(
    path: Path, array: NDArray[Any], column: FrfColumn, lines: int
) -> NDArray[Any]:
    """Return an array in SI units, shape (n_outputs, n_inputs, n_lines)."""
    if array.shape[-1] != lines and array.shape[0] == lines:
        array = np.moveaxis(array, 0, -1)
    if array.shape[-1] != lines:
        raise FormatError(
            f"{named(path)}: array {column.label or column.role!r} has the shape "
            f"{array.shape}, and there are {lines} frequencies; the lines are its "
            "last axis, or its first"
        )
    if array.ndim < 3:
        array = array.reshape(-1, 1, lines)
    plain = 10.0 ** (array / 20.0) if column.decibel else array
    return np.asarray(plain * column.factor)


def _response(cubes: Mapping[str, NDArray[Any]], text: str) -> NDArray[Any]:
    """Return the FRFs, from one complex array or from two of one shape."""
    if COMPLEX in cubes:
        return cubes[COMPLEX]
    for first, second in ((REAL, IMAGINARY), (MAGNITUDE, PHASE)):
        if first in cubes and second in cubes:
            one, other = cubes[first], cubes[second]
            if one.shape == other.shape:
                turned = 1j * other if first == REAL else None
                return one * np.exp(1j * other) if turned is None else one + turned
    raise UsageError(
        f"--columns {text!r} names no whole FRF; name a complex array, real and "
        "imaginary, or magnitude and phase of one shape, for example "
        f"'{ARRAYS_EXAMPLE}'"
    )


def no_units_words(path: Path, names: Sequence[str]) -> str:
    """Return the message for a file of arrays without units."""
    held = ", ".join(map(shown, names[:12])) or "none"
    return (
        f"{named(path)} holds the arrays {held} and no units; state what they are, for "
        f"example --columns '{ARRAYS_EXAMPLE}'"
    )
