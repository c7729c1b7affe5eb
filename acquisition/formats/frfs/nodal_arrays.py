# SPDX-License-Identifier: MIT
"""FRFs as SDynPy saves them: each function with node and direction of both sides.

``save`` writes one array of records into a .npz file: abscissa (or its start and step),
ordinate, comments and coordinates. ``savemat`` writes the same as variables of a MAT
file. Neither states a unit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.frfs.checked_frf import (
    RawFrf,
    checked_frf,
    origin,
    require_count,
    unit_of,
)
from jointbench.acquisition.formats.frfs.degrees_of_freedom import degree_of_freedom
from jointbench.acquisition.formats.frfs.frf_columns import stated_unit
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.records.frf_functions import FrfFunction

_FRF = 4
_ABSCISSA, _ORDINATE, _COORDINATE = "abscissa", "ordinate", "coordinate"
_START, _STEP = "abscissa_start", "abscissa_step"
_SIDES = 2


@dataclass(frozen=True, slots=True, eq=False)
class NodalArrays:
    """Functions of nodes, one row each.

    Attributes:
        frequency: [Hz], shape (n_functions, n_lines).
        response: unit not stated, same shape.
        node: of response and reference, shape (n_functions, 2).
        direction: of both, as in `degree_of_freedom`, same shape.
        function_type: as in data set 58 of universal files; 4 is an FRF.
    """

    frequency: FloatArray
    response: NDArray[Any]
    node: NDArray[np.int64]
    direction: NDArray[np.int64]
    function_type: int = _FRF


def nodal_arrays(content: Mapping[str, Any]) -> NodalArrays | None:
    """Return the functions of a file in the layout of SDynPy.

    Args:
        content: arrays by their names, structs as mappings.

    Returns:
        The functions, or None where the file is laid out otherwise.
    """
    parts = _of_records(content)
    coordinate = parts.get(_COORDINATE)
    response = parts.get(_ORDINATE)
    if response is None or coordinate is None or not np.ndim(response):
        return None
    rows = np.reshape(response, (-1, np.shape(response)[-1]))
    frequency = _frequency(parts, rows.shape)
    node, direction = (_sides(coordinate, name) for name in ("node", "direction"))
    whole = {part.shape[0] for part in (node, direction) if part is not None}
    if frequency is None or node is None or direction is None or whole != {len(rows)}:
        return None
    kind = np.asarray(parts.get("function_type", _FRF)).ravel()
    known = kind.size == 1 and kind.dtype.kind in "iuf"
    return NodalArrays(frequency, rows, node, direction, int(kind[0]) if known else -1)


def nodal_frfs(
    path: Path, found: NodalArrays, options: FrfOptions, layout: str
) -> tuple[FrfFunction, ...]:
    """Return the FRFs of a file in the layout of SDynPy.

    Args:
        path: of the file.
        found: its functions.
        options: `columns` states the unit: ``"frf:m/s^2/N"``.
        layout: name of the format, for the provenance.

    Raises:
        FormatError: the functions are no FRFs.
        UnitError: `columns` is missing.
        BadData: see `checked_frf`.
    """
    if found.function_type != _FRF:
        raise FormatError(
            f"{named(path)} holds functions of type {found.function_type}; FRFs are of "
            f"type {_FRF}: save the FRFs"
        )
    require_count(path, len(found.response), found.response.size)
    given = stated_unit(options.columns, "frf:m/s^2/N")
    done = origin(path, layout, options.columns)
    functions = []
    for number, response in enumerate(found.response):
        pairs = zip(found.node[number], found.direction[number], strict=True)
        output, point = (degree_of_freedom(int(n), int(d)) for n, d in pairs)
        where = f"FRF {number + 1} ({output} / {point})"
        raw = RawFrf(where, found.frequency[number], response, output, point)
        unit = unit_of(path, where, "", given)
        functions.append(
            checked_frf(path, raw, unit, averages=options.averages, provenance=done)
        )
    return tuple(functions)


def _of_records(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of an array of records next to what else there is."""
    parts = dict(content)
    records = parts.pop("data", None)
    if isinstance(records, np.ndarray) and records.dtype.names:
        parts |= {name: records[name] for name in records.dtype.names}
    return parts


def _frequency(parts: Mapping[str, Any], shape: tuple[int, ...]) -> FloatArray | None:
    """Return the lines of every function [Hz], None where they are missing."""
    given = np.asarray(parts.get(_ABSCISSA, np.zeros(0)))
    if given.dtype.kind in "fiu" and given.size == np.prod(shape):
        return np.asarray(given.reshape(shape), np.float64)
    start, step = (np.asarray(parts.get(n, np.zeros(0))) for n in (_START, _STEP))
    if any(one.dtype.kind not in "fiu" or one.size != 1 for one in (start, step)):
        return None
    lines = start.ravel()[0] + step.ravel()[0] * np.arange(shape[1])
    return np.broadcast_to(np.asarray(lines, np.float64), shape)


def _sides(coordinate: Any, name: str) -> NDArray[np.int64] | None:
    """Return nodes or directions, shape (n_functions, 2)."""
    if isinstance(coordinate, np.ndarray) and name in (coordinate.dtype.names or ()):
        values = coordinate[name]
    elif isinstance(coordinate, Mapping):
        values = np.asarray(coordinate.get(name, np.zeros(0)))
    else:
        return None
    whole = np.asarray(values)
    if whole.dtype.kind not in "fiu" or not whole.size or whole.size % _SIDES:
        return None
    with np.errstate(invalid="ignore"):
        return whole.reshape(-1, _SIDES).astype(np.int64)
