# SPDX-License-Identifier: MIT
"""The socket of a screen: state and envelope of the signals as they come.

Each screen has a place of its own in the stream. One that does not read (a frozen
browser) waits alone, and continues with the newest bins.
"""

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING

from jointbench.station.browser.bench.session_feed import SessionFeed
from jointbench.station.browser.guard.open_screens import OpenScreens

if TYPE_CHECKING:
    from starlette.websockets import WebSocket


class LiveSocket:
    """Serves all open screens of a session."""

    def __init__(self, feed: SessionFeed, screens: OpenScreens) -> None:
        """Prepare to serve.

        Args:
            feed: of the session.
            screens: counts those that are open.
        """
        self._feed, self._screens = feed, screens

    async def serve(self, socket: "WebSocket") -> None:
        """Serve one screen until it leaves."""
        from starlette.websockets import WebSocketDisconnect

        await socket.accept()
        self._screens.change(1)
        leaving = asyncio.create_task(_left(socket))
        try:
            with self._feed.watched():
                await self._send_all(socket, leaving)
        except (WebSocketDisconnect, RuntimeError, OSError):
            pass  # it left while something was sent
        finally:
            leaving.cancel()
            with suppress(asyncio.CancelledError):
                await leaving
            self._screens.change(-1)

    async def _send_all(self, socket: "WebSocket", leaving: asyncio.Task[None]) -> None:
        feed, shown, sent = self._feed, 0, 0
        while not leaving.done():
            turn, state = feed.turn, feed.message()
            if state.number != shown:
                shown = state.number
                await socket.send_text(state.text)
            ring = feed.ring
            if ring is not None and ring.past > sent:
                message, sent = ring.message(sent), ring.past
                await socket.send_bytes(message)
            await feed.news(turn)


async def _left(socket: "WebSocket") -> None:
    """Return when the screen leaves; what it sends meanwhile means nothing."""
    while (await socket.receive())["type"] != "websocket.disconnect":
        pass
