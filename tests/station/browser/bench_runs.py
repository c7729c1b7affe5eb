"""A session that `bench` measures on the simulated chassis, and pages on it."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jointbench.station.bench_view.send_command import run_send

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

# Without a sandbox, as root in a container needs it, and without requests of its own.
CHROMIUM_FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
FATES = "good*3,overload,good*3,double,good*99"
HOSTILE = "<img src=x onerror=alert(1)>"
SOON = 240_000  # [ms] on a machine with other work


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


# WCAG 2.2: 4.5:1 for every text on the first ground below it that is not transparent.
ILLEGIBLE = """() => {
  // A mixture of colours reads `color(srgb 0.8 0.9 1)`, others `rgb(204, 230, 255)`.
  const numbers = text => {
    if (!/^(rgba?[(]|color[(]srgb )/.test(text)) throw new Error(`colour ${text}`);
    const unit = text.startsWith('color') ? 255 : 1;
    const [r, g, b, ...a] = text.match(/[0-9.]+(e-[0-9]+)?/g).map(Number);
    return [unit * r, unit * g, unit * b, ...a];
  };
  const part = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  const ground = e => {
    for (; e; e = e.parentElement) {
      const c = numbers(getComputedStyle(e).backgroundColor);
      if (c.length < 4 || c[3] > 0.99) return c;
    }
    return [255, 255, 255];
  };
  const found = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const words = texts.currentNode.textContent.trim();
    const e = texts.currentNode.parentElement;
    if (!words || !e.checkVisibility() || e.closest('[disabled]')) continue;
    const style = getComputedStyle(e);
    const ink = light(numbers(e.ownerSVGElement ? style.fill : style.color));
    const paper = light(ground(e));
    const ratio = (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
    if (ratio < 4.5) found.push(`${ratio.toFixed(1)} ${words}`);
  }
  const beyond = document.documentElement.scrollWidth - innerWidth;
  return beyond > 0 ? [...found, `${beyond} px beyond the window`] : found;
}"""


@dataclass
class Bench:
    """A session that runs.

    Attributes:
        log: what the command printed.
        process: that measures.
        file: of the session.
    """

    log: Path
    process: "subprocess.Popen[str]"
    file: Path

    def link(self) -> str:
        """Return the link for the next browser, printed last; each admits one."""
        until = time.monotonic() + SOON / 1000
        while self.process.poll() is None and time.monotonic() < until:
            found = re.findall(r"http://\S+", self.log.read_text())
            if found:
                return str(found[-1])
            time.sleep(0.2)
        raise AssertionError(self.log.read_text())

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
        yield Bench(log, process, folder / "s.h5")
    except Exception as error:
        error.add_note(f"exit code {process.poll()}, printed: {log.read_text()}")
        raise
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextmanager
def opened(chromium: "Browser", link: str) -> Iterator["Page"]:
    """Open a link; no request may leave this computer, and no script may fail."""
    with chromium.new_context() as context:
        context.set_default_timeout(SOON)
        page = context.new_page()
        foreign: list[str] = []
        page.on(
            "request",
            lambda r: foreign.append(r.url) if "//127.0.0.1:" not in r.url else None,
        )
        page.on("pageerror", lambda error: foreign.append(str(error)))
        page.on("dialog", lambda dialog: foreign.append(dialog.message))
        page.goto(link)
        try:
            yield page
        except Exception as error:
            error.add_note(seen(page, foreign))
            raise
        assert not foreign


def seen(page: "Page", foreign: list[str]) -> str:
    """Return what a page showed when a test ended, for its failure."""
    with suppress(Exception):  # the browser may be gone
        text = page.locator("body").inner_text(timeout=5_000)
        return f"{page.url} showed: {text}\noutside of it: {foreign}"
    return "the page does not answer"


def legible(page: "Page") -> None:
    """Every text has contrast, light and dark; on a phone nothing scrolls sideways."""
    usual = page.viewport_size
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for width in (1400, 400):
            page.set_viewport_size({"width": width, "height": 900})
            # Plots follow the window a moment later.
            with suppress(Exception):
                page.wait_for_function(f"() => !({ILLEGIBLE})().length", timeout=SOON)
            found = page.evaluate(ILLEGIBLE)
            assert not found, (page.url, scheme, width, found)
    page.emulate_media(color_scheme="light")
    if usual is not None:
        page.set_viewport_size(usual)


def paused_after(running: Bench, *, hits: int) -> None:
    """Pause from another terminal: a page opens late on a busy machine."""
    until = time.monotonic() + SOON / 1000
    while f"hit {hits} " not in running.log.read_text():
        assert time.monotonic() < until, running.log.read_text()
        time.sleep(0.1)
    assert run_send(running.file, "pause", json_target=None)


def typed(page: "Page", key: str, text: str) -> None:
    """Press a key that asks for a line, type it, and send it."""
    page.keyboard.press(key)
    page.locator("dialog input").wait_for()
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def answered(page: "Page", words: str) -> None:
    """Wait for the answer to a command."""
    page.locator("#answer", has_text=words).wait_for()
