# SPDX-License-Identifier: MIT
"""Settings of the engine as data: value, unit, purpose and basis.

Each part of the engine keeps its settings in one frozen record. Its fields are plain
numbers, so that code reads `SEARCH.most_steps`; unit, purpose and basis are in the
field's metadata, from which `settings_of` makes a table.
"""

from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, TypeVar

Value = TypeVar("Value")
_SETTING = "setting"
NO_CAMPAIGN = "chosen by judgement; no campaign set it"
"""Basis of a setting without a recorded measurement."""


class SettingKind(StrEnum):
    """Purpose of a setting."""

    DECISION = "decision"
    """A threshold that a verdict is compared with."""
    NUMERICAL = "numerical"
    """A step, tolerance, size or cap of an algorithm."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of the engine, with its documentation.

    Attributes:
        name: of the field that holds it.
        value: in force.
        unit: of the value; "-" if it has none.
        purpose: of the setting.
        basis: how it was set, and on which campaigns.
        kind: decision or numerical.
        effect: effect of a change by 30 % down and up on the verdicts of the sweep
            (`benchmarks/gap/policy_sweep.py`); empty for numerical settings.
    """

    name: str
    value: Any
    unit: str
    purpose: str
    basis: str
    kind: SettingKind
    effect: str = ""


def decision(
    value: Value, unit: str, purpose: str, basis: str, effect: str = ""
) -> Value:
    """Return the field of a threshold that a verdict is compared with."""
    return _field(value, (unit, purpose, basis, SettingKind.DECISION, effect))


def numerical(value: Value, unit: str, purpose: str, basis: str = NO_CAMPAIGN) -> Value:
    """Return the field of a number used by an algorithm."""
    return _field(value, (unit, purpose, basis, SettingKind.NUMERICAL))


def _field(value: Value, facts: tuple[Any, ...]) -> Value:
    """Return a dataclass field, typed as the value that it holds in a record."""
    made: Value = field(default=value, metadata={_SETTING: facts})
    return made


def settings_of(record: Any) -> tuple[Setting, ...]:
    """Return the settings of a record in the order of its fields."""
    return tuple(
        Setting(f.name, getattr(record, f.name), *f.metadata[_SETTING])
        for f in fields(record)
    )
