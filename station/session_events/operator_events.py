# SPDX-License-Identifier: MIT
"""Events of a session that follow from commands of an operator."""

from dataclasses import dataclass
from typing import Any, ClassVar

PAUSE = "pause"
"""Name and purpose of what is recorded while the operator pauses."""


@dataclass(frozen=True, slots=True)
class CommandAnswered:
    """A command was carried out or refused.

    Attributes:
        number: of the command, from 0.
        by: name of the view that it came from.
        command: as JSON types.
        done: True for done, False for refused.
        words: what was done, or why it was refused.
    """

    kind: ClassVar[str] = "command"
    number: int
    by: str
    command: dict[str, Any]
    done: bool
    words: str


@dataclass(frozen=True, slots=True)
class NoteAdded:
    """A note of the operator.

    Attributes:
        words: one line.
    """

    kind: ClassVar[str] = "note"
    words: str


@dataclass(frozen=True, slots=True)
class PauseChanged:
    """The session pauses, or continues.

    Attributes:
        paused: whether hits are ignored from now on.
    """

    kind: ClassVar[str] = "pause"
    paused: bool


@dataclass(frozen=True, slots=True)
class WarningsSeen:
    """The operator has seen warnings.

    Attributes:
        count: number of warnings since the session began that were seen.
    """

    kind: ClassVar[str] = "seen"
    count: int


@dataclass(frozen=True, slots=True)
class ConditionReopened:
    """A condition that was over needs hits again.

    Attributes:
        name: of the condition.
    """

    kind: ClassVar[str] = "reopened"
    name: str
