# SPDX-License-Identifier: MIT
"""Surfaces from files: the format is recognised by content, the units never guessed."""

from pathlib import Path

from jointbench.acquisition.height_tables import surface_columns, surface_from_table
from jointbench.acquisition.keyence import is_keyence, parse_keyence
from jointbench.acquisition.records import step
from jointbench.acquisition.surfaces import Surface
from jointbench.acquisition.surfcom import is_surfcom, parse_surfcom
from jointbench.acquisition.tables import is_array_file, load_table, parse_table
from jointbench.acquisition.text_files import (
    decode,
    file_digest,
    read_bytes,
    text_lines,
)


def read_surface(
    path: Path | str, *, columns: str | None = None, name: str | None = None
) -> Surface:
    """Read a profile or an areal map.

    Args:
        path: a Keyence image CSV (English), a Surfcom TX1 or TX2, or a plain table of
            x and z, or of x, y and z (text or .npy).
        columns: what the columns of a plain table hold and in which unit, for example
            ``"x:mm,y:mm,z:um"``; formats that state their units do without.
        name: of the surface; the name of the file without its ending if None.

    Returns:
        Heights in metres with a mask of the points that are there. Provenance tells
        what the file was taken for and why.

    Raises:
        BadData: the file cannot be opened, or is none of these; the subclass and the
            message say why and what to do.
        UsageError: `columns` names something unknown.
    """
    path = Path(path)
    wanted = None if columns is None else surface_columns(columns)
    label = path.stem if name is None else name
    array = is_array_file(path)
    origin = step("import", file=path.name, sha256=file_digest(path))
    if array:
        table = load_table(path, columns=None if wanted is None else len(wanted))
        return surface_from_table(table, wanted, origin, label)
    data = read_bytes(path)
    if is_keyence(data):
        return parse_keyence(data, path, origin, label)
    text, encoding = decode(data, path)
    lines = text_lines(text, path)
    if is_surfcom(lines, path):
        return parse_surfcom(lines, path, origin, label)
    return surface_from_table(parse_table(lines, path, encoding), wanted, origin, label)
