# SPDX-License-Identifier: MIT
"""Choices of a person at the modal desk: what, who, when; as records and as steps.

The log of choices is only ever added to: taking one back is a choice as well. It
travels in the provenance of the results, so that whoever reads them sees who chose
what, and the desk continues where it stopped.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from enum import StrEnum

from jointbench.acquisition.records.provenance import Provenance, Step

CHOICE_STEP = "choice_at_the_desk"
_LONGEST = 80


class ChoiceAction(StrEnum):
    """What was done at the desk."""

    CHOOSE = "choose"
    CLEAR = "clear"
    MERGE = "merge"
    PIN = "pin"
    DROP_HIT = "drop_hit"
    KEEP_HIT = "keep_hit"
    ESTIMATOR = "estimator"
    UNDO = "undo"


FRF_ACTIONS = frozenset(
    {ChoiceAction.DROP_HIT, ChoiceAction.KEEP_HIT, ChoiceAction.ESTIMATOR}
)
"""Choices that change the FRF itself."""


@dataclass(frozen=True, slots=True)
class DeskChoice:
    """One choice.

    Attributes:
        action: what was done.
        who: made it.
        when: UTC, ISO 8601.
        frequency: of the pole, or the lower end of the box [Hz].
        damping_ratio: of the pole [-].
        order: of the fit at which the pole stands; 0 where any will do.
        second: upper end of the box, or the other pole of a merge [Hz].
        name: recording of a hit, or the estimator.
        time: of the hit since the session began [s].
    """

    action: ChoiceAction
    who: str
    when: str
    frequency: float = math.nan
    damping_ratio: float = math.nan
    order: int = 0
    second: float = math.nan
    name: str = ""
    time: float = math.nan

    def words(self) -> str:
        """Return what was done, for people."""
        at = f"{self.frequency:.6g} Hz"
        order = f" at order {self.order}" if self.order else ""
        return {
            ChoiceAction.CHOOSE: f"chose the pole at {at}{order}",
            ChoiceAction.CLEAR: f"cleared {at} to {self.second:.6g} Hz",
            ChoiceAction.MERGE: f"merged {at} and {self.second:.6g} Hz",
            ChoiceAction.PIN: f"pinned {at}, {100 * self.damping_ratio:.4g} %{order}",
            ChoiceAction.DROP_HIT: f"dropped the hit at {self.time:.4g} s, {self.name}",
            ChoiceAction.KEEP_HIT: f"kept the hit at {self.time:.4g} s, {self.name}",
            ChoiceAction.ESTIMATOR: f"estimator {self.name}",
            ChoiceAction.UNDO: "took the last choice back",
        }[self.action]


def plain_who(text: str) -> str:
    """Return a name as the provenance can hold it: one short line, no marks of its own.

    Args:
        text: as typed, or as the computer knows the user.
    """
    line = " ".join(text.replace(";", ",").replace("=", "-").split())
    return line[:_LONGEST] or "unknown"


def effective(log: Iterable[DeskChoice]) -> tuple[DeskChoice, ...]:
    """Return the choices that hold: without those that were taken back."""
    held: list[DeskChoice] = []
    for one in log:
        if one.action is not ChoiceAction.UNDO:
            held.append(one)
        elif held:
            held.pop()
    return tuple(held)


def choice_steps(log: Sequence[DeskChoice]) -> tuple[Step, ...]:
    """Return choices as steps of a provenance, in order."""
    return tuple(Step(CHOICE_STEP, tuple(_details(one))) for one in log)


def choices_of(steps: Provenance) -> tuple[DeskChoice, ...]:
    """Return the choices that a provenance holds, in order; none is lost unseen.

    A step that is none of them, as of a later version, is left out.
    """
    found = []
    for step in steps:
        detail = dict(step.detail)
        known = detail.get("action") in set(ChoiceAction)
        if step.name == CHOICE_STEP and known:
            found.append(_choice(detail))
    return tuple(found)


def _details(one: DeskChoice) -> list[tuple[str, str | float | int | bool]]:
    rows: list[tuple[str, str | float | int | bool]] = []
    for field in fields(one):
        value = getattr(one, field.name)
        if isinstance(value, StrEnum):
            rows.append((field.name, value.value))
        elif isinstance(value, float):
            # All digits: the pole is looked up by them.
            rows += [] if math.isnan(value) else [(field.name, repr(float(value)))]
        elif value:
            rows.append((field.name, value))
    return rows


def _choice(detail: dict[str, str | float | int | bool]) -> DeskChoice:
    def number(name: str) -> float:
        try:
            return float(detail.get(name, math.nan))
        except ValueError:
            return math.nan

    order = number("order")
    return DeskChoice(
        ChoiceAction(str(detail["action"])),
        str(detail.get("who", "unknown")),
        str(detail.get("when", "")),
        frequency=number("frequency"),
        damping_ratio=number("damping_ratio"),
        order=0 if math.isnan(order) else int(order),
        second=number("second"),
        name=str(detail.get("name", "")),
        time=number("time"),
    )
