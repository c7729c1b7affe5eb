# SPDX-License-Identifier: MIT
"""Units above the columns of a table: ``time [s];force [N]``, or in a row.

A header is used only if complete: if the unit of one column is missing or ambiguous,
    the user must give all columns.
"""

import re

from jointbench.acquisition.basics.units import is_unit
from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.formats.columns import Column
from jointbench.acquisition.formats.table_cells import split_row
from jointbench.acquisition.formats.tables import Table
from jointbench.acquisition.records.recordings import Quantity

_KINDS = ("time", *(quantity.value for quantity in Quantity), "voltage")
# ``Force [N]``, ``Force (N)``, ``Force in N``, and ``F / N`` as standards write it.
_CELL = re.compile(
    r"(?P<name>[^\[(/]*?)\s*"
    r"(?:[\[(]\s*(?P<bracket>[^\])]+?)\s*[\])]|\bin\s+(?P<word>\S+)|/\s*(?P<slash>\S+))"
)
_NAMED_UNIT = re.compile(r"[^\s\[(]+\s*[\[(][^\])]+[\])]")


def stated_units(table: Table) -> tuple[tuple[str, str], ...]:
    """Return name and unit of each column as the header states them.

    Args:
        table: as read, with the lines above its numbers.

    Returns:
        One pair per column, the unit empty where not stated; empty if the header has
        another number of cells than the table, or no unit.
    """
    lines = [line for line in table.header if line.strip()]
    if not lines:
        return ()
    count, last = table.values.shape[0], _cells(lines[-1], table)
    if len(last) != count:
        return ()
    found = [_CELL.fullmatch(cell) for cell in last]
    pairs = [
        (match["name"].strip(), match["bracket"] or match["word"] or match["slash"])
        if match and (match["bracket"] or match["word"] or match["slash"])
        else (cell, "")
        for cell, match in zip(last, found, strict=True)
    ]
    bare = [cell.strip("[]() ") for cell in last]
    above = _cells(lines[-2], table) if len(lines) > 1 else []
    if all(map(_kinds, bare)) and len(above) == count:  # a row of units below the names
        pairs = list(zip(above, bare, strict=True))
    return tuple(pairs) if any(unit for _, unit in pairs) else ()


def _cells(line: str, table: Table) -> list[str]:
    """Return the cells of a header; if separated by blanks, each with its unit."""
    plain = line.strip().lstrip("#%/ ")
    if table.delimiter is None and "[" in plain + line.replace("(", "["):
        return _NAMED_UNIT.findall(plain)
    return split_row(plain, table.delimiter)


def _kinds(unit: str) -> list[str]:
    return [kind for kind in _KINDS if unit and is_unit(unit, kind)]


def hit_columns_stated(
    table: Table, *, timed: bool = True
) -> tuple[Column, ...] | None:
    """Return the columns of a table of hits, from its header.

    Args:
        table: as read.
        timed: whether a column of times is needed.

    Returns:
        One time and at least one quantity, each column's unit a unit of one of them;
        else None. Channels have the names of the header.
    """
    pairs = stated_units(table)
    columns = []
    for name, unit in pairs:
        kinds = _kinds(unit)
        if len(kinds) != 1 or kinds == ["voltage"]:
            return None
        columns.append(Column(kinds[0], unit, "" if kinds == ["time"] else name))
    roles = [column.role for column in columns]
    labels = [column.label for column in columns if column.role != "time"]
    if (roles.count("time") != 1 and (timed or "time" in roles)) or not labels:
        return None
    if len(set(labels)) != len(labels) or "" in labels:
        columns = [Column(column.role, column.unit) for column in columns]
    return tuple(columns)


def units_words(table: Table) -> str:
    """Describe the units in the header of a table, and what is missing."""
    pairs = stated_units(table)
    if not pairs:
        lines = [line for line in table.header if line.strip()]
        header = f"; its header reads {shown(lines[-1].strip())}" if lines else ""
        return f"does not say their units{header}"
    said = ", ".join(f"{shown(name)} in {shown(unit)}" for name, unit in pairs if unit)
    words = f"says {said}"
    for number, (name, unit) in enumerate(pairs, 1):
        kinds = _kinds(unit)
        if kinds == ["voltage"]:
            return f"{words}; volts need the sensitivity of the sensor"
        if len(kinds) != 1:
            what = f"the unit {shown(unit)} is not known" if unit else "states no unit"
            return f"{words}, but of column {number} ({shown(name)}) {what}"
    return f"{words}; that is not one time and what was measured over it"


def header_names(table: Table) -> tuple[str, ...]:
    """Return the cells of the last header line, one a column; empty where they differ.

    Args:
        table: as read, with the lines above its numbers.
    """
    lines = [line for line in table.header if line.strip()]
    cells = _cells(lines[-1], table) if lines else []
    return tuple(cells) if len(cells) == table.values.shape[0] else ()
