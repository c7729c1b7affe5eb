# SPDX-License-Identifier: MIT
"""How long the screen of a finished session is served."""

import threading
import time
from pathlib import Path
from urllib.request import HTTPCookieProcessor, Request, build_opener

import pytest
from websockets.sync.client import connect

from jointbench.station.browser.bench.screen_process import ScreenProcess
from jointbench.station.session_events.command_queue import CommandQueue

MODULE = "jointbench.station.browser.bench.screen_process"


def test_a_screen_that_opens_late_is_awaited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From one page to the next no screen is open; the next one may take its time.

    Once that time is over too, the server is left.
    """
    monkeypatch.setattr(f"{MODULE}._UNWATCHED", 0.2)
    monkeypatch.setattr(f"{MODULE}._OPENING", 4.0)
    with ScreenProcess(tmp_path / "s.h5", CommandQueue()) as screen:
        screen.finished(tmp_path / "s.h5")
        cookies = HTTPCookieProcessor()
        browser = build_opener(cookies)
        browser.open(screen.access.link("/measure"), timeout=60).close()
        (cookie,) = cookies.cookiejar
        host, origin = screen.access.hosts[0], screen.access.origins[0]
        with connect(
            f"ws://{host}/desk/open",
            origin=origin,  # type: ignore[arg-type]
            additional_headers={"Cookie": f"{cookie.name}={cookie.value}"},
        ):
            time.sleep(0.5)  # the measuring program has seen it
        browser.open(Request(f"http://{host}/poles"), timeout=60).close()
        lingering = threading.Thread(target=screen.linger)
        lingering.start()
        lingering.join(1.5)
        assert lingering.is_alive()
        lingering.join(30.0)
        assert not lingering.is_alive()
