"""A session in a real Chromium, by keys alone, on the simulated chassis."""

import json
import os
import shutil
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from bench_runs import (
    CHROMIUM_FLAGS,
    HOSTILE,
    SOON,
    Bench,
    answered,
    bench,
    legible,
    opened,
    paused_after,
    typed,
)

from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.desk.desk_choice import choices_of
from jointbench.station.results.results_modes import read_run

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")

# A model of two rigid bodies cannot bend; `gap` is to end as unknown, with one effect
# tried.
MODEL = f"""
[bodies.lower]
mass = "9.75 kg"
mass_sd = "0.05 kg"
channel = "{HOSTILE}"
points = ["6"]
[bodies.upper]
mass = "9.75 kg"
mass_sd = "0.05 kg"
channel = "a1"
points = ["1", "2", "3"]
[links.ground]
between = ["ground", "lower"]
stiffness = "2e8 N/m"
stiffness_sd = "1e8 N/m"
damping = "200 N s/m"
damping_sd = "100 N s/m"
[links.joint]
between = ["lower", "upper"]
stiffness = "1e9 N/m"
stiffness_sd = "5e8 N/m"
damping = "500 N s/m"
damping_sd = "300 N s/m"
joint = true
[gap]
preload_reference = "25 kN"
"""
LEFT_OUT = (
    "cubic_stiffness,quadratic_stiffness,gap,jenkins,iwan,bouc_wen,coulomb,"
    "quadratic_damping,saturation,hum,maxwell,extra_damping,added_mass,hidden_mode,"
    "preload_damping,loosening,delay,sensor_lowpass,polarity,cross_talk"
)
UNNAMED = """() => [...document.querySelectorAll(
    'button, a, select, input, canvas, meter, progress, [role=slider], [role=img]')]
  .filter(e => e.checkVisibility() && e.getAttribute('aria-hidden') !== 'true')
  .filter(e => !e.parentElement.closest('[role=img]'))
  .filter(e => !e.textContent.trim() && !e.ariaLabel && !e.labels?.length)
  .map(e => e.outerHTML)"""


def hit_counts(running: Bench) -> dict[str, int]:
    """Return how many hits of each verdict the finished session holds."""
    session = read_session(running.file)
    verdicts = [h.verdict for r in session.recordings for h in r.hits]
    return {one.value: verdicts.count(one) for one in Verdict}


@pytest.mark.heavy(reason="a whole session, its poles, `gap` and the report, in one")
def test_from_the_first_hit_to_the_report_by_keys(
    chromium: "Browser", tmp_path: Path
) -> None:
    """Three points, two torques, an overload, a double hit; then poles to report.

    All on one server. Neither bad hit is averaged; after a reload, and after the server
    was killed, the screen shows the same session, which continued meanwhile.
    """
    with bench(tmp_path, "--json", str(tmp_path / "s.json")) as running:
        paused_after(running, hits=8)  # the overload and the double one are past
        with opened(chromium, running.link()) as page:
            measured_by_keys(page, running)
            page.keyboard.press("Tab")  # from the note's field to the page
            page.locator("#to-poles").focus()
            page.keyboard.press("Enter")
            poles_by_keys(page)
            shapes_and_gap(page, tmp_path, running)
            reported(page, tmp_path)
        assert running.process.wait(300) == 0
    content = json.loads((tmp_path / "s.json").read_text())
    counts = content["verdicts"]
    assert counts["overload"] == counts["double"] == 1
    assert counts["ok"] == 12
    assert content["hits"][1]["verdict"] == "operator"
    assert content["lost_samples"] == 0
    assert hit_counts(running)["ok"] == 12


def measured_by_keys(page: "Page", running: Bench) -> None:
    """Pause, note, reject, reload; the server dies; the session ends."""
    page.locator("#task", has_text="PAUSE").wait_for()
    assert "token" not in page.url
    page.keyboard.press("Space")
    answered(page, "the session continues")
    page.keyboard.press("Space")
    answered(page, "hits are ignored until the session continues")
    page.locator("#task", has_text="PAUSE").wait_for()
    page.keyboard.press("a")
    answered(page, "not done: the session pauses")
    typed(page, "t", "bolt 2 rubs <b>a lot</b>")
    answered(page, "noted: bolt 2 rubs <b>a lot</b>")
    before = page.locator("#verdict").inner_text()
    looked_at_setup(page)
    page.reload()
    page.locator("#verdict", has_text=before.split("  ")[0]).wait_for()
    assert page.evaluate(UNNAMED) == []
    legible(page)
    page.keyboard.press("Space")
    answered(page, "the session continues")
    typed(page, "h", "2")
    answered(page, "hit 2 is rejected")
    os.kill(running.server(), signal.SIGKILL)
    page.locator(".trouble:not([hidden])").wait_for()
    page.locator(".trouble[hidden]").wait_for(state="attached")
    page.keyboard.press("w")
    answered(page, "seen")
    page.locator("button", has_text=HOSTILE).wait_for()
    page.locator("#task", has_text="END").wait_for()
    assert page.locator("canvas").count() >= 6
    assert page.locator(".badge").inner_text() == "SIMULATED"


def looked_at_setup(page: "Page") -> None:
    """See channels, their sensors and the proposals; the desk waits for the end."""
    page.get_by_role("link", name="Setup").press("Enter")
    page.locator("td", has_text="TEDS").first.wait_for()
    page.get_by_role("slider", name="trigger level").wait_for()
    page.locator("meter").nth(3).wait_for()
    assert page.evaluate(UNNAMED) == []
    legible(page)
    page.get_by_role("link", name="Poles").press("Enter")
    page.locator(".waiting", has_text="is being measured").wait_for()
    page.get_by_role("link", name="Measure").press("Enter")
    page.locator("#task", has_text="PAUSE").wait_for()


def poles_by_keys(page: "Page") -> None:
    """Pin the pole under the cursor, and see it in the table."""
    page.locator("canvas.pole-chart").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("p")
    page.locator(".desk-grid tbody tr", has_text="pinned").first.wait_for()
    page.locator(".desk-message", has_text="written").wait_for()
    assert page.evaluate(UNNAMED) == []
    legible(page)


def shapes_and_gap(page: "Page", folder: Path, running: Bench) -> None:
    """Look at the shapes; have `gap` judge the session, and read its verdict."""
    page.get_by_role("link", name="Shapes").press("Enter")
    page.locator("canvas.shape-view").wait_for()
    assert page.evaluate(UNNAMED) == []
    legible(page)
    page.get_by_role("link", name="Joint and gap").press("Enter")
    page.locator("pre", has_text="jointbench gap").wait_for()
    (folder / "bench.toml").write_text(MODEL, encoding="utf-8")
    found = folder / "s.gap.json"
    command = [sys.executable, "-m", "jointbench", "gap", str(running.file)]
    command += ["--model", str(folder / "bench.toml"), "--without", LEFT_OUT]
    subprocess.run(
        [*command, "--json", str(found)], check=True, capture_output=True, timeout=300
    )
    page.reload()
    page.locator(".verdict-line", has_text="no known effect explains").wait_for()
    reason = str(json.loads(found.read_text())["reason"])
    assert reason in page.locator("section[aria-label=Gap]").inner_text()
    legible(page)


def reported(page: "Page", folder: Path) -> None:
    """Write the report, open its file, and find the choice in it."""
    page.get_by_role("link", name="Report").press("Enter")
    page.get_by_role("button", name="Write the report").press("Enter")
    page.locator("code", has_text="s.html").first.wait_for()
    legible(page)
    with page.context.expect_page() as other:
        page.get_by_role("link", name="Open it").press("Enter")
    other.value.locator("h1").first.wait_for()
    legible(other.value)
    results = next(folder.glob("s.*N.results.h5"))
    assert results.name in other.value.locator("body").inner_text()
    choices = choices_of(read_run(results).modes[0].steps)
    assert [one.action for one in choices] == ["pin"]


def test_a_browser_that_is_killed_loses_no_hit(
    chromium: "Browser", tmp_path: Path
) -> None:
    """The whole process dies; `measure` continues, and a new browser sees the same."""
    from playwright.sync_api import Error

    mark = f"--killed-by-a-test={tmp_path.name}"
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    with bench(tmp_path, "--json", str(tmp_path / "s.json")) as running:
        paused_after(running, hits=3)
        first = chromium.browser_type.launch(
            executable_path=found, args=[*CHROMIUM_FLAGS, mark]
        )
        page = first.new_page()
        page.goto(running.link())
        page.locator("#task", has_text="PAUSE").wait_for(timeout=SOON)
        page.keyboard.press("Space")
        page.locator("#answer", has_text="the session continues").wait_for(timeout=SOON)
        os.kill(process_with(mark), signal.SIGKILL)
        with pytest.raises(Error):
            page.reload()
        with opened(chromium, running.link()) as again:
            again.locator("#task", has_text="END").wait_for()
            shown = again.locator(".counts").inner_text()
        assert running.process.wait(300) == 0
    content = json.loads((tmp_path / "s.json").read_text())
    assert content["verdicts"]["ok"] == 12
    assert content["lost_samples"] == 0
    assert hit_counts(running)["ok"] == 12
    assert "6 of 6" in shown


def process_with(mark: str) -> int:
    """Return the process of a browser that was started with a mark."""
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            line = (folder / "cmdline").read_bytes().split(b"\0")
            if mark.encode() in line and not any(a.startswith(b"--type") for a in line):
                return int(folder.name)
    raise AssertionError("the browser does not run")
