# SPDX-License-Identifier: MIT
"""What the measuring program and the server of its screen say to each other."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, slots=True)
class Serving:
    """What a server is started with.

    Attributes:
        session: file that it follows.
        port: of its listening socket.
        token: of the next link.
        admission: of the cookie.
        geometry: points and lines as JSON types; None without.
        places: file of the geometry; None without.
        finished: whether the file of the session is whole.
    """

    session: Path
    port: int
    token: str
    admission: str
    geometry: Mapping[str, Any] | None = None
    places: Path | None = None
    finished: bool = False


@dataclass(frozen=True, slots=True)
class SessionFinished:
    """To the server: the file of the session is whole.

    Attributes:
        session: its file.
    """

    session: Path


@dataclass(frozen=True, slots=True)
class Submitted:
    """From the server: a command of an operator.

    Attributes:
        tag: number that its reply carries.
        command: as JSON types.
    """

    tag: int
    command: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Taken:
    """To the server: a command was queued, or refused at once.

    Attributes:
        tag: of the command.
        answer: number of the command, whether it is done, and words; ``done`` is None
            where the answer will be an event of the session.
    """

    tag: int
    answer: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Relinked:
    """From the server: a browser used the link; another one takes its place.

    Attributes:
        token: of the next link.
    """

    token: str


@dataclass(frozen=True, slots=True)
class PageSent:
    """From the server: a browser was sent a page, whose screen opens a moment later."""


@dataclass(frozen=True, slots=True)
class Watched:
    """From the server: how many screens are open.

    Attributes:
        count: of them.
    """

    count: int
