# SPDX-License-Identifier: MIT
"""Commands from other processes: files beside the session that is recorded.

A process writes one file for each command; the measuring program takes it, and the
answer is an event in the log, marked with the sender. Whoever may write into the folder
may command, as whoever may write into the folder may replace the session.
"""

import json
import time
import uuid
from collections.abc import Iterator
from contextlib import suppress
from glob import escape
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.station.session_events.command_codec import (
    Command,
    command_from_json,
    command_to_json,
)

_EVERY = 0.5  # [s] between looks at the folder
_MOST_BYTES = 10_000  # of a command


class CommandMailbox:
    """What other processes ask of a session."""

    def __init__(self, session: Path) -> None:
        """Begin; what was asked of an earlier session in its place is removed."""
        self._session, self._looked = session, float("-inf")
        for path in _posted(session):
            path.unlink(missing_ok=True)

    def take(self) -> Iterator[tuple[str, Command]]:
        """Yield sender and command of what was posted since the last look."""
        now = time.monotonic()
        if now - self._looked < _EVERY:
            return
        self._looked = now
        for path in _posted(self._session):
            with suppress(OSError, ValueError, FormatError):
                with path.open("rb") as file:
                    content = json.loads(file.read(_MOST_BYTES))
                path.unlink()
                yield path.name.rpartition(".")[2], command_from_json(dict(content))
            with suppress(OSError):  # not ours, or no command
                path.unlink(missing_ok=True)


def post_command(session: Path, command: Command) -> Path:
    """Post a command to whoever records a session.

    Args:
        session: file that is recorded.
        command: what is asked for.

    Returns:
        The file, whose suffix is the sender in the answer; it is removed when the
        command is taken.

    Raises:
        OSError: the folder cannot be written.
    """
    name = f"{session.name}.ask.send-{uuid.uuid4().hex[:12]}"
    part, path = session.with_name(f".{name}.part"), session.with_name(name)
    part.write_text(json.dumps(command_to_json(command)), encoding="utf-8")
    part.replace(path)
    return path


def _posted(session: Path) -> list[Path]:
    return sorted(session.parent.glob(f"{escape(session.name)}.ask.send-*"))
