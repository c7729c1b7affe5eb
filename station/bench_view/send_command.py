# SPDX-License-Identifier: MIT
"""``jointbench send``: a command to a session that another process records."""

import time
from contextlib import suppress
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, InstrumentError, UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, write_json
from jointbench.station.session_events.command_codec import (
    command_to_json,
    typed_command,
)
from jointbench.station.session_events.command_mailbox import post_command
from jointbench.station.session_events.event_codec import from_log
from jointbench.station.session_events.operator_events import CommandAnswered

_EVERY = 0.5  # [s] between looks at the log
_PATIENCE = 60.0  # [s] for an answer


def run_send(
    session: Path,
    words: str,
    *,
    json_target: str | None,
    patience: float = _PATIENCE,
) -> bool:
    """Ask something of a session, and print the answer.

    Args:
        session: file that is recorded.
        words: the command as it is typed.
        json_target: where the JSON of the answer goes.
        patience: time for an answer [s].

    Returns:
        Whether it was done.

    Raises:
        FormatError: there is no such command.
        UsageError: the session is not being recorded, or cannot be reached.
        InstrumentError: it does not answer.
    """
    check_outputs([session], [json_target])
    command = typed_command(words)
    if not is_held(session):
        raise UsageError(f"{named(session)} is not being recorded; nothing can answer")
    try:
        posted = post_command(session, command)
    except OSError as error:
        raise UsageError(
            f"no command can be left beside {named(session)}: {error.strerror}; run "
            "the command as the user who records"
        ) from error
    try:
        answer = _answer(session, posted.name.rpartition(".")[2], patience)
    finally:
        with suppress(OSError):
            posted.unlink(missing_ok=True)
    word = "done" if answer.done else "refused"
    console(json_target).print(f"{word}: {answer.words}", soft_wrap=True, markup=False)
    write_json(
        json_target,
        {**command_to_json(command), "done": answer.done, "words": answer.words},
    )
    return answer.done


def _answer(session: Path, sender: str, patience: float) -> CommandAnswered:
    """Return the answer as soon as it is in the log.

    Raises:
        InstrumentError: there is none in time, or the recording has ended.
    """
    until, recorded = time.monotonic() + patience, True
    while time.monotonic() < until and recorded:
        time.sleep(_EVERY)
        recorded = is_held(session)  # asked before the log is read
        with suppress(BadData):  # the finished file takes its place just now
            for stamped in from_log(read_log(session)[0]):
                event = stamped.event
                if isinstance(event, CommandAnswered) and event.by == sender:
                    return event
    raise InstrumentError(
        f"{named(session)} has not answered"
        + ("" if recorded else ", its recording has ended")
        + "; `jointbench watch` shows what it does"
    )
