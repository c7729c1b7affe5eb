# SPDX-License-Identifier: MIT
"""The process that serves the screen of a session; it may die without a hit lost.

It reads the session file as `watch` does, and passes commands to the measuring program.
"""

import asyncio
import signal
import socket
import threading
from collections.abc import Mapping
from contextlib import suppress
from itertools import count
from multiprocessing.connection import Connection
from typing import Any

from jointbench.station.browser.app.serve_screen import screen_server
from jointbench.station.browser.bench.bench_routes import bench_part
from jointbench.station.browser.bench.desk_after_session import DeskAfterSession
from jointbench.station.browser.bench.screen_link import (
    PageSent,
    Relinked,
    Serving,
    SessionFinished,
    Submitted,
    Taken,
    Watched,
)
from jointbench.station.browser.bench.session_feed import SessionFeed
from jointbench.station.browser.guard.open_screens import OpenScreens
from jointbench.station.browser.guard.screen_access import ScreenAccess

_LOOK = 0.2  # [s], for the end of the server
_PATIENCE = 5.0
"""For the answer to a command [s]; a bolt that is tightened may delay it."""


def run_bench_server(
    link: Connection, listening: socket.socket, serving: Serving
) -> None:
    """Serve until the measuring program closes the link; the entry of the process.

    Args:
        link: to the measuring program.
        listening: socket that stays open where this process dies.
        serving: what is served.
    """
    # Ctrl-C reaches the whole group; the measuring program decides what follows.
    for name in ("SIGINT", "SIGHUP", "SIGBREAK"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    desk = _CommandDesk(link, SessionFeed(serving.session))

    def tell(news: object) -> None:
        with suppress(OSError):  # the measuring program has ended
            link.send(news)

    screens = OpenScreens(lambda count: tell(Watched(count)))
    after = DeskAfterSession(serving.places, screens)
    if serving.finished:
        after.finished(serving.session)
    parts = (
        bench_part(desk.feed, desk.submit, screens, serving.geometry),
        after.part(),
    )
    access = ScreenAccess(
        serving.port, token=serving.token, admission=serving.admission
    )
    access.relinked = lambda token: tell(Relinked(token))
    access.page_sent = lambda: tell(PageSent())
    server = screen_server(parts, access)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        while thread.is_alive():
            if link.poll(_LOOK):
                news = link.recv()
                if isinstance(news, SessionFinished):
                    after.finished(news.session)
                else:
                    desk.take(news)
    except (EOFError, OSError):
        server.should_exit = True
    thread.join()


class _CommandDesk:
    """Passes commands on, and waits for their answers in the log."""

    def __init__(self, link: Connection, feed: SessionFeed) -> None:
        self.feed = feed
        self._link, self._tags = link, count()
        self._due: dict[
            int, tuple[asyncio.AbstractEventLoop, asyncio.Future[Mapping[str, Any]]]
        ] = {}

    async def submit(self, command: Mapping[str, object]) -> Mapping[str, Any]:
        """Return the answer to a command, as the log of the session has it."""
        tag, loop = next(self._tags), asyncio.get_running_loop()
        reply: asyncio.Future[Mapping[str, Any]] = loop.create_future()
        self._due[tag] = loop, reply
        self._link.send(Submitted(tag, command))
        try:
            taken = await asyncio.wait_for(reply, _PATIENCE)
        except TimeoutError:
            return {"done": None, "words": "the measuring program does not answer"}
        finally:
            del self._due[tag]
        if taken["done"] is not None:
            return taken
        return await self._answered(int(taken["id"]))

    def take(self, taken: Taken) -> None:
        """Pass a reply on to the request that waits for it."""
        waiting = self._due.get(taken.tag)
        if waiting is not None:
            loop, reply = waiting
            loop.call_soon_threadsafe(_settle, reply, taken.answer)

    async def _answered(self, number: int) -> Mapping[str, Any]:
        loop = asyncio.get_running_loop()
        until = loop.time() + _PATIENCE
        while loop.time() < until:
            turn = self.feed.turn
            for answer in self.feed.state.answers:
                if answer.number == number:
                    return {"id": number, "done": answer.done, "words": answer.words}
            await self.feed.news(turn)
        return {"id": number, "done": None, "words": "queued; its answer is due"}


def _settle(
    reply: "asyncio.Future[Mapping[str, Any]]", answer: Mapping[str, Any]
) -> None:
    if not reply.done():
        reply.set_result(answer)
