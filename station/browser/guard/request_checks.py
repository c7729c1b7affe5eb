# SPDX-License-Identifier: MIT
"""Checks of a request before any page sees it.

A page of another site can make the browser send requests here, with cookies; a name
server can point a foreign name at this computer. Both are seen in the headers that the
browser itself writes.

Source:
    OWASP, Cross-Site Request Forgery Prevention; W3C, Fetch Metadata.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from jointbench.station.browser.guard.screen_access import ScreenAccess

_READS = frozenset({"GET", "HEAD"})
_OWN_SITES = frozenset({"same-origin", "none"})


@dataclass(frozen=True, slots=True)
class Asking:
    """What a request states about itself.

    Attributes:
        method: of HTTP; empty for a WebSocket.
        headers: by lower-case name.
        cookies: by name.
        token: of its link, None without one.
    """

    method: str
    headers: Mapping[str, str]
    cookies: Mapping[str, str]
    token: str | None = None


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """Why a request is refused.

    Attributes:
        status: of HTTP.
        words: one line.
    """

    status: int
    words: str


def refusal(asking: Asking, access: ScreenAccess) -> RequestRefused | None:
    """Return why a request is refused; None for a good one.

    Args:
        asking: the request.
        access: of the screen.
    """
    headers = asking.headers
    if headers.get("host") not in access.hosts:
        return RequestRefused(421, "this screen has another address")
    if headers.get("sec-fetch-site", "none") not in _OWN_SITES:
        return RequestRefused(403, "a request from another site")
    by_cookie = access.admits(asking.cookies.get(access.cookie))
    reads = asking.method in _READS
    if not by_cookie and not (asking.method == "GET" and access.opens(asking.token)):
        return RequestRefused(
            401,
            "no access: open the last link that the command printed; each admits one "
            "browser",
        )
    if not reads and headers.get("origin") not in access.origins:
        return RequestRefused(403, "a request from another origin")
    return None
