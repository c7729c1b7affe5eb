# SPDX-License-Identifier: MIT
"""Commands as JSON and as typed words, and back."""

from collections.abc import Mapping
from dataclasses import MISSING, asdict, fields
from difflib import get_close_matches
from types import NoneType
from typing import Any, get_type_hints

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import shown
from jointbench.station.session_events.flow_commands import (
    AddNote,
    ChangeSetting,
    ContinueSession,
    PauseSession,
    QuitSession,
    SeeWarnings,
)
from jointbench.station.session_events.hit_commands import (
    AcceptHit,
    GoToPoint,
    NextPoint,
    RejectHit,
    RepeatPoint,
    UndoVerdict,
)

Command = (
    RejectHit
    | AcceptHit
    | UndoVerdict
    | RepeatPoint
    | NextPoint
    | GoToPoint
    | AddNote
    | PauseSession
    | ContinueSession
    | SeeWarnings
    | ChangeSetting
    | QuitSession
)
_KINDS: Mapping[str, type[Command]] = {
    kind.kind: kind
    for kind in (
        *(RejectHit, AcceptHit, UndoVerdict, RepeatPoint, NextPoint, GoToPoint),
        *(AddNote, PauseSession, ContinueSession, SeeWarnings, QuitSession),
        ChangeSetting,
    )
}
MOST_CHARACTERS = 500
"""Of a text in a command; a note is a line."""
_MOST_DIGITS = 9
"""Of the number of a hit."""


def command_to_json(command: Command) -> dict[str, object]:
    """Return a command as JSON types: its kind, and its arguments."""
    return {"command": command.kind, **asdict(command)}


def command_from_json(content: Mapping[str, Any]) -> Command:
    """Return the command of a JSON object.

    Raises:
        FormatError: its kind is unknown, or an argument is missing, unknown, of
            another type or too long.
    """
    kind = _kind(str(content.get("command")))
    given = {name: value for name, value in content.items() if name != "command"}
    hints = get_type_hints(kind)
    known = {field.name: field for field in fields(kind)}
    for name, value in tuple(given.items()):
        if name not in known:
            raise FormatError(
                f"command {kind.kind!r} has no argument {shown(name)}; it has "
                f"{', '.join(known) or 'none'}"
            )
        _require_type(kind.kind, name, value, hints[name])
        if hints[name] is float:
            given[name] = _number(kind.kind, name, value)
    for name, field in known.items():
        if field.default is MISSING and name not in given:
            raise FormatError(f"command {kind.kind!r} needs its argument {name!r}")
    return kind(**given)


def typed_command(line: str) -> Command:
    """Return the command that an operator typed.

    Args:
        line: ``reject 17``, ``go 4``, ``note text``, ``set trigger_n 8``, and so on.

    Raises:
        FormatError: it is none; the message states what is.
    """
    word, _, rest = line.strip().partition(" ")
    kind, rest = _kind(word.lower()), rest.strip()
    if kind is QuitSession and rest in {"", "yes"}:
        return QuitSession(confirmed=rest == "yes")
    if kind is ChangeSetting:
        return _typed_setting(rest)
    names = [field.name for field in fields(kind)]
    if not rest:
        return command_from_json({"command": kind.kind})
    if not names or kind is QuitSession:
        raise FormatError(f"{kind.kind!r} stands alone; {shown(rest)} is too much")
    value: object = rest
    if kind in {RejectHit, AcceptHit}:
        if not rest.isdecimal() or len(rest) > _MOST_DIGITS:
            raise FormatError(
                f"{kind.kind!r} takes the number of a hit, not {shown(rest)}; for "
                f"example '{kind.kind} 17'"
            )
        value = int(rest)
    return command_from_json({"command": kind.kind, names[0]: value})


def _typed_setting(rest: str) -> ChangeSetting:
    name, _, number = rest.partition(" ")
    try:
        return ChangeSetting(name, float(number))
    except ValueError:
        raise FormatError(
            f"'set' takes a name and a number, not {shown(rest)}; for example "
            "'set trigger_n 8'"
        ) from None


def _kind(word: str) -> type[Command]:
    found = _KINDS.get(word)
    if found is None:
        near = get_close_matches(word, _KINDS, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(_KINDS)}"
        raise FormatError(f"there is no command {shown(word)}; {hint}")
    return found


def _require_type(kind: str, name: str, value: object, wanted: Any) -> None:
    allowed = getattr(wanted, "__args__", (wanted,))
    if type(value) is int and float in allowed:  # JSON has one kind of number
        return
    if type(value) not in allowed:
        words = " or ".join(t.__name__ for t in allowed if t is not NoneType)
        raise FormatError(
            f"argument {name!r} of command {kind!r} is {shown(value)}; it is {words}"
        )
    if isinstance(value, str) and not _is_storable(value):
        raise FormatError(
            f"argument {name!r} of command {kind!r} is {shown(value)}, which has "
            "characters that no file can hold; write plain text"
        )
    if isinstance(value, str) and len(value) > MOST_CHARACTERS:
        raise FormatError(
            f"argument {name!r} of command {kind!r} has {len(value)} characters, at "
            f"most {MOST_CHARACTERS}"
        )


def _number(kind: str, name: str, value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        raise FormatError(
            f"argument {name!r} of command {kind!r} is too large a number"
        ) from None


def _is_storable(text: str) -> bool:
    """Return whether a text is Unicode without zero characters."""
    try:
        return b"\x00" not in text.encode("utf-8")
    except UnicodeEncodeError:
        return False
