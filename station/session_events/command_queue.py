# SPDX-License-Identifier: MIT
"""The queue of commands into a session: from any view, answered one by one."""

import queue
import threading
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from itertools import count
from typing import Any

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.station.session_events.command_codec import (
    Command,
    command_to_json,
)

_MOST_WAITING = 100
_FULL = "too many commands wait; try again"


class CommandRefused(JointbenchError):
    """A command cannot be carried out now; the message is the answer."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of a command.

    Attributes:
        id: number of the command.
        done: True for done, False for refused.
        words: what was done, or why it was refused, in one line.
    """

    id: int
    done: bool
    words: str

    def to_json(self) -> dict[str, Any]:
        """Return the answer as JSON types."""
        return asdict(self)


@dataclass(slots=True, eq=False)
class Ticket:
    """A command on its way through the queue.

    Attributes:
        id: number of the command in its session, from 0.
        command: what is asked for.
        by: name of the view that it comes from.
        answer: None until there is one.
    """

    id: int
    command: Command
    by: str
    answer: Answer | None = None
    _answered: threading.Event = field(default_factory=threading.Event)

    def give(self, answer: Answer) -> None:
        """Answer the command; whoever waits continues."""
        self.answer = answer
        self._answered.set()

    def wait(self, seconds: float) -> Answer | None:
        """Return the answer as soon as there is one, None if there is none in time."""
        self._answered.wait(seconds)
        return self.answer

    def to_json(self) -> Mapping[str, object]:
        """Return the command with its number as JSON types."""
        return {"id": self.id, "by": self.by, **command_to_json(self.command)}


class CommandQueue:
    """Commands that wait for the session; `submit` may be called from any thread."""

    def __init__(self) -> None:
        """Begin without a command."""
        self._waiting: queue.Queue[Ticket] = queue.Queue(_MOST_WAITING)
        self._numbers = count()
        self._closed = ""

    def submit(self, command: Command, *, by: str) -> Ticket:
        """Queue a command; it is refused at once where the session takes no more.

        Args:
            command: what is asked for.
            by: name of the view.
        """
        ticket = Ticket(next(self._numbers), command, by)
        try:
            if not self._closed:
                self._waiting.put_nowait(ticket)
        except queue.Full:
            ticket.give(Answer(ticket.id, done=False, words=_FULL))
        if self._closed:
            ticket.give(Answer(ticket.id, done=False, words=self._closed))
        return ticket

    def take(self) -> Ticket | None:
        """Return the command that has waited longest, None without one."""
        try:
            return self._waiting.get_nowait()
        except queue.Empty:
            return None

    def close(self, words: str) -> None:
        """Refuse everything that waits, and everything that comes, in these words."""
        self._closed = words
        while (ticket := self.take()) is not None:
            ticket.give(Answer(ticket.id, done=False, words=words))
