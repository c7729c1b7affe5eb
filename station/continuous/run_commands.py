# SPDX-License-Identifier: MIT
"""Commands of the operator while runs are recorded."""

from typing import Protocol

from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.session_events.flow_commands import (
    AddNote,
    QuitSession,
    SeeWarnings,
)
from jointbench.station.session_events.hit_commands import NextPoint
from jointbench.station.session_events.operator_events import NoteAdded, WarningsSeen


class RunsState(Protocol):
    """What a command changes."""

    interrupted: bool
    next_run: bool


def obey_next(desk: SessionDesk, record: RunsState) -> None:
    """Carry out and answer the next command, if there is one."""
    ticket = desk.next_command()
    if ticket is None:
        return
    done = True
    match ticket.command:
        case QuitSession(confirmed=True):
            record.interrupted, words = True, "the recording ends"
        case QuitSession():
            done, words = False, "runs are open; confirm with 'quit yes'"
        case NextPoint():
            record.next_run, words = True, "the run ends, the next one begins"
        case AddNote(text=text) if text.strip():
            words = " ".join(text.split())
            desk.write(NoteAdded(words))
        case SeeWarnings():
            words = f"{desk.warned} warnings seen"
            desk.write(WarningsSeen(desk.warned))
        case _:
            done, words = False, "runs have no hits; next, note, seen or quit"
    desk.answer(ticket, words, done=done)
