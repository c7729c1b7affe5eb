"""Who may see a screen, and who may not: requests as a hostile page would send them."""

import asyncio
import http.client
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.browser.app import screen_extra
from jointbench.station.browser.app.screen_extra import require_screen_extra
from jointbench.station.browser.app.serve_screen import loopback_socket
from jointbench.station.browser.guard.screen_access import ScreenAccess


class Served(Protocol):
    """A screen that is served."""

    @property
    def access(self) -> ScreenAccess:
        """Return its address and secret."""
        ...


def ask(
    screen: Served, method: str, path: str, headers: Mapping[str, str] | None = None
) -> http.client.HTTPResponse:
    """Send one request; the answer is read whole."""
    link = http.client.HTTPConnection("127.0.0.1", screen.access.port, timeout=60)
    try:
        link.request(method, path, headers=dict(headers or {}))
        answer = link.getresponse()
        answer.read()
        return answer
    finally:
        link.close()


def cookie(screen: Served) -> dict[str, str]:
    """Return the header of a browser that has opened the link."""
    return {"Cookie": f"{screen.access.cookie}={screen.access.admission}"}


def own(screen: Served) -> dict[str, str]:
    """Return the headers of the screen's own page."""
    return {**cookie(screen), "Origin": screen.access.origins[0]}


@pytest.mark.parametrize("path", ["/", "/measure", "/assets/screen.css", "/nowhere"])
def test_without_a_token_nothing_is_shown(screen: Served, path: str) -> None:
    """Whoever finds the port learns nothing, not even which pages there are."""
    assert ask(screen, "GET", path).status == 401


def test_a_wrong_token_opens_nothing(screen: Served) -> None:
    """A token of another screen is none."""
    assert ask(screen, "GET", "/measure?token=abc").status == 401


def test_the_link_turns_its_token_into_a_cookie_of_this_port(screen: Served) -> None:
    """The secret leaves the address line, and no script can read it."""
    answer = ask(screen, "GET", f"/measure?hit=3&token={screen.access.token}")
    given = answer.headers["set-cookie"]
    assert answer.status == 303
    assert answer.headers["location"] == "/measure?hit=3"
    assert given.startswith(f"jointbench-{screen.access.port}=")
    assert "HttpOnly" in given
    assert "samesite=strict" in given.lower()


def test_a_token_admits_one_browser(screen: Served) -> None:
    """What is left of it in a list of processes or a history opens nothing."""
    used = f"/measure?token={screen.access.token}"
    assert ask(screen, "GET", used).status == 303
    assert ask(screen, "GET", used).status == 401
    assert ask(screen, "GET", used, cookie(screen)).status == 303
    assert screen.access.token not in used
    assert ask(screen, "GET", f"/measure?token={screen.access.token}").status == 303


def test_the_cookie_is_another_secret_than_the_token(screen: Served) -> None:
    """A link that was seen is no cookie."""
    given = {"Cookie": f"{screen.access.cookie}={screen.access.token}"}
    assert ask(screen, "GET", "/measure", given).status == 401


def test_a_body_without_end_is_not_read(screen: Served) -> None:
    """More than any page sends is refused before the rest has come."""
    link = http.client.HTTPConnection("127.0.0.1", screen.access.port, timeout=60)
    link.putrequest("POST", "/short")
    for name, value in {**own(screen), "Content-Length": "1000000000"}.items():
        link.putheader(name, value)
    link.endheaders()
    link.send(b"x" * 10_000)
    answer = link.getresponse()
    assert answer.status == 413
    assert b"longer than 4096 bytes" in answer.read()
    link.close()


def test_a_link_leads_to_no_other_host(screen: Served) -> None:
    """Two slashes in front would name another host in the redirection."""
    path = f"//evil.example/x?token={screen.access.token}"
    assert ask(screen, "GET", path).headers["location"] == "/evil.example/x"


def test_with_the_cookie_the_page_is_shown(screen: Served) -> None:
    """A reload needs no token."""
    assert ask(screen, "GET", "/measure", cookie(screen)).status == 200


def test_a_foreign_name_that_points_here_is_refused(screen: Served) -> None:
    """A name server that answers 127.0.0.1 for evil.example (DNS rebinding)."""
    headers = {**cookie(screen), "Host": f"evil.example:{screen.access.port}"}
    assert ask(screen, "GET", "/measure", headers).status == 421


@pytest.mark.parametrize("origin", ["http://evil.example", "null", ""])
def test_a_command_from_another_origin_is_refused(screen: Served, origin: str) -> None:
    """The browser would send the cookie if its SameSite rule failed."""
    headers = cookie(screen) | ({"Origin": origin} if origin else {})
    assert ask(screen, "POST", "/act", headers).status == 403


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_a_request_that_another_site_caused_is_refused(
    screen: Served, site: str
) -> None:
    """The browser itself states where a request comes from (Fetch Metadata)."""
    headers = {**own(screen), "Sec-Fetch-Site": site}
    assert ask(screen, "GET", "/measure", headers).status == 403
    assert ask(screen, "POST", "/act", headers).status == 403


def test_a_command_of_the_own_page_is_done(screen: Served) -> None:
    """With cookie and origin."""
    headers = {**own(screen), "Sec-Fetch-Site": "same-origin"}
    assert ask(screen, "POST", "/act", headers).status == 200


def test_a_token_in_the_link_of_a_command_is_not_enough(screen: Served) -> None:
    """A token opens pages; commands need the cookie."""
    headers = {"Origin": screen.access.origins[0]}
    path = f"/act?token={screen.access.token}"
    assert ask(screen, "POST", path, headers).status == 401


@pytest.mark.parametrize("origin", ["http://evil.example", None])
def test_a_socket_from_elsewhere_is_refused(screen: Served, origin: str | None) -> None:
    """Browsers let any page open a socket, and send the cookies of its host."""
    from websockets.asyncio.client import connect
    from websockets.exceptions import InvalidStatus
    from websockets.typing import Origin

    async def talk(from_: str | None, headers: Mapping[str, str]) -> str:
        link = f"ws://{screen.access.hosts[0]}/talk"
        sent = None if from_ is None else Origin(from_)
        async with connect(
            link, origin=sent, additional_headers=headers, open_timeout=60
        ) as socket:
            return str(await socket.recv())

    def said(from_: str | None, headers: Mapping[str, str]) -> str:
        # A browser of another test keeps a loop of events in this thread.
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(lambda: asyncio.run(talk(from_, headers))).result()

    with pytest.raises(InvalidStatus, match="403"):
        said(origin, cookie(screen))
    with pytest.raises(InvalidStatus, match="403"):
        said(screen.access.origins[0], {})
    assert said(screen.access.origins[0], cookie(screen)) == "hello"


def test_every_answer_forbids_scripts_but_its_own_files(screen: Served) -> None:
    """No inline script, no foreign host; refusals carry the headers as well."""
    for headers in ({}, cookie(screen)):
        policy = ask(screen, "GET", "/measure", headers).headers[
            "content-security-policy"
        ]
        rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
        assert rules["default-src"] == "'none'"
        assert rules["script-src"] == "'self'"
        assert "unsafe" not in policy
        assert "http:" not in policy


def test_the_screen_listens_on_this_computer_only(screen: Served) -> None:
    """Other computers have no way in."""
    with loopback_socket() as opened:
        assert opened.getsockname()[0] == "127.0.0.1"


def test_a_port_that_is_taken_is_named(screen: Served) -> None:
    """One line, with the way out."""
    with pytest.raises(UsageError, match=rf"{screen.access.port}.*another one"):
        loopback_socket(screen.access.port)


def test_without_the_extra_one_line_states_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without starlette, uvicorn or websockets."""
    monkeypatch.setattr(screen_extra, "find_spec", lambda name: None)
    with pytest.raises(UsageError, match=r"pip install 'jointbench\[screen\]'"):
        require_screen_extra()
