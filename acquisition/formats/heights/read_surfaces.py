# SPDX-License-Identifier: MIT
"""Surfaces from files: the format is recognised by content, the units never guessed."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.registry import Entry, Registry
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.heights import (
    dektak,
    gwyddion,
    interferometers,
    keyence,
    plain_tables,
    stylus_tables,
    surfcom,
    vendor_binaries,
)
from jointbench.acquisition.formats.heights.height_facts import checked
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.height_tables import surface_columns
from jointbench.acquisition.formats.package_formats import added_by, matching_format
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface


def _built_in() -> tuple[HeightFormat, ...]:
    """Return the formats in the order in which they look at a file.

    Those that look at the path come first, then bytes, then lines; a table is what
    is left.
    """
    return (
        plain_tables.ARRAY_FORMAT,
        vendor_binaries.FORMAT,
        keyence.FORMAT,
        dektak.FORMAT,
        interferometers.FORMAT,
        gwyddion.FORMAT,
        surfcom.FORMAT,
        stylus_tables.FORMAT,
        plain_tables.TEXT_FORMAT,
    )


HEIGHT_FORMATS = Registry(
    "jointbench.height_formats", "height format", HeightFormat, _built_in
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
            Formats of other packages take precedence.
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
        UsageError: `columns` names something unknown, or two packages take the file.
    """
    path = Path(path)
    wanted = None if columns is None else surface_columns(columns)
    label = path.stem if name is None else name
    origin = step("import", file=path.name, sha256=file_digest(path))
    file = HeightFile(path, label, origin, wanted)
    entry = matching_format(
        HEIGHT_FORMATS.entries(), lambda format_: format_.takes(file), path
    )
    assert entry is not None, "a table takes what is left"
    return checked(_read(entry, file), path, longest=entry.value.longest)


def _read(entry: Entry[HeightFormat], file: HeightFile) -> Surface:
    with entry.running(FormatError):
        found = entry.value.read(file)
        if entry.built_in:
            return found
        if not isinstance(found, Profile | Areal):
            raise TypeError("read must return a Profile or an Areal")
    origin = added_by(entry, file.path)
    return replace(found, provenance=(origin, *found.provenance))
