# SPDX-License-Identifier: MIT
"""Who may see a screen: a browser of this computer that came by a link."""

import secrets
from collections.abc import Callable
from urllib.parse import quote

LOOPBACK = "127.0.0.1"
TOKEN = "token"
"""Name of the parameter of a first link; later requests carry a cookie."""


def new_secret() -> str:
    """Return a secret of 256 bits."""
    return secrets.token_urlsafe(32)


class ScreenAccess:
    """Address and secrets of one screen.

    A token admits one browser: it is exchanged for the cookie, and another token takes
    its place. What is left of it, on a command line or in a history, opens nothing.

    Attributes:
        port: TCP port on the loopback interface.
        token: secret of the next link.
        admission: secret of the cookie.
        relinked: takes each new token.
        page_sent: called for each page, which opens its socket a moment later.
    """

    def __init__(
        self, port: int, *, token: str | None = None, admission: str | None = None
    ) -> None:
        """Make secrets, or take those that the screen had before.

        Args:
            port: TCP port on the loopback interface.
            token: of the next link; a new one by default.
            admission: of the cookie; a new one by default.
        """
        self.port = port
        self.token = token or new_secret()
        self.admission = admission or new_secret()
        self.relinked: Callable[[str], None] = lambda token: None
        self.page_sent: Callable[[], None] = lambda: None

    @property
    def cookie(self) -> str:
        """Name of the cookie; cookies ignore ports, so that the name states it."""
        return f"jointbench-{self.port}"

    @property
    def hosts(self) -> tuple[str, ...]:
        """Values of the header Host that are its own."""
        return tuple(f"{name}:{self.port}" for name in (LOOPBACK, "localhost"))

    @property
    def origins(self) -> tuple[str, ...]:
        """Values of the header Origin that are its own."""
        return tuple(f"http://{host}" for host in self.hosts)

    def link(self, path: str = "/") -> str:
        """Return the link that opens a page in the next browser."""
        return f"http://{self.hosts[0]}{path}?{TOKEN}={quote(self.token)}"

    def admits(self, secret: str | None) -> bool:
        """Return whether a cookie is that of the screen, in constant time."""
        return _same(secret, self.admission)

    def opens(self, token: str | None) -> bool:
        """Return whether a token is that of the next link, in constant time."""
        return _same(token, self.token)

    def use(self, token: str | None) -> bool:
        """Use a token up; return whether it was that of the next link."""
        if not self.opens(token):
            return False
        self.token = new_secret()
        self.relinked(self.token)
        return True


def _same(given: str | None, secret: str) -> bool:
    return secrets.compare_digest(
        (given or "").encode("utf-8", "replace"), secret.encode()
    )
