# SPDX-License-Identifier: MIT
"""Who may see a screen: whoever holds its token, on this computer."""

import secrets
from dataclasses import dataclass, field
from urllib.parse import quote

LOOPBACK = "127.0.0.1"
TOKEN = "token"
"""Name of the parameter of the first link; later requests carry a cookie."""


@dataclass(frozen=True, slots=True)
class ScreenAccess:
    """Address and secret of one screen.

    Attributes:
        port: TCP port on the loopback interface.
        token: secret of the screen.
    """

    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(32), repr=False)

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
        """Return the link that opens a page of the screen for the first time."""
        return f"http://{self.hosts[0]}{path}?{TOKEN}={quote(self.token)}"

    def opens(self, secret: str | None) -> bool:
        """Return whether a secret is that of the screen, in constant time."""
        given = (secret or "").encode("utf-8", "replace")
        return secrets.compare_digest(given, self.token.encode())
