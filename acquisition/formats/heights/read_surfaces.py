# SPDX-License-Identifier: MIT
"""Surfaces from files: the format is recognised by content, the units never guessed."""

from collections.abc import Callable, Sequence
from pathlib import Path

from jointbench.acquisition.file_access.memory_room import count_cells, require_room
from jointbench.acquisition.file_access.text_files import (
    decode,
    file_digest,
    read_bytes,
    text_lines,
)
from jointbench.acquisition.formats.heights.dektak import is_dektak, parse_dektak
from jointbench.acquisition.formats.heights.gwyddion import is_gwyddion, parse_gwyddion
from jointbench.acquisition.formats.heights.height_facts import (
    LONGEST,
    LONGEST_TABLE,
    checked,
)
from jointbench.acquisition.formats.heights.height_tables import (
    header_columns,
    surface_columns,
    surface_from_table,
)
from jointbench.acquisition.formats.heights.interferometers import (
    is_interferometer,
    parse_interferometer,
)
from jointbench.acquisition.formats.heights.keyence import parse_keyence
from jointbench.acquisition.formats.heights.keyence_labels import is_keyence
from jointbench.acquisition.formats.heights.stylus_tables import (
    is_stylus_list,
    parse_stylus_list,
)
from jointbench.acquisition.formats.heights.surfcom import is_surfcom, parse_surfcom
from jointbench.acquisition.formats.heights.vendor_binaries import (
    is_vendor_name,
    read_vendor,
)
from jointbench.acquisition.formats.tables import (
    is_array_file,
    load_table,
    parse_table,
    read_head,
)
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Surface

_Parser = Callable[[Sequence[str], Path, Step, str], Surface]

_PLAIN_BYTES = 512
# What lines and words of a text take for each of its bytes, and heights for each cell.
_TEXT_NEEDED, _CELL_NEEDED = 3.0, 36.0
_TEXTS: tuple[tuple[Callable[[Sequence[str]], bool], _Parser], ...] = (
    (is_dektak, parse_dektak),
    (is_interferometer, parse_interferometer),
    (is_gwyddion, parse_gwyddion),
)


def read_surface(
    path: Path | str, *, columns: str | None = None, name: str | None = None
) -> Surface:
    """Read a profile or an areal map.

    Args:
        path: a Keyence image CSV (English, German, Japanese or Chinese), a Dektak CSV,
            a Surfcom TX1 or TX2, a Wyko, Zygo or Gwyddion text, a plain table of x and
            z, or of x, y and z (text or .npy), or, with the extra ``surfaces``, a
            maker's own format. A Mitutoyo SJ CSV or a Mahr TXT needs `columns` too.
        columns: what the columns of a table hold and in which unit, for example
            ``"x:mm,y:mm,z:um"``, or ``"z:um@0.5um"`` for heights alone; it overrides
            the recognised format. Formats that state their units, and tables with units
            above their columns, do without.
        name: of the surface; the name of the file without its ending if None.

    Returns:
        Heights in metres with a mask of the points that are there. The provenance holds
        the recognised format, its reason, and `cautions`.

    Raises:
        BadData: the file cannot be opened, or is none of these; the subclass and the
            message give reason and remedy.
        UsageError: `columns` names something unknown.
    """
    path = Path(path)
    surface, is_table = _read(path, columns, name)
    return checked(surface, path, longest=LONGEST_TABLE if is_table else LONGEST)


def _read(path: Path, columns: str | None, name: str | None) -> tuple[Surface, bool]:
    """Return the surface as its reader makes it, and whether that was a table."""
    wanted = None if columns is None else surface_columns(columns)
    label = path.stem if name is None else name
    array = is_array_file(path)
    origin = step("import", file=path.name, sha256=file_digest(path))
    if array:
        table = load_table(path, columns=None if wanted is None else len(wanted))
        return surface_from_table(table, wanted, origin, label), True
    if wanted is None and is_vendor_name(path) and not _is_plain(path):
        return read_vendor(path, origin, label), False
    data = read_bytes(path)
    require_room(path, _TEXT_NEEDED * len(data) + _CELL_NEEDED * count_cells(data))
    if wanted is None and is_keyence(data):
        return parse_keyence(data, path, origin, label), False
    text, encoding = decode(data, path)
    del data  # as large as the file, as is the text
    lines = text_lines(text, path)
    del text
    if wanted is None:
        for recognise, parse in _TEXTS:
            if recognise(lines):
                return parse(lines, path, origin, label), False
        if is_surfcom(lines, path):
            return parse_surfcom(lines, path, origin, label), False
    if is_stylus_list(lines) and (wanted is None or len(wanted) == 1):
        column = None if wanted is None else wanted[0]
        return parse_stylus_list(lines, path, origin, label, column), False
    table = parse_table(lines, path, encoding)
    found = header_columns(table) if wanted is None else wanted
    return surface_from_table(table, found, origin, label), True


def _is_plain(path: Path) -> bool:
    """Return whether a file with a vendor suffix is only a table, as .dat often is."""
    head = read_head(path, _PLAIN_BYTES)
    return path.suffix.lower() == ".dat" and b"\x00" not in head
