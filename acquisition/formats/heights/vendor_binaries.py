# SPDX-License-Identifier: MIT
"""Vendor binaries, SDF and X3P through SurfaceTopography, an optional extra.

Its 40 readers are not repeated here; what comes out of them is checked, because the
scale of some of its formats is wrong by orders of magnitude.
"""

import math
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile, UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.even_steps import fit_even_steps
from jointbench.acquisition.formats.heights.height_facts import LONGEST
from jointbench.acquisition.formats.heights.height_format import (
    HeightFile,
    HeightFormat,
)
from jointbench.acquisition.formats.heights.number_grids import masked
from jointbench.acquisition.formats.tables import MAX_CELLS, read_head
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface

MOST_BYTES = 512 * 2**20
_PLAIN_BYTES = 512
_XML = (".xml", ".rels")
_MOST_ENTRIES, _MOST_LINES = 1000, 1_000_000
# Of the XML of a container [bytes]: heights stand beside it, in binary. A reader of XML
# takes a second of CPU time or more for 2 MB of short elements.
_LONGEST_XML = 4_000_000
_NEEDED = 40
"""Of each point: as it is stored, masked, scaled and turned [bytes]."""
SUFFIXES = frozenset(
    ".vk3 .vk4 .vk6 .vk7 .zon .zag .plu .plux .sur .pro .opd .opdx .x3p .sdf .al3d"
    " .dat .datx .nms .nmm .mnt .os3d .lext .oir .poir .frt .gwy .xlsx .tmd .bcr .bcrf"
    " .di .spm .ibw .nid .ezd .stp .top .mi .nc".split()
)


def is_vendor_name(path: Path) -> bool:
    """Recognise by its suffix a file that may have a vendor's format."""
    return path.suffix.lower() in SUFFIXES


def read_vendor(path: Path, origin: Step, name: str) -> Surface:
    """Read the height channel of a vendor file.

    Args:
        path: the file.
        origin: what is known of the file, put first into the provenance.
        name: of the surface.

    Returns:
        A map, or a profile where the file holds a line.

    Raises:
        FormatError: the extra is not installed, no reader knows the file, or what
            it read is no surface.
        UnitError: the file does not state its units.
        HostileFile: it is larger than any map.
    """
    if path.stat().st_size > MOST_BYTES:
        raise HostileFile(f"{named(path)} is larger than {MOST_BYTES} bytes; cut it")
    _require_few_lines(path)
    _require_sane_container(path)
    topography, reader = open_vendor(path)
    unit = topography.unit
    if unit is None:
        raise UnitError(
            f"{named(path)} does not state its unit of length; export it in a format "
            "that does, for example X3P"
        )
    scale = to_si(str(unit).replace("Å", "angstrom"), "length")
    heights = np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan) * scale
    plain, valid = masked(heights, path)
    sizes = [float(size) * scale for size in topography.physical_sizes]
    if not all(0 < size < LONGEST for size in sizes):
        raise FormatError(
            f"{named(path)}: {reader} gives a size of {max(sizes):.3g} m, beyond "
            f"{LONGEST:g} m: its scale is wrong for this file; export it as X3P or text"
        )
    said = step(
        "recognise",
        format=f"{reader} through SurfaceTopography",
        reason=f"{reader} reader accepts it",
        missing_points=int((~valid).sum()),
    )
    return _surface(topography, plain, valid, sizes, scale, (origin, said), name, path)


def _require_few_lines(path: Path) -> None:
    """Refuse a text of more lines than its reader takes in a few seconds.

    Raises:
        HostileFile: it has more.
    """
    lines = 0
    with path.open("rb") as file:
        while piece := file.read(2**20):
            if b"\x00" in piece:
                return  # no text
            lines += piece.count(b"\n")
            if lines > _MOST_LINES:
                raise HostileFile(
                    f"{named(path)} has more than {_MOST_LINES} lines; export it as a "
                    "table of x, y and z"
                )


def _require_sane_container(path: Path) -> None:
    """Refuse a ZIP container (X3P, XLSX, ...) that unpacks to more than a map.

    Raises:
        HostileFile: it does, or its XML is longer than any description.
    """
    try:
        with zipfile.ZipFile(path) as container:
            entries = container.infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, EOFError, OSError):
        return  # no container, or one whose damage the reader reports
    # A parsed XML takes some thirty times its length.
    xml = sum(e.file_size for e in entries if e.filename.lower().endswith(_XML))
    require_room(path, 3 * sum(entry.file_size for entry in entries) + 30 * xml)
    if xml > _LONGEST_XML:
        raise HostileFile(
            f"{named(path)} has {xml / 1e6:.0f} MB of XML, at most "
            f"{_LONGEST_XML / 1e6:.0f} MB are read; export it with binary heights or "
            "as text"
        )
    if len(entries) > _MOST_ENTRIES:
        raise HostileFile(f"{named(path)} holds {len(entries)} files; export it again")


def open_vendor(path: Path) -> tuple[Any, str]:
    """Return the default channel of a file and the name of its format.

    Raises:
        FormatError: the extra is not installed, or no reader knows the file.
        HostileFile: it declares more points than any map.
    """
    try:
        import SurfaceTopography.IO
    except ImportError as error:
        raise FormatError(
            f"{named(path)} looks like a maker's own format, which the extra "
            "'surfaces' reads: pip install 'jointbench[surfaces]'; or export it as text"
        ) from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            reader = SurfaceTopography.IO.open_topography(str(path))
            _require_sane_grid(reader, path)
            name = type(reader).__name__.removesuffix("Reader")
            found = reader.topography()
            # One that maps a file warns when it closes while its heights are in use.
            del reader
        except HostileFile:
            raise
        except Exception as error:
            raise FormatError(
                f"{named(path)} is read by no reader of SurfaceTopography "
                f"({shown(str(error).strip() or type(error).__name__)}); export it as "
                "text or X3P"
            ) from error
    return found, name


def _require_sane_grid(reader: Any, path: Path) -> None:
    """Refuse what declares more points than any map before it is read."""
    grid = reader.channels[0].nb_grid_pts if reader.channels else (0,)
    points = math.prod(float(n) for n in grid)
    if points > MAX_CELLS:
        raise HostileFile(f"{named(path)} declares {grid} points; cut it")
    require_room(path, _NEEDED * points)


def _surface(
    topography: Any,
    heights: FloatArray,
    valid: BoolArray,
    sizes: list[float],
    scale: float,
    provenance: tuple[Step, ...],
    name: str,
    path: Path,
) -> Surface:
    """Make a record; SurfaceTopography counts x first and cells, not gaps."""
    if heights.ndim == 2:
        columns, rows = heights.shape
        return Areal(
            name=name,
            heights=np.ascontiguousarray(heights.T),
            spacing=(sizes[1] / rows, sizes[0] / columns),
            valid=np.ascontiguousarray(valid.T),
            provenance=provenance,
        )
    spacing = sizes[0] / heights.size
    if not topography.is_uniform:
        stamps = np.asarray(topography.positions(), float)
        steps = fit_even_steps(stamps, what="x", unit="", where=lambda i: f"point {i}")
        spacing = steps.step * scale
    if heights.size < 2:
        raise FormatError(f"{named(path)} holds {heights.size} points, no surface")
    return Profile(
        name=name,
        heights=heights,
        spacing=spacing,
        valid=valid,
        provenance=provenance,
    )


def _recognise(file: HeightFile) -> bool:
    return is_vendor_name(file.path) and not _is_plain(file.path)


def _is_plain(path: Path) -> bool:
    """Return whether a file with a maker's ending is but a table, as .dat often is."""
    head = read_head(path, _PLAIN_BYTES)
    return path.suffix.lower() == ".dat" and b"\x00" not in head


def _read_format(file: HeightFile) -> Surface:
    return read_vendor(file.path, file.origin, file.label)


FORMAT = HeightFormat("vendor-binary", _recognise, _read_format)
