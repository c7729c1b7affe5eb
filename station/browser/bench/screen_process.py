# SPDX-License-Identifier: MIT
"""The server of a screen as the measuring program keeps it running."""

import multiprocessing
import socket
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any

from jointbench.acquisition.basics.clean_process import without_main
from jointbench.acquisition.basics.errors import FormatError
from jointbench.station.browser.app.serve_screen import loopback_socket
from jointbench.station.browser.bench.bench_server import run_bench_server
from jointbench.station.browser.bench.screen_link import (
    PageSent,
    Relinked,
    Serving,
    SessionFinished,
    Submitted,
    Taken,
    Watched,
)
from jointbench.station.browser.guard.screen_access import ScreenAccess
from jointbench.station.session_events.command_codec import command_from_json
from jointbench.station.session_events.command_queue import CommandQueue

_VIEW = "browser"
_BRIEF = 3.0
"""A server that ends sooner is not worth another one at once [s]."""
_MOST_BRIEF = 3
_UNWATCHED = 10.0
"""Without an open screen after which a finished session is left [s]."""
_OPENING = 60.0
"""After a link was used, a page sent or a server lost, a screen is awaited [s]."""
_LOOK = 0.2  # [s]
_LAST_WORD = 5.0  # [s]


class ScreenProcess:
    """Serves a screen from a process of its own, started again where it dies.

    Attributes:
        access: of the screen.
        process_id: number of the process in the system, 0 without one.
    """

    def __init__(
        self,
        session: Path,
        commands: CommandQueue,
        *,
        port: int = 0,
        geometry: Mapping[str, Any] | None = None,
        places: Path | None = None,
        say: Callable[[str], None] = lambda line: None,
    ) -> None:
        """Start serving.

        Args:
            session: file that it follows, which may not be there yet.
            commands: takes those of the screens.
            port: TCP port; 0 for any that is free.
            geometry: points and lines as JSON types.
            places: file of the geometry.
            say: takes a line where the link is another one, or the screen is given up.

        Raises:
            UsageError: the port is taken.
        """
        self._listening: socket.socket = loopback_socket(port)
        self.access = ScreenAccess(self._listening.getsockname()[1])
        self.process_id = 0
        self._serving = Serving(
            session,
            self.access.port,
            self.access.token,
            self.access.admission,
            geometry,
            places,
        )
        self._commands, self._say = commands, say
        self._closing = threading.Event()
        self._watched = 0
        self._link: Connection | None = None
        self._unwatched_since = time.monotonic()
        self._opening_until = 0.0
        self._thread = threading.Thread(target=self._keep, name="screen", daemon=True)
        self._thread.start()

    def __enter__(self) -> "ScreenProcess":
        """Return the screen."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End serving."""
        self._closing.set()
        self._thread.join(_LAST_WORD)
        self._listening.close()

    def finished(self, session: Path) -> None:
        """Notify this server and the next that the file of the session is whole."""
        self._serving = replace(self._serving, session=session, finished=True)
        with suppress(OSError):
            if self._link is not None:
                self._link.send(SessionFinished(session))

    def linger(self) -> None:
        """Return once no screen has been open for some seconds, or on Ctrl-C."""
        self._unwatched_since = time.monotonic()
        with suppress(KeyboardInterrupt):
            while self._thread.is_alive() and self._in_use():
                time.sleep(_LOOK)

    def _in_use(self) -> bool:
        now = time.monotonic()
        left = now - self._unwatched_since >= _UNWATCHED and now >= self._opening_until
        return self._watched > 0 or not left

    def _keep(self) -> None:
        brief = 0
        while not self._closing.is_set() and brief < _MOST_BRIEF:
            began = time.monotonic()
            self._serve_once()
            brief = brief + 1 if time.monotonic() - began < _BRIEF else 0
        if not self._closing.is_set():
            self._say("the screen in the browser has ended; the session continues")

    def _serve_once(self) -> None:
        context = multiprocessing.get_context("spawn")
        link, far = context.Pipe()
        self._link = link
        process = context.Process(
            target=run_bench_server,
            args=(far, self._listening, self._serving),
            name="jointbench screen",
            daemon=True,
        )
        with without_main():
            process.start()
        far.close()
        self.process_id = process.pid or 0
        with suppress(EOFError, OSError):
            while not self._closing.is_set():
                if link.poll(_LOOK):
                    self._take(link, link.recv())
        with suppress(OSError):
            link.close()
        if self._watched:
            # They connect to the next server.
            self._opening_until = time.monotonic() + _OPENING
        self._watch(0)
        process.join(_LAST_WORD)
        if process.is_alive():
            process.kill()

    def _take(self, link: Connection, news: object) -> None:
        if isinstance(news, Watched):
            self._watch(news.count)
        elif isinstance(news, PageSent):
            self._opening_until = time.monotonic() + _OPENING
        elif isinstance(news, Relinked):
            self._opening_until = time.monotonic() + _OPENING
            self.access.token = news.token
            self._serving = replace(self._serving, token=news.token)
            self._say(f"link for another browser: {self.access.link('/measure')}")
        elif isinstance(news, Submitted):
            link.send(Taken(news.tag, self._queued(news.command)))

    def _watch(self, count: int) -> None:
        self._watched = count
        if count:
            self._opening_until = 0.0
        else:
            self._unwatched_since = time.monotonic()

    def _queued(self, content: Mapping[str, object]) -> Mapping[str, Any]:
        try:
            ticket = self._commands.submit(command_from_json(content), by=_VIEW)
        except FormatError as error:
            return {"id": None, "done": False, "words": str(error)}
        if ticket.answer is not None:
            return ticket.answer.to_json()
        return {"id": ticket.id, "done": None, "words": ""}
