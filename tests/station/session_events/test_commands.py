"""Commands of views into a session: typed, as JSON, queued and answered."""

import json
import threading

import pytest

from jointbench.acquisition.basics.errors import FormatError
from jointbench.station.session_events.command_codec import (
    Command,
    command_from_json,
    command_to_json,
    typed_command,
)
from jointbench.station.session_events.command_queue import Answer, CommandQueue
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

COMMANDS: dict[str, Command] = {
    "reject": RejectHit(),
    "reject 17": RejectHit(17),
    "accept 3": AcceptHit(3),
    "undo": UndoVerdict(),
    "repeat": RepeatPoint(),
    "next": NextPoint(),
    "go 4": GoToPoint("4"),
    "note bolt 2 rubs": AddNote("bolt 2 rubs"),
    "pause": PauseSession(),
    "continue": ContinueSession(),
    "seen": SeeWarnings(),
    "quit": QuitSession(),
    "quit yes": QuitSession(confirmed=True),
    "set trigger_n 8": ChangeSetting("trigger_n", 8.0),
}


@pytest.mark.parametrize("typed", COMMANDS)
def test_a_command_goes_through_words_and_json_and_back(typed: str) -> None:
    """Kind and arguments are the same."""
    command = COMMANDS[typed]
    content = json.loads(json.dumps(command_to_json(command)))
    assert typed_command(typed) == command
    assert command_from_json(content) == command


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"command": "rejekt"}, "did you mean 'reject'"),
        ({}, "there is no command"),
        ({"command": "reject", "hit": "17"}, "it is int"),
        ({"command": "reject", "hit": True}, "it is int"),
        ({"command": "reject", "hits": 17}, "it has hit"),
        ({"command": "undo", "hit": 1}, "it has none"),
        ({"command": "go"}, "needs its argument 'point'"),
        ({"command": "note", "text": "x" * 501}, "at most 500"),
        ({"command": "set", "name": "trigger_n", "value": "8"}, "it is float"),
    ],
)
def test_json_that_is_no_command_is_refused_in_one_line(
    content: dict[str, object], words: str
) -> None:
    """The argument, its value and the rule are named."""
    with pytest.raises(FormatError, match=words):
        command_from_json(content)


@pytest.mark.parametrize(
    "typed", ["", "dance", "reject all", "go", "pause now", "set trigger_n"]
)
def test_words_that_are_no_command_are_refused(typed: str) -> None:
    """Nothing is guessed."""
    with pytest.raises(FormatError):
        typed_command(typed)


def test_a_command_from_another_thread_waits_for_its_answer() -> None:
    """As a browser's does; the first one in is the first one out."""
    commands = CommandQueue()
    heard: list[Answer | None] = []
    ticket = commands.submit(RejectHit(17), by="browser")
    waiting = threading.Thread(target=lambda: heard.append(ticket.wait(10.0)))
    waiting.start()
    taken = commands.take()
    assert taken is ticket
    taken.give(Answer(taken.id, done=True, words="hit 17 is rejected"))
    waiting.join()
    assert heard == [Answer(0, True, "hit 17 is rejected")]
    assert taken.to_json()["by"] == "browser"


def test_a_session_that_has_ended_or_is_flooded_refuses_at_once() -> None:
    """Everybody gets an answer: those who wait, those who come later."""
    commands = CommandQueue()
    waiting = [commands.submit(SeeWarnings(), by="browser") for _ in range(101)]
    assert waiting[-1].answer is not None
    assert "too many" in waiting[-1].answer.words
    commands.close("the session has ended")
    late = commands.submit(SeeWarnings(), by="browser")
    for ticket in (waiting[0], late):
        assert ticket.answer is not None
        assert not ticket.answer.done
        assert ticket.answer.words == "the session has ended"
