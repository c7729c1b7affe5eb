"""Measure the screen of a session: draws, CPU time, lost samples, delay of verdicts.

    python benchmarks/screen/live.py

`jointbench bench` runs on a simulated chassis in real time, 4 channels at 51.2 kS/s,
with 0, 1 and 5 pages open in headless Chromium, one of the five frozen in an endless
loop; then 100 hits with one page. Writes `docs/screen-live.md`.
"""

import argparse
import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from jointbench.acquisition.session_file.follow_log import read_log

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "screen-live.md"
HITS = """
points = ["1"]
torques = ["20 N m"]
repeats = 400
most_repeats = 400
trial_hits = 0
length = "0.5 s"
"""
RATE, CHANNELS = 51_200, 4
BLOCK = 0.05  # [s]
FLAGS = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run "
    "--disable-background-networking --disable-component-update --disable-sync"
).split()
DRAWS = "document.querySelector('canvas.scope').draws"
WATCH = """() => {
  window.seen = [];
  const at = document.getElementById("verdict");
  new MutationObserver(() => window.seen.push(
    [at.textContent, (performance.timeOrigin + performance.now()) / 1000]))
    .observe(at, { childList: true, characterData: true, subtree: true });
}"""


def hasten(priority: int) -> None:
    """Give all threads of Chromium the priority of this process.

    Its processes choose lower ones, so that on a busy computer a page would starve.
    """
    if not priority:
        return
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            chromium = b"/chromium" in (folder / "cmdline").read_bytes()
            if chromium and os.getpid() in ancestors(int(folder.name)):
                for task in (folder / "task").iterdir():
                    os.setpriority(os.PRIO_PROCESS, int(task.name), priority)


def ancestors(pid: int) -> Iterator[int]:
    """Yield the processes that a process descends from."""
    while pid > 1:
        pid = int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
        yield pid


@dataclass(frozen=True)
class Live:
    """One run.

    Attributes:
        pages: that were open.
        draws: per second in the first page; None without one.
        server: CPU time of the server over time [-].
        lost: samples.
        hits: that were judged.
    """

    pages: int
    draws: float | None
    server: float
    lost: int
    hits: int


@contextmanager
def bench(folder: Path) -> Iterator[tuple[str, int, Path]]:
    """Run a session; give its link, the process of its server, and its file."""
    text = (ROOT / "examples" / "plates.toml").read_text().replace("25.6", "51.2")
    head, _, rest = text.partition("[hits]")
    plan, out = folder / "plan.toml", folder / "s.h5"
    plan.write_text(f"{head}[hits]{HITS}\n[joint]{rest.partition('[joint]')[2]}")
    log = folder / "log.txt"
    command = [
        sys.executable,
        "-m",
        "jointbench",
        "bench",
        str(plan),
        "--out",
        str(out),
    ]
    command += ["--source", "sim:plates?seed=1&speed=1", "--no-browser"]
    command += ["--json", str(folder / "s.json")]
    with log.open("w") as lines:
        process = subprocess.Popen(
            command,
            stdout=lines,
            stderr=subprocess.STDOUT,
        )
    while not (found := re.search(r"http://\S+", log.read_text())):
        time.sleep(0.2)
        assert process.poll() is None, log.read_text()
    while not out.exists():
        time.sleep(0.2)
    try:
        yield found[0], server_of(process.pid), out
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(120)


def server_of(pid: int) -> int:
    """Return the process that serves the screen."""
    children = Path(f"/proc/{pid}/task").glob("*/children")
    for child in " ".join(one.read_text() for one in children).split():
        if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes():
            return int(child)
    raise AssertionError("no screen is served")


def cpu(pid: int) -> float:
    """Return the CPU time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def opened(browser: Browser, link: str, first: Page | None = None) -> Page:
    """Open a page and wait for its first hit.

    A link admits one browser: further pages come with the cookie of the first.
    """
    known = None if first is None else first.context.storage_state()
    context = browser.new_context(
        viewport={"width": 1400, "height": 1000}, storage_state=known
    )
    page = context.new_page()
    page.goto(link if first is None else link.partition("?")[0])
    page.locator("#verdict", has_text="HIT").wait_for(timeout=120_000)
    return page


def live(browser: Browser, pages: int, seconds: float, priority: int) -> Live:
    """Run with a number of pages; the last of five is frozen."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with bench(folder) as (link, server, _):
            shown: list[Page] = []
            for _ in range(pages):
                shown.append(opened(browser, link, *shown[:1]))
            if pages > 1:
                shown[-1].evaluate("() => { setTimeout(() => { for (;;); }, 0); }")
            hasten(priority)
            time.sleep(3.0)
            began, spent = time.monotonic(), cpu(server)
            first = shown[0].evaluate(DRAWS) if shown else 0
            time.sleep(seconds)
            last = shown[0].evaluate(DRAWS) if shown else 0
            over = time.monotonic() - began
            spent = (cpu(server) - spent) / over
            for page in shown[: pages - 1 if pages > 1 else pages]:
                page.context.close()
        content = json.loads((folder / "s.json").read_text())
    draws = (last - first) / over if shown else None
    return Live(pages, draws, spent, content["lost_samples"], len(content["hits"]))


def delays(browser: Browser, hits: int, priority: int) -> list[float]:
    """Return the time from the last sample of each hit to its verdict on the page [s].

    The time of a sample is the earliest at which any sample, so much later or earlier,
    was seen by the measuring program; that is at most a block after it was made, and a
    block is added.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with bench(folder) as (link, _, out):
            page = opened(browser, link)
            page.evaluate(WATCH)
            hasten(priority)
            page.locator("#verdict", has_text=f"HIT {hits + 3}").wait_for(
                timeout=3_600_000
            )
            seen: list[tuple[str, float]] = page.evaluate("window.seen")
            page.context.close()
        entries, _ = read_log(out)
    return list(_delays(entries, seen))[:hits]


def _delays(
    entries: tuple[dict[str, Any], ...], seen: list[tuple[str, float]]
) -> Iterator[float]:
    begun = min(e["time"] - e["stored"] / RATE for e in entries if e["stored"])
    shown: dict[int, float] = {}
    for text, at in seen:
        shown.setdefault(int(text.split()[1]), at)
    for entry in entries:
        number = entry.get("number", -2) + 1
        if entry["kind"] == "hit" and number in shown:
            yield shown[number] - (begun + entry["stop"] / RATE) + BLOCK


def page_text(runs: list[Live], waited: list[float], priority: int) -> str:
    """Return the page."""
    rows = "\n".join(
        f"| {one.pages}{', one frozen' if one.pages > 1 else ''} | "
        f"{'' if one.draws is None else f'{one.draws:.1f}'} | "
        f"{100 * one.server:.1f} % | "
        f"{one.lost} | {one.hits} |"
        for one in runs
    )
    waited = sorted(waited)
    load = ", ".join(f"{one:.0f}" for one in os.getloadavg())
    return f"""# The screen of a session, live
Written by `python benchmarks/screen/live.py`. `jointbench bench`, simulated chassis in real time, {CHANNELS} channels at {RATE / 1000:g} kS/s in blocks of {1000 * BLOCK:g} ms, pages in headless Chromium with `--disable-gpu`,
{os.cpu_count()} cores shared with other work: load averages {load}; session, server and Chromium ran at nice {priority}.

| open pages | draws/s of the first | CPU of the server, of one core | samples lost | hits judged |
|---|---|---|---|---|
{rows}

A page plays the signals out evenly, 25 times a second and some 70 ms late, so that blocks that come with jitter are not seen; a draw is counted where it shows bins that the one before did not. The frozen page runs an endless loop; it hinders neither server nor recorder.
The counts of the bar are those of a quiet machine: `python benchmarks/screen/live.py --seconds 60 --hits 100` takes some six minutes and writes this page.

## Delay of a verdict
From the last sample of the record of a hit to the verdict on the page, {len(waited)} hits: median {statistics.median(waited):.2f} s, 90 % below {waited[int(0.9 * len(waited))]:.2f} s, largest {waited[-1]:.2f} s. It includes a block of {1000 * BLOCK:g} ms that a sample waits for at most.

## Reload and loss
A test in `tests/station/browser/test_bench_in_chromium.py` reloads the page and kills the server in the middle of a session of 3 points at 2 torques: the page shows the same hit again, connects to the next server by itself,
and all 12 good hits are averaged, none of them lost.
"""  # noqa: E501


def main() -> None:
    """Run everything, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--hits", type=int, default=100)
    given = parser.parse_args()
    priority = os.nice(0)
    runs = []
    for count in (0, 1, 5):
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path="/usr/bin/chromium", args=FLAGS
            )
            runs.append(live(browser, count, given.seconds, priority))
            print(runs[-1], flush=True)
            if count < 5:
                browser.close()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=FLAGS
        )
        waited = delays(browser, given.hits, priority)
    print(statistics.median(waited), max(waited), flush=True)
    PAGE.write_text(page_text(runs, waited, priority), encoding="utf-8")


if __name__ == "__main__":
    main()
