# SPDX-License-Identifier: MIT
"""How many screens are open: each holds a socket as long as it is shown."""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.websockets import WebSocket


class OpenScreens:
    """Counts the sockets of a screen's pages."""

    def __init__(self, changed: Callable[[int], None] = lambda count: None) -> None:
        """Begin without one.

        Args:
            changed: takes the number whenever it changes.
        """
        self._changed, self._count = changed, 0

    def change(self, by: int) -> None:
        """Count a socket that opened, 1, or closed, -1."""
        self._count += by
        self._changed(self._count)

    async def hold(self, socket: "WebSocket") -> None:
        """Count a page that needs no news, until it leaves."""
        await socket.accept()
        self.change(1)
        try:
            while (await socket.receive())["type"] != "websocket.disconnect":
                pass  # what it sends means nothing
        finally:
            self.change(-1)
