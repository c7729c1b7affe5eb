"""A session in a real Chromium, by keys alone, on the simulated chassis."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.store import read_session

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
FATES = "good*3,overload,good*3,double,good*99"
HOSTILE = "<img src=x onerror=alert(1)>"
SOON = 60_000  # [ms] on a machine with other work


def plan_file(folder: Path) -> Path:
    """Return a plan of 3 points x 2 torques, with markup for a channel's name."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    text = text.replace('["1", "2", "3", "4", "5"]', '["1", "2", "3"]')
    text = text.replace('["20 N m", "50 N m", "80 N m"]', '["20 N m", "50 N m"]')
    text = text.replace("repeats = 3", 'repeats = 2\ntrial_hits = 1\nlength = "0.4 s"')
    text = text.replace('name = "a6"', f'name = "{HOSTILE}"')
    path = folder / "plan.toml"
    path.write_text(text, encoding="utf-8")
    return path


@dataclass
class Bench:
    """A session that runs.

    Attributes:
        link: of its screen.
        process: that measures.
        file: of the session.
    """

    link: str
    process: "subprocess.Popen[str]"
    file: Path
    lines: list[str] = field(default_factory=list)

    def server(self) -> int:
        """Return the process that serves the screen."""
        tasks = Path(f"/proc/{self.process.pid}/task").glob("*/children")
        for child in " ".join(task.read_text() for task in tasks).split():
            line = Path(f"/proc/{child}/cmdline").read_bytes()
            # The screen's process is spawned, the recorder's is forked from a server.
            if b"spawn_main" in line:
                return int(child)
        raise AssertionError("no screen is served")


@contextmanager
def bench(folder: Path, *options: str) -> Iterator[Bench]:
    """Run a session with its screen."""
    command = [sys.executable, "-m", "jointbench", "bench", str(plan_file(folder))]
    source = f"sim:plates?seed=1&speed=2&fates={FATES}"
    command += ["--out", str(folder / "s.h5"), "--source", source, "--no-browser"]
    log = folder / "log.txt"
    with log.open("w") as out:
        process = subprocess.Popen(
            [*command, *options], stdout=out, stderr=subprocess.STDOUT, text=True
        )
    try:
        yield Bench(first_link(log, process), process, folder / "s.h5")
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def first_link(log: Path, process: "subprocess.Popen[str]") -> str:
    """Return the link that the command prints."""
    while process.poll() is None:
        found = re.search(r"http://\S+", log.read_text())
        if found:
            return found[0]
        time.sleep(0.1)
    raise AssertionError(log.read_text())


@contextmanager
def opened(chromium: "Browser", link: str) -> Iterator["Page"]:
    """Open a link; no request may leave this computer, and no script may fail."""
    with chromium.new_context() as context:
        page = context.new_page()
        foreign: list[str] = []
        page.on(
            "request",
            lambda r: foreign.append(r.url) if "//127.0.0.1:" not in r.url else None,
        )
        page.on("pageerror", lambda error: foreign.append(str(error)))
        page.on("dialog", lambda dialog: foreign.append(dialog.message))
        page.goto(link)
        yield page
        assert not foreign


def typed(page: "Page", key: str, text: str) -> None:
    """Press a key that asks for a line, type it, and send it."""
    page.keyboard.press(key)
    page.locator("dialog input").wait_for()
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def answered(page: "Page", words: str) -> None:
    """Wait for the answer to a command."""
    page.locator("#answer", has_text=words).wait_for(timeout=SOON)


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_a_session_by_keys_alone_survives_reload_and_loss_of_its_server(
    chromium: "Browser", tmp_path: Path
) -> None:
    """Three points, two torques, one overload, one double hit, one hit rejected.

    Neither bad hit is averaged; after a reload, and after the server was killed, the
    screen shows the same session, which continued meanwhile.
    """
    with bench(tmp_path, "--json", str(tmp_path / "s.json")) as running:
        with opened(chromium, running.link) as page:
            page.locator("#verdict", has_text="HIT 2").wait_for(timeout=SOON)
            assert "token" not in page.url
            page.keyboard.press("Space")
            page.locator("#task", has_text="PAUSE").wait_for(timeout=SOON)
            page.keyboard.press("a")
            answered(page, "not done: the session pauses")
            typed(page, "t", "bolt 2 rubs <b>a lot</b>")
            answered(page, "noted: bolt 2 rubs <b>a lot</b>")
            before = page.locator("#verdict").inner_text()
            page.reload()
            page.locator("#verdict", has_text=before.split("  ")[0]).wait_for()
            page.keyboard.press("Space")
            answered(page, "the session continues")
            typed(page, "h", "2")
            answered(page, "hit 2 is rejected")
            os.kill(running.server(), signal.SIGKILL)
            page.locator(".trouble:not([hidden])").wait_for(timeout=SOON)
            page.locator(".trouble[hidden]").wait_for(timeout=SOON, state="attached")
            page.keyboard.press("w")
            answered(page, "seen")
            page.locator("button", has_text=HOSTILE).wait_for()
            page.locator("#task", has_text="END").wait_for(timeout=SOON)
            assert page.locator("canvas").count() >= 6
            assert page.locator(".badge").inner_text() == "SIMULATED"
        assert running.process.wait(60) == 0
    content = json.loads((tmp_path / "s.json").read_text())
    counts = content["verdicts"]
    assert counts["overload"] == counts["double"] == 1
    assert counts["ok"] == 12
    assert content["hits"][1]["verdict"] == "operator"
    assert content["lost_samples"] == 0
    session = read_session(running.file)
    averaged = [
        h for r in session.recordings for h in r.hits if h.verdict is Verdict.OK
    ]
    assert len(averaged) == 12
