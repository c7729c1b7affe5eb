# SPDX-License-Identifier: MIT
"""Plain tables of heights as formats: .npy arrays, and texts no other format takes."""

from dataclasses import replace

from jointbench.acquisition.formats.heights.height_facts import LONGEST_TABLE, caution
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.height_tables import (
    header_columns,
    surface_from_table,
)
from jointbench.acquisition.formats.tables import (
    Table,
    is_array_file,
    load_table,
    parse_table,
)
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.surfaces import Surface


def _recognise_array(file: HeightFile) -> bool:
    return is_array_file(file.path)


def _read_array(file: HeightFile) -> Surface:
    wanted = file.columns
    table = load_table(file.path, columns=None if wanted is None else len(wanted))
    return surface_from_table(table, wanted, file.origin, file.label)


def _recognise_text(_: HeightFile) -> bool:
    """Take what no other format takes."""
    return True


def _read_text(file: HeightFile) -> Surface:
    table = parse_table(file.lines, file.path, file.encoding)
    found = header_columns(table) if file.columns is None else file.columns
    surface = surface_from_table(table, found, file.origin, file.label)
    said = _end_of(table, file)
    return replace(surface, provenance=(*surface.provenance, *said))


def _end_of(table: Table, file: HeightFile) -> tuple[Step, ...]:
    """Return a caution where the text ends as one that was cut does.

    A cut exactly at the end of a line leaves no trace in a table of x and z.
    """
    if not (table.open_end or file.half_line_end):
        return ()
    lost = "its last height may lack digits and " if table.open_end else ""
    return (
        caution(
            f"no whole line end follows the last row, {table.where(-1)}: if the file "
            f"was cut there, {lost}rows are lost; compare it with the original"
        ),
    )


ARRAY_FORMAT = HeightFormat(
    "array", _recognise_array, _read_array, with_columns=True, longest=LONGEST_TABLE
)
TEXT_FORMAT = HeightFormat(
    "table", _recognise_text, _read_text, with_columns=True, longest=LONGEST_TABLE
)
