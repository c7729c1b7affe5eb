# SPDX-License-Identifier: MIT
"""Commands of an operator about the session as a whole."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class AddNote:
    """Store a note in the session.

    Attributes:
        text: one line.
    """

    kind: ClassVar[str] = "note"
    text: str


@dataclass(frozen=True, slots=True)
class PauseSession:
    """Ignore hits until the session continues; samples are still stored."""

    kind: ClassVar[str] = "pause"


@dataclass(frozen=True, slots=True)
class ContinueSession:
    """Continue after a pause."""

    kind: ClassVar[str] = "continue"


@dataclass(frozen=True, slots=True)
class SeeWarnings:
    """Mark all warnings so far as seen."""

    kind: ClassVar[str] = "seen"


@dataclass(frozen=True, slots=True)
class QuitSession:
    """End the session and finish its file.

    Attributes:
        confirmed: needed while conditions are open.
    """

    kind: ClassVar[str] = "quit"
    confirmed: bool = False


@dataclass(frozen=True, slots=True)
class ChangeSetting:
    """Give a setting another value from now on.

    Attributes:
        name: with its unit: ``"trigger_n"`` or ``"length_s"``.
        value: in that unit.
    """

    kind: ClassVar[str] = "set"
    name: str
    value: float
