# SPDX-License-Identifier: MIT
"""The desk of a session: events go out to the log and its views, commands come in."""

from dataclasses import dataclass, field

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.measure.plan import Condition
from jointbench.station.session_events.command_mailbox import CommandMailbox
from jointbench.station.session_events.command_queue import (
    Answer,
    CommandQueue,
    Ticket,
)
from jointbench.station.session_events.event_codec import Event, from_log, to_entry
from jointbench.station.session_events.flow_events import Asked, Said, Warned
from jointbench.station.session_events.operator_events import CommandAnswered

_TERMINAL = "terminal"


@dataclass(slots=True)
class SessionDesk:
    """Writes events of a session, shows them, and takes its commands.

    The view gets events as they are in the file, as every other view does.

    Attributes:
        recorder: writes the log.
        view: on this computer.
        commands: that wait; other views may submit theirs.
        warned: number of warnings so far.
        mailbox: of commands from other processes, None for none.
    """

    recorder: RecorderProcess
    view: LiveView
    commands: CommandQueue = field(default_factory=CommandQueue)
    warned: int = 0
    mailbox: CommandMailbox | None = None
    _asked: Asked | None = None
    _due: int = 0
    _followed: int = 0

    def write(self, event: Event) -> None:
        """Log an event."""
        self.log(to_entry(event))

    def log(self, entry: dict[str, object]) -> None:
        """Log an entry, which every view reads back before it shows what follows."""
        self.recorder.log(entry)
        self._due += 1

    def say(self, line: str) -> None:
        """Log a message to the operator."""
        self.write(Said(line))

    def warn(self, line: str) -> None:
        """Log a warning, which stays on the screen until the operator has seen it."""
        self.write(Warned(line))
        self.warned += 1

    def ask(self, condition: Condition, done: int, total: int) -> None:
        """Log a request for hits, once for each condition."""
        asked = Asked(condition.name, condition.point, done, total)
        if asked != self._asked:
            self._asked = asked
            self.write(asked)

    def gap(self) -> None:
        """Take note that the recording process has logged an event of its own."""
        self._due += 1

    def samples(self, samples: FloatArray) -> None:
        """Show the levels of a block."""
        self.view.level(samples)

    def attend(self) -> None:
        """Show what is new in the log, and take what the operator asks for."""
        if self._followed < self._due:
            entries = self.recorder.new_entries()
            first, self._followed = self._followed, self._followed + len(entries)
            self.view.follow(tuple(from_log(entries, first=first)))
        command = self.view.command()
        if command is not None:
            self.commands.submit(command, by=_TERMINAL)
        if self.mailbox is not None:
            for sender, command in self.mailbox.take():
                self.commands.submit(command, by=sender)

    def next_command(self) -> Ticket | None:
        """Return the next command, None without one."""
        self.attend()
        return self.commands.take()

    def answer(self, ticket: Ticket, words: str, *, done: bool) -> None:
        """Answer a command; the answer is an event."""
        self.write(
            CommandAnswered(
                ticket.id,
                ticket.by,
                dict(ticket.to_json()),
                done=done,
                words=words,
            )
        )
        ticket.give(Answer(ticket.id, done=done, words=words))

    def leave(self, entries: tuple[dict[str, object], ...]) -> None:
        """Show the rest of the log of a recording that has ended.

        Args:
            entries: all of its log.
        """
        self.commands.close("the session has ended")
        rest = entries[self._followed :]
        self.view.follow(tuple(from_log(rest, first=self._followed)))
        self._followed += len(rest)
