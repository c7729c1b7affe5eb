# SPDX-License-Identifier: MIT
"""FRFs from MAT files: structs as Simcenter Testlab exports them, and plain variables.

A struct of Testlab has ``x_values`` (start, increment, number), ``y_values`` (values,
quantity with the label of its unit) and ``function_record`` (names of the channels).
A file that SDynPy saved names its functions itself; see `nodal_arrays`. Plain variables
are named by ``--columns 'frequency.f:Hz,frf.H:m/s^2/N'``.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

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
from jointbench.acquisition.formats.frfs.nodal_arrays import nodal_arrays, nodal_frfs
from jointbench.acquisition.formats.mat_contents import (
    read_mat,
)
from jointbench.acquisition.formats.tables import read_head
from jointbench.acquisition.formats.testlab_structs import (
    Struct,
    struct_axis,
    struct_labels,
    struct_unit,
    struct_values,
    testlab_structs,
)
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.provenance import Provenance

_MATLAB = b"MATLAB 5.0"
_COHERENCE = "coherence"


def recognise_mat_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a MAT file holds FRFs: by --columns, or as structs of Testlab."""
    try:
        head = read_head(path, 128)
        if path.suffix.lower() != ".mat" and not head.startswith(_MATLAB):
            return False
        if names_frfs(options.columns):
            return True
        return options.columns is None and _names_its_frfs(read_mat(path))
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
    content = read_mat(path)
    structs = list(testlab_structs(content))
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
        if np.iscomplexobj(struct_values(struct))
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
    if any(np.iscomplexobj(struct_values(one)) for _, one in testlab_structs(content)):
        return True
    nodal = nodal_arrays(content)
    return nodal is not None and np.iscomplexobj(nodal.response)


def _functions(
    path: Path,
    name: str,
    struct: Struct,
    coherence: Mapping[tuple[str, str], FloatArray],
    given: FrfColumn | None,
    options: FrfOptions,
    done: Provenance,
) -> Iterator[FrfFunction]:
    values, where = struct_values(struct), f"struct {shown(name)}"
    unit = unit_of(path, where, _unit(path, where, struct, given), given)
    frequency = _frequencies(path, where, struct)
    for column in range(values.shape[1]):
        output, point = struct_labels(struct, column)
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
    label, factor = struct_unit(struct)
    if np.isclose(factor, 1.0):
        return label
    if given is None:
        raise UnitError(
            f"{named(path)}: {where} has the label {shown(label)} and a factor of "
            f"{factor:g} beside it; state which unit its numbers have, for example "
            "--columns 'frf:m/s^2/N' or 'frf:g/N'"
        )
    return ""


def _frequencies(path: Path, where: str, struct: Struct) -> FloatArray:
    start, increment, label = struct_axis(path, where, struct)
    if label.lower() not in ("", "hz"):
        raise UnitError(
            f"{named(path)}: {where}: its x_values are in {shown(label)}, an FRF is "
            "over frequency in Hz; export it over Hz"
        )
    count = struct_values(struct).shape[0]
    return np.asarray(start + increment * np.arange(count), np.float64)


def _coherences(
    structs: list[tuple[str, Struct]],
) -> dict[tuple[str, str], FloatArray]:
    """Return coherence by the channels that it is of."""
    found: dict[tuple[str, str], FloatArray] = {}
    for name, struct in structs:
        values, record = struct_values(struct), struct.get("function_record")
        words = (
            f"{name} {record.get('name', '') if isinstance(record, Mapping) else ''}"
        )
        if _COHERENCE in words.lower() and not np.iscomplexobj(values):
            for column in range(values.shape[1]):
                own = np.asarray(values[:, column], np.float64)
                found[struct_labels(struct, column)] = own
    return found


FORMAT = FrfFormat("mat_frfs", recognise_mat_frfs, read_mat_frfs)
