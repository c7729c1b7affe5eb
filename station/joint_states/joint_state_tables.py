# SPDX-License-Identifier: MIT
"""The CSV files beside a joint file: its table of states, its covariance."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import decode, read_bytes
from jointbench.station.files.toml_file import first_problem
from jointbench.station.schemas.joint_states_model import JointStateTable

_COUNT_DIGITS = 9
"""Longer digit strings are no number of an assembly."""
_SYMMETRY = 1e-9
"""Largest difference across the diagonal over the largest variance: rounding."""


def read_state_table(path: Path) -> tuple[JointStateTable, ...]:
    """Read states from a CSV file with a header of keys and units.

    A column is ``torque:N m``, ``branch``, ``assembly``, ``kn:N/m``, ``kn_sd:%`` and so
    on: the keys are those of a state in TOML, an empty cell is not measured.

    Args:
        path: of the table.

    Raises:
        BadData: a column or cell cannot be used.
    """
    lines = csv_cells(path)
    header = [cell.strip() for cell in lines[0]] if lines else []
    keys = [cell.partition(":")[0].strip() for cell in header]
    units = [cell.partition(":")[2].strip() for cell in header]
    if len(header) == 1 and ";" in header[0]:
        raise BadData(
            f"{named(path)} has semicolons between its cells; write commas between "
            "them, and decimals with a point"
        )
    _check_header(path, keys)
    found = []
    for number, cells in enumerate(lines[1:], 1):
        if len(cells) != len(keys):
            raise BadData(
                f"{named(path)}, row {number}: {len(cells)} cells below {len(keys)} "
                "columns; leave a cell empty where nothing was measured, and write "
                "decimals with a point"
            )
        content = {
            key: _cell(cell.strip(), unit)
            for key, cell, unit in zip(keys, cells, units, strict=True)
            if cell.strip()
        }
        try:
            found.append(JointStateTable.model_validate(content))
        except ValidationError as error:
            problem = first_problem(error, JointStateTable)
            raise BadData(f"{named(path)}, row {number}: {problem}") from error
    if not found:
        raise BadData(
            f"{named(path)} holds no state; write one per line below its header"
        )
    return tuple(found)


def read_covariance(path: Path, n_values: int) -> FloatArray:
    """Read the covariance of the logarithms of all values, shape (n_values, n_values).

    Args:
        path: of a CSV file, one row of the matrix per line.
        n_values: number of values of the joint file.

    Raises:
        BadData: the file is no symmetric matrix of this size.
    """
    try:
        matrix = np.array([[float(cell) for cell in line] for line in csv_cells(path)])
    except ValueError as error:
        raise BadData(
            f"{named(path)} is no table of numbers; write one row of the covariance "
            "per line, separated by commas, decimals with a point"
        ) from error
    if matrix.shape != (n_values, n_values):
        raise BadData(
            f"{named(path)} has the shape {matrix.shape}; the file has {n_values} "
            "values, so it must have as many rows and columns, in their order"
        )
    if not np.all(np.isfinite(matrix)):
        raise BadData(f"{named(path)} holds nan or inf; give a number in each cell")
    if np.abs(matrix - matrix.T).max() > _SYMMETRY * np.abs(matrix).max():
        raise BadData(
            f"{named(path)} is not symmetric; a covariance is: write both triangles"
        )
    return matrix


def csv_cells(path: Path) -> list[list[str]]:
    """Return the cells of all lines that are neither empty nor comments.

    Args:
        path: of a CSV file.

    Raises:
        BadData: the file is no table.
    """
    text, _ = decode(read_bytes(path), path)
    kept = [
        line
        for line in text.splitlines()
        if line.strip() and not line.lstrip().startswith("#")
    ]
    try:
        return list(csv.reader(io.StringIO("\n".join(kept))))
    except csv.Error as error:
        raise BadData(f"{named(path)} is no table in CSV: {error}") from error


def _check_header(path: Path, keys: Sequence[str]) -> None:
    twice = [key for key in dict.fromkeys(keys) if keys.count(key) > 1]
    if twice:
        raise BadData(f"{named(path)} has more than one column {twice[0]!r}; leave one")


def _cell(cell: str, unit: str) -> str | int:
    """Return a cell as TOML would hold it: a word, a count, a number with its unit."""
    if unit:
        return f"{cell} {unit}"
    count = cell.isascii() and cell.isdigit() and len(cell) <= _COUNT_DIGITS
    return int(cell) if count else cell
