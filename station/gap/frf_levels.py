# SPDX-License-Identifier: MIT
"""FRFs as data of `gap`: one level of a TOML file of levels; refused elsewhere."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData, UnitError, UsageError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.columns import Column
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.signal.frf.frf_of_functions import frf_of_functions
from jointbench.station.files.input_files import is_session_name

_TEXTS = (".txt", ".csv", ".tsv", ".asc", ".dat")
"""Tables of complex lines; their columns are those that `lines` names."""


def refuse_frfs(paths: Sequence[Path], model: Path | None) -> None:
    """Refuse files of FRFs, with what to do instead.

    Args:
        paths: that `gap` is given as measurement.
        model: bench model, or None.

    Raises:
        UsageError: one of them holds FRFs.
    """
    for path in paths:
        if is_session_name(path) or not _holds_frfs(path):
            continue
        bench = "MODEL" if model is None else model
        raise UsageError(
            f"{named(path)} holds FRFs: the average of one level, as a linear "
            "structure would have it, so that an effect that depends on level or "
            "preload leaves no trace in it. Give `gap` the hits (`jointbench import`), "
            "or name the file as the lowest of several levels with frf_force "
            f"(docs/gap-records.md); `jointbench identify {bench} {path.name}` fits "
            "the joints of a model to FRFs"
        )


def _holds_frfs(path: Path) -> bool:
    try:
        return bool(read_frfs(path, FrfOptions()))
    except UnitError:
        return True  # FRFs without a unit
    except BadData:
        return False  # the reader of `gap` reports the fault


def read_frf_lines(
    path: Path, columns: str | None, outputs: Sequence[Column]
) -> tuple[FloatArray, list[ComplexArray]] | None:
    """Return the lines of a file of FRFs: frequency and one FRF for each output.

    Args:
        path: a universal, MAT, .npz, .npy or netCDF file.
        columns: what it holds, where it does not say, see `parse_frf_columns`.
        outputs: the responses, by label; a single one needs none.

    Returns:
        Frequency above 0 [Hz], shape (n_lines,), and the FRFs in SI units, shape
        (n_lines,) each; None for tables of text.

    Raises:
        BadData: the file cannot be read, or lacks an output.
        UnitError: a unit is missing; the message names the key to add.
    """
    if path.suffix.lower() in _TEXTS:
        return None
    try:
        functions = read_frfs(path, FrfOptions(columns))
    except UnitError as error:
        raise UnitError(
            f"{error}; in the TOML file frf_columns = '...' of the level"
        ) from error
    if not functions:
        return None
    frf = frf_of_functions(functions)
    if len(frf.inputs) > 1:
        raise BadData(
            f"{named(path)} holds FRFs of the inputs {', '.join(frf.inputs)}; a level "
            "has one force: give the FRFs of one input"
        )
    above = frf.frequency > 0.0
    found = [frf.response[_row(path, functions, frf.outputs, c), 0] for c in outputs]
    return frf.frequency[above], [np.asarray(one[above]) for one in found]


def _row(
    path: Path,
    functions: Sequence[FrfFunction],
    labels: Sequence[str],
    column: Column,
) -> int:
    """Return the row of the output that a column of `lines` names."""
    if functions[0].quantity.value != column.role:
        raise UnitError(
            f"{named(path)} holds FRFs of {functions[0].quantity.value}, lines names "
            f"{column.role}.{column.label}; name what the file holds"
        )
    names = [label.partition("@")[0] for label in labels]
    if column.label in names:
        return names.index(column.label)
    if len(labels) == 1:
        return 0
    raise BadData(
        f"{named(path)} has no output {shown(column.label or column.role)}; it has "
        f"{', '.join(map(shown, labels))}: use these labels in lines"
    )
