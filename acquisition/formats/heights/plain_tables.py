# SPDX-License-Identifier: MIT
"""Plain tables of heights as formats: .npy arrays, and texts no other format takes."""

from jointbench.acquisition.formats.heights.height_facts import LONGEST_TABLE
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.height_tables import (
    header_columns,
    surface_from_table,
)
from jointbench.acquisition.formats.tables import (
    is_array_file,
    load_table,
    parse_table,
)
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
    return surface_from_table(table, found, file.origin, file.label)


ARRAY_FORMAT = HeightFormat(
    "array", _recognise_array, _read_array, with_columns=True, longest=LONGEST_TABLE
)
TEXT_FORMAT = HeightFormat(
    "table", _recognise_text, _read_text, with_columns=True, longest=LONGEST_TABLE
)
