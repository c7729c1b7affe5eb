# SPDX-License-Identifier: MIT
"""Heights from plain tables: x and z in columns, or x, y and z of points on a grid."""

import re
from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import (
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.basics.units import is_unit
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.columns import (
    SURFACE_EXAMPLES,
    VALID,
    Column,
    only_roles,
    parse_columns,
)
from jointbench.acquisition.formats.even_steps import fit_even_steps
from jointbench.acquisition.formats.header_units import units_words
from jointbench.acquisition.formats.heights.grid_lines import (
    grid_axis,
    last_line,
    require_single,
)
from jointbench.acquisition.formats.table_cells import split_row
from jointbench.acquisition.formats.tables import Table
from jointbench.acquisition.records.provenance import Provenance, Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface

_LEAST_FILLED = 0.5
_AREAL_COLUMNS = 3
_COUNTERS = frozenset({"index", "no", "no.", "#", "n", "i"})
_FLAGS = frozenset({"valid", "validity", "is valid"})
_HEADER_CELL = re.compile(
    r"(?P<axis>[xyz])\s*(?:in\s+|[\[(/_]+\s*)(?P<unit>[^\])]+?)\s*[\])]?", re.I
)
# A repeated value this far outside the range of all others [range] is taken for the
# code of a missing point.
_FAR_OUTSIDE = 5.0
# Known codes of instruments for a missing point, in any unit.
_KNOWN_CODES = (-25400.0, -25.4, -9999.0, -99999.0, -32768.0, 32767.0, 1e30, -1e30)


def surface_columns(spec: str) -> tuple[Column, ...]:
    """Read ``--columns`` of a table of heights; see `parse_columns`.

    Raises:
        UsageError: x or z is not among them, or something else is.
        UnitError: a unit is missing or is no length.
    """
    columns = parse_columns(spec)
    only_roles(columns, ("x", "y", "z", VALID), "a table of heights")
    spaced = any(column.spacing is not None for column in columns)
    roles = {column.role for column in columns}
    for role in ("x", "z"):
        if role not in roles and not (role == "x" and spaced and "y" not in roles):
            raise UsageError(
                f"--columns {spec!r} names no {role!r}; write for example "
                + " or ".join(repr(example) for example in SURFACE_EXAMPLES)
            )
    if spaced and "x" in roles:
        raise UsageError(
            f"--columns {spec!r} names x and a distance of heights; leave one out"
        )
    return columns


def header_columns(table: Table) -> tuple[Column, ...] | None:
    """Read the columns from a header such as ``x in um,z in um``.

    Args:
        table: as read, with the lines above its numbers.

    Returns:
        The columns; of two lengths without a z, the second is the height. None if a
        unit is missing or the header has another form.
    """
    line = next((text for text in reversed(table.header) if text.strip()), "")
    cells = split_row(line.lstrip("#% "), table.delimiter)
    if len(cells) != table.values.shape[0]:
        return None
    found = [_HEADER_CELL.fullmatch(cell) for cell in cells]
    axes = [match["axis"].lower() for match in found if match]
    columns = []
    for cell, match in zip(cells, found, strict=True):
        if cell.lower() in _COUNTERS:
            columns.append(Column("skip", ""))
            continue
        if cell.lower() in _FLAGS:
            columns.append(Column(VALID, ""))
            continue
        if match is None or not is_unit(match["unit"].strip(), "length"):
            return None
        axis = match["axis"].lower()
        role = "z" if axis == "y" and axes == ["x", "y"] else axis
        columns.append(Column(role, match["unit"].strip()))
    roles = [one.role for one in columns if one.role not in ("skip", VALID)]
    return tuple(columns) if sorted(roles) in (["x", "z"], ["x", "y", "z"]) else None


def surface_from_table(
    table: Table, columns: Sequence[Column] | None, origin: Step, name: str
) -> Surface:
    """Convert a table to a profile or an areal map.

    Args:
        table: as read.
        columns: its columns; None is refused with an example.
        origin: what is known of the file, put first into the provenance.
        name: of the surface.

    Returns:
        A `Profile` where there is no y, or only one; else an `Areal` with x along
        its columns and y along its rows, in whichever order the points were scanned.

    Raises:
        UnitError: `columns` is None.
        FormatError: the number of columns differs, or the points form no grid.
        SamplingError: x is missing or not in even steps.
    """
    if columns is None:
        raise UnitError(_what_to_type(table))
    cells = len(split_row(table.rows[0], table.delimiter)) if table.rows else 0
    if table.values.shape[0] < len(columns) == cells:
        raise FormatError(
            f"{named(table.path)}: column {table.values.shape[0] + 1} "
            f"({columns[table.values.shape[0]].role!r}) holds no value in any row; "
            "export it again, or leave its trailing separator out of --columns"
        )
    if len(columns) != table.values.shape[0]:
        raise FormatError(
            f"{named(table.path)} has {table.values.shape[0]} columns, --columns names "
            f"{len(columns)}; name each, '-' for one that is not wanted"
        )
    place = {column.role: i for i, column in enumerate(columns)}
    for role in {"x", "y"} & place.keys():
        table.require_sane(place[role], columns[place[role]].factor, role)
    absent = _flagged(table, place.get(VALID))
    heights, valid = _heights(table, place["z"], columns[place["z"]], absent)
    provenance = (origin, _describe(table, columns, valid))
    if "x" not in place:
        return Profile(
            name=name,
            heights=heights,
            spacing=_given_spacing(columns),
            valid=valid,
            provenance=provenance,
        )
    if "y" in place:
        return _areal(table, columns, place, heights, valid, provenance, name)
    return _profile(table, columns, place["x"], heights, valid, provenance, name)


def _given_spacing(columns: Sequence[Column]) -> float:
    """Return the distance of heights without x [m]."""
    return next(c.spacing for c in columns if c.spacing is not None)


def _what_to_type(table: Table) -> str:
    count = table.values.shape[0]
    example = SURFACE_EXAMPLES[1 if count == _AREAL_COLUMNS else 0]
    rest = ", with '-' for each of the others" if count > _AREAL_COLUMNS else ""
    return (
        f"{named(table.path)} has {count} columns and {units_words(table)}; "
        f"describe them, for example --columns '{example}'{rest}"
    )


def _describe(table: Table, columns: Sequence[Column], valid: BoolArray) -> Step:
    return step(
        "recognise",
        format="table of heights",
        reason="no known instrument format; columns as given",
        layout=table.layout,
        columns=",".join(f"{c.role}:{c.unit}" for c in columns),
        missing_points=int(np.sum(~valid)),
    )


def _flagged(table: Table, index: int | None) -> BoolArray:
    """Mark the points that a column of 0 and 1 calls no height.

    Raises:
        FormatError: it holds other numbers.
    """
    if index is None:
        return np.zeros(table.values.shape[1], dtype=np.bool_)
    flags = table.values[index]
    other = np.flatnonzero((flags != 0) & (flags != 1))
    if other.size:
        raise FormatError(
            f"{named(table.path)}: {table.where(int(other[0]))}: column {index + 1} "
            f"('{VALID}') holds {flags[other[0]]:g}, which is neither 0 nor 1; write "
            "'-' for it in --columns if it is no mask of heights"
        )
    return np.asarray(flags == 0)


def _heights(
    table: Table, index: int, column: Column, absent: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Return heights [m], 0 where missing, and the mask of those that are there."""
    values = table.values[index]
    missing = np.isnan(values) | absent
    if column.code is not None:
        missing |= values == column.code
    else:
        missing |= _known_codes(np.where(absent, np.nan, values))
        _refuse_unsaid_code(table, values[~missing], column)
    infinite = np.flatnonzero(np.isinf(values) & ~missing)
    if infinite.size:
        raise FormatError(
            f"{named(table.path)}: {table.where(int(infinite[0]))}: height is "
            "infinite; leave the cell of a missing point empty"
        )
    if missing.all():
        raise FormatError(
            f"{named(table.path)}: column {index + 1} ('z') holds no value in any row; "
            "name the column that holds the heights"
        )
    table.require_sane(index, column.factor, "height", skip=missing)
    return np.where(missing, 0.0, values) * column.factor, ~missing


def _known_codes(values: FloatArray) -> BoolArray:
    """Mark values that are a known code and far outside all others."""
    code = np.isin(values, _KNOWN_CODES) | (np.abs(values) >= 1e30)
    others = values[np.isfinite(values) & ~code]
    if others.size < 2 or np.ptp(others) == 0:
        return np.zeros(values.shape, dtype=np.bool_)
    middle, reach = 0.5 * (others.min() + others.max()), np.ptp(others)
    far = np.abs(values - middle) > (0.5 + _FAR_OUTSIDE) * reach
    return np.asarray(code & far & np.isfinite(values))


def _refuse_unsaid_code(table: Table, values: FloatArray, column: Column) -> None:
    """Refuse an undeclared code of a missing point."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return
    for extreme in (finite.min(), finite.max()):
        others = finite[finite != extreme]
        times = finite.size - others.size
        if times < 2 or others.size < 2 or np.ptp(others) == 0:
            continue
        if np.abs(others - extreme).min() > _FAR_OUTSIDE * np.ptp(others):
            raise FormatError(
                f"{named(table.path)}: height {extreme:.9g} stands {times} times far "
                f"outside all others ({others.min():.6g} to {others.max():.6g}); if it "
                f"means a missing point write z:{column.unit}!{extreme:.9g}, if it is "
                f"a height write z:{column.unit}!nan"
            )


def _profile(
    table: Table,
    columns: Sequence[Column],
    index: int,
    heights: FloatArray,
    valid: BoolArray,
    provenance: Provenance,
    name: str,
) -> Profile:
    """Place heights on an even line; rounded x are corrected to length / (n - 1)."""
    x = table.values[index]
    order = slice(None, None, -1 if x[-1] < x[0] else 1)
    last = x.size - 1
    try:
        steps = fit_even_steps(
            x[order],
            what="x",
            unit=columns[index].unit,
            where=lambda i: table.where(last - i if order.step == -1 else i),
            printed=lambda: table.printed_units(index)[order],
        )
    except SamplingError as error:
        raise SamplingError(f"{named(table.path)}: {error}") from error
    return Profile(
        name=name,
        heights=heights[order],
        spacing=steps.step * columns[index].factor,
        valid=valid[order],
        provenance=provenance,
    )


def _areal(
    table: Table,
    columns: Sequence[Column],
    place: dict[str, int],
    heights: FloatArray,
    valid: BoolArray,
    provenance: Provenance,
    name: str,
) -> Surface:
    """Sort points onto the grid that their coordinates form."""
    axes = {role: grid_axis(table, place[role], role) for role in ("y", "x")}
    shape = (axes["y"].count, axes["x"].count)
    if heights.size < _LEAST_FILLED * shape[0] * shape[1]:
        raise FormatError(
            f"{named(table.path)}: {heights.size} points lie on {shape[1]} values of x "
            f"and {shape[0]} of y, which is no filled grid; export the map on a "
            "regular grid, or name the columns in their right order"
        )
    cell = axes["y"].index * shape[1] + axes["x"].index
    require_single(table, cell)
    grid, mask = np.zeros(shape), np.zeros(shape, dtype=np.bool_)
    grid.flat[cell] = heights
    mask.flat[cell] = valid
    spacing = {role: axes[role].step * columns[place[role]].factor for role in axes}
    if 1 in shape:
        along = "x" if shape[0] == 1 else "y"
        return Profile(
            name=name,
            heights=grid.ravel(),
            spacing=spacing[along],
            valid=mask.ravel(),
            provenance=provenance,
        )
    return Areal(
        name=name,
        heights=grid,
        spacing=(spacing["y"], spacing["x"]),
        valid=mask,
        provenance=(
            *provenance,
            step("grid", empty_cells=int(grid.size - cell.size)),
            *last_line(axes["x"].index, axes["y"].index),
        ),
    )
