# SPDX-License-Identifier: MIT
"""Keys of the operator: single keys, typed commands, and a question before the end."""

from collections.abc import Callable
from dataclasses import dataclass, field

from jointbench.acquisition.basics.errors import FormatError
from jointbench.station.session_events.command_codec import Command, typed_command
from jointbench.station.session_events.flow_commands import (
    ContinueSession,
    PauseSession,
    QuitSession,
    SeeWarnings,
)
from jointbench.station.session_events.hit_commands import (
    AcceptHit,
    NextPoint,
    RejectHit,
    RepeatPoint,
    UndoVerdict,
)
from jointbench.station.session_events.session_state import SessionState

KEYS = (
    "a accept  r reject  u undo  h reject number  p repeat point  n next  g go to",
    "t note  space pause  w warnings seen  c C channel  : command  q quit",
)
RUN_KEYS = ("n next run  t note  w warnings seen  : command  q quit",)
"""While timed runs are recorded, which have no hits."""
_SINGLE: dict[str, Callable[[], Command]] = {
    "a": AcceptHit,
    "r": RejectHit,
    "u": UndoVerdict,
    "p": RepeatPoint,
    "n": NextPoint,
    "w": SeeWarnings,
}
_BEGUN = {"g": "go ", "t": "note ", "h": "reject ", ":": ""}
_ENTER, _ESCAPE, _BACK = {"\r", "\n"}, "\x1b", {"\x7f", "\b"}
_LONGEST = 300  # characters of a typed line


@dataclass(slots=True)
class OperatorKeys:
    """From keys to commands; what is typed meanwhile is the prompt.

    Attributes:
        channel: number of the response that the operator wants to see.
    """

    channel: int = 0
    _line: str | None = None
    _quitting: str = ""
    _trouble: str = ""
    _left: list[str] = field(default_factory=list)

    @property
    def prompt(self) -> str:
        """What is typed or asked; empty where single keys count."""
        if self._quitting:
            return self._quitting
        if self._trouble:
            return f"{self._trouble}  (any key)"
        return "" if self._line is None else f"command: {self._line}"

    def press(self, keys: str, state: SessionState) -> Command | None:
        """Take keys; return the first command that they complete, if any.

        Args:
            keys: pressed since the last call.
            state: of the session, for what a key means now.
        """
        self._left += keys
        while self._left:
            command = self._key(self._left.pop(0), state)
            if command is not None:
                return command
        return None

    def _key(self, key: str, state: SessionState) -> Command | None:
        if self._quitting:
            self._quitting = ""
            return QuitSession(confirmed=True) if key.lower() == "y" else None
        if self._trouble:
            self._trouble = ""
            return None
        if self._line is not None:
            return self._typed(key)
        return self._single(key, state)

    def _single(self, key: str, state: SessionState) -> Command | None:
        low = key.lower()
        if low in _BEGUN:
            self._line = _BEGUN[low]
        elif low == "c":
            self.channel += 1 if key == "c" else -1
        elif low == "q":
            left = state.planned - state.done
            self._quitting = f"Quit? {left} of {state.planned} conditions are open. y/n"
        elif key == " ":
            return ContinueSession() if state.paused else PauseSession()
        elif low in _SINGLE:
            return _SINGLE[low]()
        return None

    def _typed(self, key: str) -> Command | None:
        assert self._line is not None
        if key == _ESCAPE:
            self._line = None
        elif key in _BACK:
            self._line = self._line[:-1]
        elif key in _ENTER:
            line, self._line = self._line, None
            return self._command(line)
        elif key.isprintable() and len(self._line) < _LONGEST:
            self._line += key
        return None

    def _command(self, line: str) -> Command | None:
        if not line.strip():
            return None
        try:
            return typed_command(line)
        except FormatError as error:
            self._trouble = str(error)
        return None
