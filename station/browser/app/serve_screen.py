# SPDX-License-Identifier: MIT
"""A screen on the loopback interface: its socket, its server, its browser."""

import socket
import webbrowser
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.browser.app.screen_app import screen_app
from jointbench.station.browser.app.screen_extra import require_screen_extra
from jointbench.station.browser.app.screen_part import ScreenPart
from jointbench.station.browser.guard.screen_access import LOOPBACK, ScreenAccess

if TYPE_CHECKING:
    from uvicorn import Server

_MOST_PORTS = 65535
_MOST_RECEIVED = 1 << 16
"""Of a message from a browser [bytes]."""
_PATIENCE = 2
"""With open connections at the end [s]."""


def loopback_socket(port: int = 0) -> socket.socket:
    """Return a listening socket that only this computer reaches.

    Args:
        port: TCP port; 0 for any that is free.

    Raises:
        UsageError: the port is taken, or is none.
    """
    if not 0 <= port <= _MOST_PORTS:
        raise UsageError(f"port {port} is none; give 0 to {_MOST_PORTS}")
    opened = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    # A server that is started again takes its port back at once. Windows needs nothing
    # for this; there SO_REUSEADDR would let another program take the port over.
    exclusive = getattr(socket, "SO_EXCLUSIVEADDRUSE", None)
    option = socket.SO_REUSEADDR if exclusive is None else exclusive
    opened.setsockopt(socket.SOL_SOCKET, option, 1)
    try:
        opened.bind((LOOPBACK, port))
    except OSError as error:
        opened.close()
        raise UsageError(
            f"port {port} cannot be opened ({error.strerror}); give another one, or "
            "0 for any that is free"
        ) from error
    opened.listen()
    return opened


def screen_server(parts: Sequence[ScreenPart], access: ScreenAccess) -> "Server":
    """Return the server of a screen; ``run(sockets=[...])`` serves it.

    Args:
        parts: of the screen.
        access: of the screen.
    """
    import uvicorn

    return uvicorn.Server(
        uvicorn.Config(
            screen_app(parts, access),
            access_log=False,
            lifespan="on",
            log_level="error",
            proxy_headers=False,
            server_header=False,
            timeout_graceful_shutdown=_PATIENCE,
            ws="websockets-sansio",
            ws_max_size=_MOST_RECEIVED,
            ws_per_message_deflate=False,
        )
    )


def open_browser(link: str) -> bool:
    """Open a link in the browser of this computer; return whether there is one."""
    with suppress(webbrowser.Error, OSError):
        return webbrowser.open(link)
    return False


def serve_screen(
    parts: Sequence[ScreenPart],
    *,
    say: Callable[[str], None],
    port: int = 0,
    browser: bool = True,
) -> None:
    """Serve a screen until it is interrupted.

    Args:
        parts: of the screen.
        say: takes the line with the link.
        port: TCP port; 0 for any that is free.
        browser: whether to open the browser.

    Raises:
        UsageError: the extra is not installed, or the port is taken.
    """
    require_screen_extra()
    with loopback_socket(port) as opened:
        access = ScreenAccess(opened.getsockname()[1])
        say(f"screen: {access.link()}")
        access.relinked = lambda _: say(f"link for another browser: {access.link()}")
        if browser:
            open_browser(access.link())
        with suppress(KeyboardInterrupt):
            screen_server(parts, access).run(sockets=[opened])
