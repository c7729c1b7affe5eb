# SPDX-License-Identifier: MIT
"""Read a loop of force over displacement from a CSV file."""

import math
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.file_access.quoting import named
from jointbench.analysis.contact.loops.joint_loop import JointLoop
from jointbench.station.joint_states.joint_state_tables import csv_cells

_COLUMNS = ("displacement", "force")
_EXAMPLE = "displacement:um,force:N"


def read_loop(path: Path) -> JointLoop:
    """Read a loop from a CSV file with a header of names and units.

    The header holds ``displacement:um`` and ``force:N``, in any order and with any unit
    of length and of force; further columns are passed over. One line for each sample,
    in the order in time.

    Args:
        path: of the file.

    Raises:
        BadData: a column, unit or cell cannot be used, or the samples are no loop.
    """
    lines = csv_cells(path)
    header = [cell.strip() for cell in lines[0]] if lines else []
    keys = [cell.partition(":")[0].strip() for cell in header]
    for key in _COLUMNS:
        if keys.count(key) != 1:
            raise BadData(
                f"{named(path)} has {keys.count(key)} columns {key!r}; its first line "
                f"must name the columns with their units, e.g. {_EXAMPLE}"
            )
    places = [keys.index(key) for key in _COLUMNS]
    factors = [
        _factor(path, header[at], key) for at, key in zip(places, _COLUMNS, strict=True)
    ]
    values = _numbers(path, lines[1:], places, len(keys))
    try:
        return JointLoop(values[0] * factors[0], values[1] * factors[1])
    except BadData as error:
        raise BadData(f"{named(path)}: {error}") from error


def _factor(path: Path, cell: str, kind: str) -> float:
    """Return one unit of a column [SI]."""
    unit = cell.partition(":")[2].strip()
    try:
        return parse_value(f"1 {unit}", kind)
    except UnitError as error:
        raise BadData(
            f"{named(path)}, column {cell!r}: {error}; write e.g. {_EXAMPLE}"
        ) from error


def _numbers(
    path: Path, lines: list[list[str]], places: list[int], width: int
) -> FloatArray:
    """Return some columns, shape (n_places, n_lines)."""
    found = np.empty((len(places), len(lines)))
    for number, cells in enumerate(lines, 1):
        if len(cells) != width:
            raise BadData(
                f"{named(path)}, row {number}: {len(cells)} cells below {width} "
                "columns; write commas between cells, and decimals with a point"
            )
        for row, at in enumerate(places):
            found[row, number - 1] = _number(cells[at])
            if not math.isfinite(found[row, number - 1]):
                raise BadData(
                    f"{named(path)}, row {number}: {cells[at].strip()!r} is no "
                    "number; leave lines out that were not measured"
                )
    return found


def _number(cell: str) -> float:
    """Return the number in a cell; NaN for anything else."""
    try:
        return float(cell)
    except ValueError:
        return math.nan
