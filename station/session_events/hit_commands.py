# SPDX-License-Identifier: MIT
"""Commands of an operator about hits and points."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class RejectHit:
    """Take a hit out of its average.

    Attributes:
        hit: its number as shown, from 1; None for the last one.
    """

    kind: ClassVar[str] = "reject"
    hit: int | None = None


@dataclass(frozen=True, slots=True)
class AcceptHit:
    """Take a hit into its average.

    Attributes:
        hit: its number as shown, from 1; None for the last one.
    """

    kind: ClassVar[str] = "accept"
    hit: int | None = None


@dataclass(frozen=True, slots=True)
class UndoVerdict:
    """Undo the last decision on the last hit; without one, take the hit out."""

    kind: ClassVar[str] = "undo"


@dataclass(frozen=True, slots=True)
class RepeatPoint:
    """Set the hits of the present point aside, and strike it again."""

    kind: ClassVar[str] = "repeat"


@dataclass(frozen=True, slots=True)
class NextPoint:
    """Leave the present point for the next one that is open."""

    kind: ClassVar[str] = "next"


@dataclass(frozen=True, slots=True)
class GoToPoint:
    """Go to a point of the plan, at the present torque and level.

    Attributes:
        point: its name in the plan.
    """

    kind: ClassVar[str] = "go"
    point: str
