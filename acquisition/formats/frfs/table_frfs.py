# SPDX-License-Identifier: MIT
"""FRFs from tables: a column for the frequency, two for each FRF, units in the header.

Where the header does not state the units, ``--columns`` does. A list of complex
numbers, ``(1.5+0.2j)`` a line, needs the distance of its lines: ``frf:m/s^2/N@1Hz``.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import (
    decode,
    read_bytes,
    text_lines,
)
from jointbench.acquisition.formats.frfs.checked_frf import (
    RawFrf,
    checked_frf,
    origin,
)
from jointbench.acquisition.formats.frfs.frf_columns import (
    COHERENCE,
    COMPLEX,
    DEVIATION,
    FREQUENCY,
    IMAGINARY,
    MAGNITUDE,
    PHASE,
    REAL,
    TABLE_EXAMPLE,
    VARIANCE,
    FrfColumn,
    names_frfs,
    one_frequency,
    parse_frf_columns,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.header_units import stated_units
from jointbench.acquisition.formats.tables import Table, load_table, read_head
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.recordings import Quantity

_HEAD = 4000
_TEXT_SUFFIXES = (".txt", ".csv", ".tsv", ".asc", ".dat", ".frf")
_NAMES = (
    ("freq", FREQUENCY),
    ("re", REAL),
    ("im", IMAGINARY),
    ("mag", MAGNITUDE),
    ("abs", MAGNITUDE),
    ("amp", MAGNITUDE),
    ("ph", PHASE),
    ("ang", PHASE),
    ("coh", COHERENCE),
)
"""First letters of a heading, and the role of its column."""


def recognise_table_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a table holds FRFs: by --columns, or by its own header."""
    if options.columns is not None:
        return names_frfs(options.columns)
    if path.suffix.lower() not in _TEXT_SUFFIXES:
        return False
    try:
        if b"hz" not in read_head(path, _HEAD).replace(b"\0", b"").lower():
            return False
        return bool(_stated(load_table(path)))
    except BadData:
        return False


def read_table_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a table.

    Args:
        path: delimited text or a .npy file of real numbers.
        options: see `FrfOptions`.

    Raises:
        UnitError: a unit is missing.
        UsageError: `columns` names an FRF by half, or does not fit the table.
        BadData: see `load_table` and `checked_frf`.
    """
    columns = () if options.columns is None else parse_frf_columns(options.columns)
    if len(columns) == 1 and columns[0].role == COMPLEX:
        return (_complex_list(path, columns[0], options),)
    table = load_table(path, columns=len(columns) or None)
    columns = columns or _stated(table)
    if not columns:
        raise UnitError(
            f"{named(path)} states no units; state them, --columns '{TABLE_EXAMPLE}'"
        )
    if len(columns) != table.values.shape[0]:
        raise FormatError(
            f"{named(path)} has {table.values.shape[0]} columns, --columns names "
            f"{len(columns)}; name each, '-' for one that is not wanted"
        )
    text = options.columns or ""
    along = one_frequency(columns, text)
    frequency = table.values[columns.index(along)] * along.factor
    done = origin(path, table.layout, options.columns)
    return tuple(
        checked_frf(path, raw, unit, averages=options.averages, provenance=done)
        for raw, unit in _functions(table, columns, frequency, options)
    )


def _functions(
    table: Table,
    columns: Sequence[FrfColumn],
    frequency: FloatArray,
    options: FrfOptions,
) -> Iterator[tuple[RawFrf, tuple[Quantity, float]]]:
    """Yield each FRF of a table in SI units, with its quantity."""
    for label in dict.fromkeys(c.label for c in columns if c.role in _OF_ONE):
        own = {
            column.role: (column, values)
            for column, values in zip(columns, table.values, strict=True)
            if column.label == label and column.role in _OF_ONE
        }
        response, quantity = _response(own, label)
        output, _, point = label.partition("/")
        where = f"FRF {shown(label)}" if label else "its FRF"
        noise = _noise(own)
        raw = RawFrf(
            where, frequency, response, output, point or options.point, noise=noise
        )
        yield raw, (quantity, 1.0)


_OF_ONE = (REAL, IMAGINARY, MAGNITUDE, PHASE, COHERENCE, VARIANCE, DEVIATION)
_Own = Mapping[str, tuple[FrfColumn, FloatArray]]


def _response(own: _Own, label: str) -> tuple[ComplexArray, Quantity]:
    """Return a complex FRF in SI from two columns.

    Raises:
        UsageError: one of the two is not there.
    """
    for first, second in ((REAL, IMAGINARY), (MAGNITUDE, PHASE)):
        if first in own and second in own:
            one, other = _si(own, first), _si(own, second)
            quantity = own[first][0].quantity
            assert quantity is not None
            turned = one + 1j * other if first == REAL else one * np.exp(1j * other)
            return np.asarray(turned, np.complex128), quantity
    name = f" of {label!r}" if label else ""
    raise UsageError(
        f"--columns names {', '.join(own)}{name}; an FRF has real and imaginary, or "
        f"magnitude and phase: '{TABLE_EXAMPLE}'"
    )


def _si(own: _Own, role: str) -> FloatArray:
    column, values = own[role]
    with np.errstate(over="ignore"):
        plain = 10.0 ** (values / 20.0) if column.decibel else values
        return np.asarray(plain * column.factor)


def _noise(own: _Own) -> dict[str, FloatArray | None]:
    noise: dict[str, FloatArray | None] = {
        role: _si(own, role) for role in (COHERENCE, VARIANCE) if role in own
    }
    if DEVIATION in own:
        noise[VARIANCE] = _si(own, DEVIATION) ** 2
    return noise


def _stated(table: Table) -> tuple[FrfColumn, ...]:
    """Return the columns as the header states them; none where it does not."""
    items = []
    for name, unit in stated_units(table):
        role = next((r for b, r in _NAMES if name.lower().startswith(b)), "-")
        if role == "-" or (not unit and role != COHERENCE):
            return ()
        items.append(f"{role}:{unit}")
    try:
        found = parse_frf_columns(",".join(items)) if items else ()
    except (UnitError, UsageError):
        return ()
    roles = {column.role for column in found}
    whole = {REAL, IMAGINARY} <= roles or {MAGNITUDE, PHASE} <= roles
    return found if whole and FREQUENCY in roles else ()


def _complex_list(path: Path, column: FrfColumn, options: FrfOptions) -> FrfFunction:
    """Read a list of complex numbers, one a line."""
    if column.spacing is None or column.quantity is None:
        raise UsageError(
            f"{named(path)}: a list of complex numbers has no frequencies; state the "
            f"distance of its lines, for example --columns 'frf:{column.unit}@1Hz'"
        )
    text, encoding = decode(read_bytes(path), path)
    values = []
    for number, line in enumerate(text_lines(text, path), 1):
        if line.strip():
            try:
                values.append(complex(line.strip().replace(" ", "").replace("i", "j")))
            except ValueError as error:
                raise FormatError(
                    f"{named(path)}: line {number}: {shown(line.strip())} is no "
                    "complex number; write one a line, (1.5+0.2j)"
                ) from error
    lines: FloatArray = np.asarray(column.spacing * np.arange(len(values)), np.float64)
    raw = RawFrf("its FRF", lines, np.array(values, complex), "", options.point)
    unit = column.quantity, column.factor
    done = origin(path, f"complex numbers, {encoding}", options.columns)
    return checked_frf(path, raw, unit, averages=options.averages, provenance=done)


FORMAT = FrfFormat("table_frfs", recognise_table_frfs, read_table_frfs)
