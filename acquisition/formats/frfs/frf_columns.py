# SPDX-License-Identifier: MIT
"""What each column or variable of a file of FRFs holds, as typed after --columns.

The grammar, one item a column, joined by commas::

    role[.label]:unit

    frequency:Hz,real:m/s^2/N,imaginary:m/s^2/N
    frequency:Hz,magnitude:g/N,phase:deg,coherence
    frequency:Hz,real.2z/1z:um/N,imaginary.2z/1z:um/N    output 2z, input 1z
    frequency.f:Hz,frf.H:m/s^2/N,variance.V:(m/s^2/N)^2  variables f, H, V of a file
    frf:m/s^2/N@0.5Hz                                    complex lines 0.5 Hz apart
    frf:g/N                                              unit of FRFs without one
"""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import inf, pi

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.basics.units import parse_value, to_si
from jointbench.acquisition.formats.columns import SKIP
from jointbench.acquisition.formats.frfs.frf_units import EXAMPLES, parse_frf_unit
from jointbench.acquisition.records.recordings import Quantity

FREQUENCY, COMPLEX, REAL, IMAGINARY = "frequency", "frf", "real", "imaginary"
MAGNITUDE, PHASE, COHERENCE = "magnitude", "phase", "coherence"
VARIANCE, DEVIATION = "variance", "sd"
MOTION_ROLES = (COMPLEX, REAL, IMAGINARY, MAGNITUDE, VARIANCE, DEVIATION)
ROLES = (FREQUENCY, *MOTION_ROLES, PHASE, COHERENCE)
TABLE_EXAMPLE = "frequency:Hz,real:m/s^2/N,imaginary:m/s^2/N"
_ANGLES = {"deg": pi / 180.0, "rad": 1.0, "°": pi / 180.0}
_DECIBEL = "dB re "


@dataclass(frozen=True, slots=True)
class FrfColumn:
    """One column of a table of FRFs, or one variable of a file.

    Attributes:
        role: one of `ROLES`, or ``"skip"``.
        label: degrees of freedom ``"output/input"``, or name of the variable.
        unit: as typed.
        quantity: that the response measures, of the roles with the unit of an FRF.
        factor: leads to SI; of a variance, to its SI unit.
        decibel: whether the numbers are 20 log10 of the magnitude.
        spacing: distance of the lines [Hz] of an FRF without frequencies, or None.
    """

    role: str
    label: str = ""
    unit: str = ""
    quantity: Quantity | None = None
    factor: float = 1.0
    decibel: bool = False
    spacing: float | None = None


def names_frfs(columns: str | None) -> bool:
    """Return whether what follows --columns is about FRFs; nothing is checked."""
    if columns is None:
        return False
    roles = {i.strip().partition(":")[0].partition(".")[0] for i in columns.split(",")}
    return FREQUENCY in roles or COMPLEX in roles


def names_frequency(columns: str | None) -> bool:
    """Return whether --columns names arrays, rather than the unit alone."""
    return columns is not None and any(
        column.role == FREQUENCY or column.label or column.spacing
        for column in parse_frf_columns(columns)
    )


def parse_frf_columns(columns: str) -> tuple[FrfColumn, ...]:
    """Read what the user typed after ``--columns`` for a file of FRFs.

    Args:
        columns: see the grammar at the top of this module.

    Raises:
        UsageError: a role is unknown, or a frequency is named twice.
        UnitError: a unit is missing or unknown, or units of different quantities.
    """
    found = tuple(_item(item.strip()) for item in columns.split(","))
    if sum(column.role == FREQUENCY for column in found) > 1:
        raise UsageError(
            f"--columns {columns!r} names the frequency twice; name it once"
        )
    kinds = {column.quantity for column in found if column.quantity is not None}
    if len(kinds) > 1:
        raise UnitError(
            f"--columns {columns!r} has FRFs of {', '.join(sorted(kinds))}; all FRFs "
            "must be of one quantity"
        )
    return found


def stated_unit(columns: str | None, example: str) -> FrfColumn | None:
    """Return the unit that --columns states for FRFs that a file names itself.

    Args:
        columns: ``"frf:g/N"``, or None.
        example: what to type, for the message.

    Raises:
        UsageError: it states more than one column, or no FRF.
    """
    if columns is None:
        return None
    found = parse_frf_columns(columns)
    if len(found) != 1 or found[0].role != COMPLEX or found[0].label:
        raise UsageError(
            f"--columns {columns!r}: this file names its FRFs itself; state the unit "
            f"alone, for example --columns '{example}'"
        )
    return found[0]


def one_frequency(columns: Sequence[FrfColumn], text: str) -> FrfColumn:
    """Return the column of the frequency.

    Raises:
        UsageError: there is none.
    """
    for column in columns:
        if column.role == FREQUENCY:
            return column
    raise UsageError(
        f"--columns {text!r} names no frequency; write for example '{TABLE_EXAMPLE}'"
    )


def _item(item: str) -> FrfColumn:
    if item in ("-", "_", SKIP):
        return FrfColumn(SKIP)
    head, _, tail = item.partition(":")
    role, _, label = head.partition(".")
    unit, _, given = tail.partition("@")
    role, label, unit = role.strip(), label.strip(), unit.strip()
    if role not in ROLES:
        near = get_close_matches(role, ROLES, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise UsageError(
            f"column {item!r} is none of {', '.join(ROLES)} or '-'{hint}; write for "
            f"example '{TABLE_EXAMPLE}'"
        )
    spacing = _spacing(item, role, given.strip())
    try:
        return _with_unit(role, label, unit, spacing)
    except UnitError as error:
        raise UnitError(f"column {item!r}: {error}") from error


def _with_unit(role: str, label: str, unit: str, spacing: float | None) -> FrfColumn:
    if role in MOTION_ROLES:
        decibel = role == MAGNITUDE and unit.startswith(_DECIBEL)
        bare = unit.removeprefix(_DECIBEL) if decibel else unit
        bare = _square_root(bare) if role == VARIANCE else bare
        if not bare:
            raise UnitError(f"no unit is given; write one of {EXAMPLES}")
        quantity, factor = parse_frf_unit(bare)
        factor = factor**2 if role == VARIANCE else factor
        return FrfColumn(role, label, unit, quantity, factor, decibel, spacing)
    if role == PHASE:
        if unit not in _ANGLES:
            raise UnitError(f"{unit!r} is no unit of an angle; write deg or rad")
        return FrfColumn(role, label, unit, factor=_ANGLES[unit])
    kind = "frequency" if role == FREQUENCY else "ratio"
    return FrfColumn(role, label, unit, factor=to_si(unit, kind))


def _square_root(unit: str) -> str:
    """Return the unit whose square a variance has."""
    for mark in ("^2", "²", "**2"):
        if unit.startswith("(") and unit.endswith(f"){mark}"):
            return unit[1 : -len(mark) - 1]
    raise UnitError(
        f"{unit!r} is no unit of a variance; write the square of that of the FRF, "
        "for example (m/s^2/N)^2"
    )


def _spacing(item: str, role: str, given: str) -> float | None:
    if not given:
        return None
    spacing = parse_value(given, "frequency")
    if role != COMPLEX or not 0.0 < spacing < inf:
        raise UnitError(
            f"column {item!r}: after '@' stands the distance of the lines of an FRF "
            "without frequencies, above zero; write for example frf:m/s^2/N@0.5Hz"
        )
    return spacing
