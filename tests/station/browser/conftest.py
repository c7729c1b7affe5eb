"""A real Chromium, and screens served from this process."""

import shutil
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from bench_runs import CHROMIUM_FLAGS

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.browser.app.screen_part import ScreenPage, ScreenPart
from jointbench.station.browser.app.serve_screen import loopback_socket, screen_server
from jointbench.station.browser.guard.request_body import short_body
from jointbench.station.browser.guard.screen_access import ScreenAccess

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PAGE = ScreenPage("/measure", "Measure", "measure.js")


@dataclass(frozen=True)
class Screen:
    """A screen that is served."""

    access: ScreenAccess


@contextmanager
def served(parts: Sequence[ScreenPart]) -> Iterator[Screen]:
    """Serve a screen from a thread."""
    with loopback_socket() as opened:
        access = ScreenAccess(opened.getsockname()[1])
        server = screen_server(parts, access)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [opened]})
        thread.start()
        try:
            yield Screen(access)
        finally:
            server.should_exit = True
            thread.join()


@pytest.fixture
def serve() -> Callable[[Sequence[ScreenPart]], AbstractContextManager[Screen]]:
    """Return what serves parts of a screen as long as a context lasts."""
    return served


@pytest.fixture(scope="module")
def chromium() -> Iterator["Browser"]:
    """Give a headless Chromium; without one on the machine, skip."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), "")
    if not found:
        pytest.skip("no Chromium on this machine; .ci/run installs Debian's")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=str(Path(found)), args=list(CHROMIUM_FLAGS)
        )
        yield browser
        browser.close()


@pytest.fixture
def screen() -> Iterator[Screen]:
    """Serve a screen with one page, one command and one socket."""
    from starlette.requests import Request
    from starlette.responses import PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocket

    async def act(request: Request) -> Response:
        return PlainTextResponse("done")

    async def talk(socket: WebSocket) -> None:
        await socket.accept()
        await socket.send_text("hello")
        await socket.close()

    async def short(request: Request) -> Response:
        try:
            return PlainTextResponse(str(len(await short_body(request))))
        except UsageError as error:
            return PlainTextResponse(str(error), 413)

    posts = [Route("/act", act, methods=["POST"])]
    posts.append(Route("/short", short, methods=["POST"]))
    routes = (*posts, WebSocketRoute("/talk", talk))
    with served((ScreenPart((PAGE,), routes),)) as one:
        yield one
