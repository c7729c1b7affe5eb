# SPDX-License-Identifier: MIT
"""Columns of a plain table, from the option --columns.

The grammar, one item a column, joined by commas::

    role[.label][@point]:[-]unit[@sensitivity][!code]

    time:s,force:N,acceleration:m/s^2
    time:ms,force:V@2.248mV/N,acceleration.a1@3:V@10mV/g,acceleration.a2@4:V@10mV/g
    x:mm,y:mm,z:um!-25400       heights where -25400 means "no point here"
    time:s,-,force:N            a column that is not wanted
    z:um@0.5um                  heights alone, 0.5 um apart
    x:um,z:um,valid             0 in the last column where the height is none, else 1
    force:-N                    numbers that count the other way round
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.basics.units import (
    example_unit,
    is_unit,
    parse_sensitivity,
    parse_value,
    to_si,
)
from jointbench.acquisition.records.recordings import Quantity

SKIP = "skip"
VALID = "valid"
HITS_EXAMPLE = "time:s,force:N,acceleration:m/s^2"
SURFACE_EXAMPLES = ("x:um,z:um", "x:mm,y:mm,z:um")
_KINDS = {"time": "time", "x": "length", "y": "length", "z": "length"} | {
    quantity.value: quantity.value for quantity in Quantity.mechanical()
}
_SENSITIVITIES = {
    "force": "2.25mV/N",
    "acceleration": "10mV/g",
    "velocity": "4V/(m/s)",
    "displacement": "8mV/um",
}
_ITEM = re.compile(
    r"(?P<role>[^.@:]*)(?:\.(?P<label>[^@:]+))?(?:@(?P<point>[^:]+))?"
    r"(?::(?P<unit>[^@!]*)(?:@(?P<sensitivity>[^!]+))?(?:!(?P<code>.+))?)?"
)


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a plain table.

    Attributes:
        role: ``"time"``, a `Quantity`, ``"x"``, ``"y"``, ``"z"``, ``"valid"`` or
            ``"skip"``.
        unit: as typed, known to fit the role; empty for the last two.
        label: name of the channel; empty if not given.
        point: where the sensor sits; empty if not given.
        sensitivity: [V per SI unit] where the unit is a voltage, else None.
        code: code of a missing value [unit], or None.
        spacing: distance of neighbouring heights [m], of a column z without x, or None.
        sign: -1.0 where the numbers count the other way round, else 1.0.
    """

    role: str
    unit: str
    label: str = ""
    point: str = ""
    sensitivity: float | None = None
    code: float | None = None
    spacing: float | None = None
    sign: float = 1.0

    @property
    def factor(self) -> float:
        """Factor from the numbers of the column to SI."""
        if self.role in (SKIP, VALID):
            return 1.0
        if self.sensitivity is not None:
            return self.sign * to_si(self.unit, "voltage") / self.sensitivity
        return self.sign * to_si(self.unit, _KINDS[self.role])


def parse_columns(spec: str) -> tuple[Column, ...]:
    """Parse the option ``--columns``.

    Args:
        spec: see the grammar at the top of this module.

    Returns:
        One `Column` for each column of the table, in order.

    Raises:
        UsageError: a role is unknown, or appears twice where it may not.
        UnitError: a unit is missing, unknown, of another quantity, or a voltage
            without the sensitivity of the sensor.
    """
    columns = tuple(_parse_item(item.strip()) for item in spec.split(","))
    for role in ("time", "x", "y", "z", VALID):
        if sum(column.role == role for column in columns) > 1:
            raise UsageError(
                f"--columns {spec!r} names {role!r} more than once; write '-' for "
                "a column that is not wanted"
            )
    return columns


def only_roles(columns: Sequence[Column], allowed: Sequence[str], what: str) -> None:
    """Raise `UsageError` if a column has a role that `what` does not support."""
    for column in columns:
        if column.role != SKIP and column.role not in allowed:
            raise UsageError(
                f"--columns names {column.role!r}, which {what} does not have; it has "
                f"{', '.join(allowed)}; write '-' for a column that is not wanted"
            )


def _parse_item(item: str) -> Column:
    if item in ("-", "_", SKIP):
        return Column(SKIP, "")
    if item == VALID:
        return Column(VALID, "")
    match = _ITEM.fullmatch(item)
    role = match["role"].strip() if match else item
    if match is None or role not in _KINDS:
        raise UsageError(_unknown_role(item, role))
    if not (match["unit"] or "").strip():
        raise UnitError(
            f"column {item!r} has no unit; write for example "
            f"{item.rstrip(':')}:{example_unit(_KINDS[role])}"
        )
    unit = match["unit"].strip()
    reversed_ = unit.startswith("-") and role in tuple(Quantity)
    unit = unit[1:].strip() if reversed_ else unit
    return Column(
        role=role,
        unit=unit,
        label=(match["label"] or "").strip(),
        point=(match["point"] or "").strip(),
        sensitivity=None
        if role == "z"
        else _sensitivity(item, role, unit, match["sensitivity"]),
        code=_code(item, match["code"]),
        spacing=_spacing(item, unit, match["sensitivity"]) if role == "z" else None,
        sign=-1.0 if reversed_ else 1.0,
    )


def _unknown_role(item: str, role: str) -> str:
    near = get_close_matches(role, _KINDS, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return (
        f"column {item!r} is none of {', '.join(_KINDS)} or '-'{hint}; "
        f"write for example '{HITS_EXAMPLE}'"
    )


def _sensitivity(item: str, role: str, unit: str, given: str | None) -> float | None:
    """Return the sensitivity, after checking that the unit fits the role."""
    kind = _KINDS[role]
    if not (kind in tuple(Quantity) and is_unit(unit, "voltage")):
        _require_unit(item, unit, kind)
        if given is not None:
            raise UnitError(
                f"column {item!r} gives a sensitivity, but {unit.strip()!r} is not a "
                f"voltage; write {role}:{unit.strip()} or {role}:V@{given.strip()}"
            )
        return None
    if given is None:
        raise UnitError(
            f"column {item!r} is in volts; give the sensitivity of the sensor, for "
            f"example {role}:{unit.strip()}@{_SENSITIVITIES[role]}"
        )
    try:
        return parse_sensitivity(given, kind)
    except UnitError as error:
        raise UnitError(f"column {item!r}: {error}") from error


def _spacing(item: str, unit: str, given: str | None) -> float | None:
    """Return the distance of heights [m], after checking their unit."""
    _require_unit(item, unit, "length")
    if given is None:
        return None
    try:
        spacing = parse_value(given, "length")
    except UnitError as error:
        raise UnitError(f"column {item!r}: {error}") from error
    if not 0 < spacing < 1:
        raise UnitError(
            f"column {item!r}: a distance of {given.strip()!r} between heights must be "
            "above zero and below a metre; write for example z:um@0.5um"
        )
    return spacing


def _require_unit(item: str, unit: str, kind: str) -> None:
    try:
        to_si(unit, kind)
    except UnitError as error:
        raise UnitError(f"column {item!r}: {error}") from error


def _code(item: str, text: str | None) -> float | None:
    if text is None:
        return None
    try:
        return float(text)
    except ValueError as error:
        raise UsageError(
            f"column {item!r}: after '!' stands the number that means a missing "
            f"point, got {text!r}; write for example z:um!-25400"
        ) from error
