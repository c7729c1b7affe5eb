# SPDX-License-Identifier: MIT
"""FRFs from MAT files: structs as Simcenter Testlab exports them, and plain variables.

A struct of Testlab has ``x_values`` (start, increment, number), ``y_values`` (values,
quantity with the label of its unit) and ``function_record`` (names of the channels).
A file that SDynPy saved names its functions itself; see `nodal_arrays`. Plain variables
are named by ``--columns 'frequency.f:Hz,frf.H:m/s^2/N'``.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
from jointbench.acquisition.formats.frfs.frf_arrays import (
    frfs_of_arrays,
    no_units_words,
)
from jointbench.acquisition.formats.frfs.frf_columns import (
    FrfColumn,
    names_frequency,
    names_frfs,
    stated_unit,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.frfs.mat5_structs import read_mat5
from jointbench.acquisition.formats.frfs.mat73_structs import read_mat73
from jointbench.acquisition.formats.frfs.nodal_arrays import nodal_arrays, nodal_frfs
from jointbench.acquisition.formats.tables import read_head
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.provenance import Provenance

_HDF5 = (b"\x89HDF", b"MATLAB 7.3")
_MATLAB = b"MATLAB 5.0"
_DEEPEST = 4
_COHERENCE = "coherence"
Struct = Mapping[str, Any]


def recognise_mat_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a MAT file holds FRFs: by --columns, or as structs of Testlab."""
    try:
        head = read_head(path, 128)
        if path.suffix.lower() != ".mat" and not head.startswith(_MATLAB):
            return False
        if names_frfs(options.columns):
            return True
        return options.columns is None and _names_its_frfs(_read(path))
    except BadData:
        return False


def read_mat_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a MAT file.

    Args:
        path: of a file of any version from 5 on.
        options: `columns` names plain variables, or states the unit of Testlab's
            structs where these do not.

    Raises:
        UnitError: a unit is missing or unknown; the message has what to type.
        FormatError: it is damaged, or holds no FRF.
        HostileFile: it asks for more than a measurement would.
        BadData: see `checked_frf`.
    """
    content = _read(path)
    structs = list(_testlab(content))
    plain = names_frequency(options.columns)
    nodal = None if plain or structs else nodal_arrays(content)
    if nodal is not None:
        return nodal_frfs(path, nodal, options, "MAT of SDynPy")
    if plain or not structs:
        arrays = {n: v for n, v in content.items() if isinstance(v, np.ndarray)}
        if not plain:
            raise UnitError(no_units_words(path, list(arrays)))
        return frfs_of_arrays(path, arrays, options, "MAT, variables")
    given = stated_unit(options.columns, "frf:m/s^2/N")
    done = origin(path, "MAT, structs of Simcenter Testlab", options.columns)
    coherence = _coherences(structs)
    found = [
        one
        for name, struct in structs
        if np.iscomplexobj(_values(struct))
        for one in _functions(path, name, struct, coherence, given, options, done)
    ]
    if not found:
        raise FormatError(
            f"{named(path)} holds no complex FRF; export FRFs, not their magnitude"
        )
    require_count(path, len(found), sum(one.frequency.size for one in found))
    return tuple(found)


def _names_its_frfs(content: Struct) -> bool:
    """Return whether variables are complex functions with their axis and labels."""
    if any(np.iscomplexobj(_values(one)) for _, one in _testlab(content)):
        return True
    nodal = nodal_arrays(content)
    return nodal is not None and np.iscomplexobj(nodal.response)


def _read(path: Path) -> dict[str, Any]:
    head = read_head(path, 16)
    return read_mat73(path) if head.startswith(_HDF5) else read_mat5(path)


def _testlab(
    content: Struct, prefix: str = "", depth: int = 0
) -> Iterator[tuple[str, Struct]]:
    """Yield the structs with x_values and y_values, and their names."""
    for name, value in content.items():
        for number, one in enumerate(value if isinstance(value, list) else [value], 1):
            if not isinstance(one, Mapping):
                continue
            own = f"{prefix}{name}" + (f"({number})" if isinstance(value, list) else "")
            if isinstance(one.get("x_values"), Mapping) and isinstance(
                one.get("y_values"), Mapping
            ):
                yield own, one
            elif depth < _DEEPEST:
                yield from _testlab(one, f"{own}.", depth + 1)


def _values(struct: Struct) -> NDArray[Any]:
    """Return the values of a struct, shape (n_lines, n_functions)."""
    values = np.asarray(struct["y_values"].get("values", np.zeros(0)))
    if values.dtype.kind not in "fiuc":
        return np.zeros((0, 1))
    if values.ndim < 2 or 1 in values.shape:
        values = values.reshape(-1, 1)
    lines = _number(struct["x_values"], "number_of_values")
    return values.T if values.shape[0] != lines == values.shape[1] else values


def _functions(
    path: Path,
    name: str,
    struct: Struct,
    coherence: Mapping[tuple[str, str], FloatArray],
    given: FrfColumn | None,
    options: FrfOptions,
    done: Provenance,
) -> Iterator[FrfFunction]:
    values, where = _values(struct), f"struct {shown(name)}"
    unit = unit_of(path, where, _unit(path, where, struct, given), given)
    frequency = _frequencies(path, where, struct)
    for column in range(values.shape[1]):
        output, point = _labels(struct, column)
        raw = RawFrf(
            where,
            frequency,
            values[:, column],
            output or (name if values.shape[1] == 1 else f"{name} {column + 1}"),
            point or options.point,
            {_COHERENCE: coherence.get((output, point)) if output else None},
        )
        yield checked_frf(path, raw, unit, averages=options.averages, provenance=done)


def _unit(path: Path, where: str, struct: Struct, given: FrfColumn | None) -> str:
    """Return the unit of the values; empty where the struct does not state it.

    Raises:
        UnitError: the label is that of a display unit into which a factor leads, so
            that it is not stated which of the two the values have.
    """
    quantity = struct["y_values"].get("quantity")
    if not isinstance(quantity, Mapping):
        return ""
    label = str(quantity.get("label", "")).strip()
    change = quantity.get("unit_transformation")
    factor = _number(change, "factor") if isinstance(change, Mapping) else 1.0
    if np.isclose(factor, 1.0) or not np.isfinite(factor):
        return label
    if given is None:
        raise UnitError(
            f"{named(path)}: {where} has the label {shown(label)} and a factor of "
            f"{factor:g} beside it; state which unit its numbers have, for example "
            "--columns 'frf:m/s^2/N' or 'frf:g/N'"
        )
    return ""


def _frequencies(path: Path, where: str, struct: Struct) -> FloatArray:
    along = struct["x_values"]
    label = ""
    if isinstance(along.get("quantity"), Mapping):
        label = str(along["quantity"].get("label", "")).strip()
    if label.lower() not in ("", "hz"):
        raise UnitError(
            f"{named(path)}: {where}: its x_values are in {shown(label)}, an FRF is "
            "over frequency in Hz; export it over Hz"
        )
    start, increment = (_number(along, n) for n in ("start_value", "increment"))
    count = _values(struct).shape[0]
    claimed = _number(along, "number_of_values")
    if claimed != count or not (np.isfinite(start) and 0.0 < increment < np.inf):
        raise FormatError(
            f"{named(path)}: {where} claims {claimed:g} values from {start:g} Hz in "
            f"steps of {increment:g} Hz and holds {count}; use another copy"
        )
    return np.asarray(start + increment * np.arange(count), np.float64)


def _labels(struct: Struct, column: int) -> tuple[str, str]:
    """Return the labels of output and input, as far as the struct states them."""
    record = struct.get("function_record")
    if not isinstance(record, Mapping):
        return "", ""
    found = [
        _channel(record.get(f"{side}_channel"), column)
        for side in ("primary", "reference")
    ]
    return found[0], found[1]


def _channel(channel: Any, column: int) -> str:
    if isinstance(channel, list):
        channel = channel[column] if column < len(channel) else {}
    if not isinstance(channel, Mapping):
        return ""
    place = channel.get("point_info")
    parts = channel if not isinstance(place, Mapping) else {**channel, **place}
    for name in ("label", "name", "node_id", "id_string"):
        text = parts.get(name)
        if isinstance(text, str) and text.strip():
            return text.strip()
    return ""


def _coherences(
    structs: list[tuple[str, Struct]],
) -> dict[tuple[str, str], FloatArray]:
    """Return coherence by the channels that it is of."""
    found: dict[tuple[str, str], FloatArray] = {}
    for name, struct in structs:
        values, record = _values(struct), struct.get("function_record")
        words = (
            f"{name} {record.get('name', '') if isinstance(record, Mapping) else ''}"
        )
        if _COHERENCE in words.lower() and not np.iscomplexobj(values):
            for column in range(values.shape[1]):
                own = np.asarray(values[:, column], np.float64)
                found[_labels(struct, column)] = own
    return found


def _number(parts: Any, name: str) -> float:
    """Return a number of a struct, NaN where it has none."""
    value = np.asarray(parts.get(name, np.nan))
    if value.size != 1 or value.dtype.kind not in "fiu":
        return float("nan")
    return float(value.ravel()[0])


FORMAT = FrfFormat("mat_frfs", recognise_mat_frfs, read_mat_frfs)
