# SPDX-License-Identifier: MIT
"""What the columns of a file probably hold: a proposal, to be confirmed.

Names and units of the file count first, then the shape of the numbers: times ascend in
even steps, a force is a short pulse, a response rings down. What nothing shows (the
unit of an acceleration) is marked as assumed.
"""

import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import is_unit
from jointbench.signal.hits.plausibility import (
    PULSE_SHARE,
    active_share,
    points_down,
)
from jointbench.station.guess.raw_columns import RawColumn, RawFile

ASSUMED = "assumed"
_NAMES = (
    ("time", r"t|time|times|zeit|temps|tempo|abscissa|sec|seconds"),
    ("force", r"f\d*|force|kraft|hammer|impact|load|forza|exc\w*|input|fz|fx|fy"),
    ("velocity", r"v\d*|vel\w*|geschw\w*"),
    ("displacement", r"d\d*|u\d*|disp\w*|weg|verschieb\w*"),
    ("acceleration", r"a\d*|acc\w*|beschl\w*|resp\w*|output|ax|ay|az"),
)
_QUANTITIES = ("force", "acceleration", "velocity", "displacement")
_UNITS = {"force": "N", "acceleration": "m/s^2", "velocity": "m/s"} | {
    "displacement": "m"
}
_TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_USUAL_PULSE = 1e-3
"""[s] at half height: between those of a hard and a soft tip."""
_RATES = (300.0, 300_000.0)
"""[Hz]: of hammer tests; the range is one unit of time wide."""
_EVEN = 0.02


@dataclass(frozen=True, slots=True)
class ProposedColumn:
    """What one column probably holds.

    Attributes:
        name: in the file.
        item: of ``--columns``; ``"-"`` for a column that is not wanted.
        reason: what it was concluded from; begins with `ASSUMED` where by nothing.
    """

    name: str
    item: str
    reason: str


@dataclass(frozen=True, slots=True)
class ColumnProposal:
    """Options of an import, to be confirmed.

    Attributes:
        columns: what follows ``--columns``; None where the file states everything.
        rate: sample rate of samples without times [Hz], or None.
        rate_reason: where the rate comes from; empty where there are times.
        items: the columns one by one.
    """

    columns: str | None
    rate: float | None
    rate_reason: str
    items: tuple[ProposedColumn, ...]


def propose(raw: RawFile, rate: float | None = None) -> ColumnProposal:
    """Propose roles, units and rate of the columns of a file.

    Args:
        raw: the columns.
        rate: as the user gave it [Hz], or None.

    Returns:
        The proposal; its rate is None where there is a column of times, or where
        nothing states it.
    """
    roles = [_role_by_name(column) for column in raw.columns]
    force = _force(raw.columns, roles)
    time = _time(raw.columns, roles)
    pulse = None if force is None else _width(raw.columns[force].values)
    items = []
    for index, column in enumerate(raw.columns):
        if index == time:
            found = _time_item(column, pulse)
        elif index == force:
            found = _force_item(column, roles[index])
        else:
            found = _other_item(column, roles[index])
        items.append(found)
    wanted = [_labelled(one, raw) for one in items]
    text = ",".join(one for one in wanted if one)
    if time is not None:
        return ColumnProposal(text, None, "", tuple(items))
    stated = rate if rate is not None else raw.rate
    reason = "--rate" if rate is not None else raw.rate_words
    return ColumnProposal(
        text, stated, reason or "not stated: pass --rate", tuple(items)
    )


def _labelled(one: ProposedColumn, raw: RawFile) -> str:
    """Return an item of ``--columns``; archives name their arrays by label."""
    if not raw.named:
        return one.item
    role, _, unit = one.item.partition(":")
    return "" if one.item == "-" else f"{role}.{one.name}:{unit}"


def _role_by_name(column: RawColumn) -> str:
    """Return the role that unit or name of a column state; empty without one."""
    unit = column.unit
    kinds = [k for k in ("time", *_QUANTITIES) if unit and is_unit(unit, k)]
    if len(kinds) == 1:
        return kinds[0]
    first = re.split(r"[^A-Za-z0-9]+", column.name.rpartition(".")[2].strip().lower())
    for role, pattern in _NAMES:
        if first and re.fullmatch(pattern, first[0]):
            return role
    return ""


def _time(columns: tuple[RawColumn, ...], roles: list[str]) -> int | None:
    """Return the column of times: even steps, by name or by small steps."""
    even = [i for i, one in enumerate(columns) if _is_even(one.values)]
    by_name = [i for i in even if roles[i] == "time"]
    small = [i for i in even if not roles[i] and not _counts(columns[i].values)]
    found = by_name or small
    return found[0] if found else None


def _is_even(values: FloatArray) -> bool:
    steps = np.diff(values)
    if steps.size < 2 or not np.isfinite(steps).all() or not (steps > 0).all():
        return False
    return bool(np.ptp(steps) < 2 * _EVEN * steps.mean() + 1e-6 * abs(values[-1]))


def _counts(values: FloatArray) -> bool:
    """Return whether a column only counts its rows."""
    return bool(np.all(np.diff(values) == 1.0))


def _force(columns: tuple[RawColumn, ...], roles: list[str]) -> int | None:
    named = [i for i, role in enumerate(roles) if role == "force"]
    if named:
        return named[0]
    open_ = [
        (active_share(one.values), i)
        for i, one in enumerate(columns)
        if not roles[i] and np.isfinite(one.values).all() and not _is_even(one.values)
    ]
    if not open_ or min(open_)[0] >= PULSE_SHARE:
        return None
    return min(open_)[1]


def _width(values: FloatArray) -> float:
    """Return the samples for which the largest pulse exceeds half its peak."""
    plain = np.abs(values - np.median(values))
    at = int(np.argmax(plain))
    low = np.flatnonzero(plain < 0.5 * plain[at])
    sides = [int(i) for pair in pairwise(low) for i in pair if pair[0] < at < pair[1]]
    return float(sides[-1] - sides[0] - 1) if sides else 1.0


def _time_item(column: RawColumn, pulse: float | None) -> ProposedColumn:
    name = column.name
    if is_unit(column.unit, "time"):
        return ProposedColumn(name, f"time:{column.unit}", "unit of the file")
    step = float(np.diff(column.values).mean())
    if pulse is not None:
        away = {
            unit: abs(np.log(pulse * step * factor / _USUAL_PULSE))
            for unit, factor in _TIMES.items()
        }
        unit = min(away, key=lambda one: away[one])
        width = 1e3 * pulse * step * _TIMES[unit]
        words = f"even steps; in {unit} the force pulse lasts {width:.2g} ms"
        return ProposedColumn(name, f"time:{unit}", words)
    fits = [u for u, f in _TIMES.items() if _RATES[0] <= 1 / (step * f) <= _RATES[1]]
    unit = fits[0] if fits else "s"
    rate = 1 / (step * _TIMES[unit])
    return ProposedColumn(name, f"time:{unit}", f"even steps; {rate:.6g} Hz in {unit}")


def _force_item(column: RawColumn, role: str) -> ProposedColumn:
    sign = "-" if points_down(column.values) else ""
    by = "name or unit of the file" if role else "the shortest pulse"
    turned = "; its pulses are negative" if sign else ""
    if is_unit(column.unit, "force"):
        item = f"force:{sign}{column.unit}"
        return ProposedColumn(column.name, item, "unit of the file" + turned)
    return ProposedColumn(column.name, f"force:{sign}N", _assumed("N", by) + turned)


def _other_item(column: RawColumn, role: str) -> ProposedColumn:
    values = column.values
    if not np.isfinite(values).all() or np.ptp(values) == 0.0:
        return ProposedColumn(column.name, "-", "constant, or without numbers")
    if role == "time" or (not role and _is_even(values)):
        return ProposedColumn(
            column.name, "-", "counts or ascends, as no response does"
        )
    role = role if role in _QUANTITIES else "acceleration"
    by = "name of the file" if column.name and _role_by_name(column) else "rings"
    if is_unit(column.unit, role):
        return ProposedColumn(column.name, f"{role}:{column.unit}", "unit of the file")
    unit = _UNITS[role]
    return ProposedColumn(column.name, f"{role}:{unit}", _assumed(unit, by))


def _assumed(unit: str, by: str) -> str:
    return f"{ASSUMED}: the unit {unit}; role by: {by}"
