# SPDX-License-Identifier: MIT
"""The modal desk in a real Chromium: a click chooses, a box clears, and it is kept."""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from bench_runs import ILLEGIBLE, legible
from desk_files import COLUMNS, write_frfs

from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.station.browser.app.screen_part import ScreenPart
from jointbench.station.browser.desk.desk_board import DeskBoard
from jointbench.station.browser.desk.desk_routes import desk_part
from jointbench.station.desk.desk_choice import choices_of
from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects
from jointbench.station.results.results_modes import read_run

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

SCRIPT = "<img src=x onerror=alert(1)>"
# One value of each shade below the darkest; what is measured seldom has them.
SHADES = [[1.0, 0.3, 0.5], [0.3, 1.0, 0.7], [0.5, 0.7, 1.0]]
INKED = """document.querySelector('table.mac td').style.background =
  'color-mix(in srgb, var(--ink) 60%, var(--paper))'"""
Serve = Callable[[Sequence[ScreenPart]], AbstractContextManager[Any]]


def opened_board(folder: Path) -> DeskBoard:
    """Return the desk with three FRFs, one from a file whose name is a script."""
    folder.mkdir(exist_ok=True)
    files = [folder / f"{name}.txt" for name in ("p1", "p2", SCRIPT)]
    if not files[0].exists():
        write_frfs(folder, ("p1", "p2", SCRIPT))
    request = DeskRequest(frfs=FrfOptions(COLUMNS))
    return DeskBoard(desk_subjects(files, request), "A. Person")


@pytest.fixture
def page(chromium: "Browser") -> Iterator["Page"]:
    """Give a tab of a fresh browser profile, which no error of a script may reach."""
    context = chromium.new_context(viewport={"width": 1400, "height": 900})
    tab = context.new_page()
    faults: list[str] = []
    tab.on("pageerror", lambda error: faults.append(str(error)))
    tab.on("dialog", lambda dialog: faults.append(dialog.message))
    foreign: list[str] = []
    tab.on("request", lambda asked: foreign.append(asked.url))
    yield tab
    context.close()
    assert not faults
    assert all("127.0.0.1" in url for url in foreign)


def wait_for_fit(tab: "Page", count: int) -> None:
    """Wait until the table has so many modes and the choice was written."""
    tab.wait_for_function(
        "count => document.querySelectorAll('.desk-grid tbody tr').length === count"
        " && document.querySelector('.desk-message').textContent.includes('written')",
        arg=count,
    )


def place(tab: "Page", board: DeskBoard, hertz: float) -> tuple[float, float]:
    """Return where on the canvas a pole of the highest order stands, in pixels."""
    table = board.state(0).automatic.result.stabilisation
    last = int(table.orders[-1])
    rows = [i for i in range(table.order.size) if table.order[i] == last]
    row = min(rows, key=lambda i: abs(table.frequency[i] - hertz))
    box = tab.locator("canvas.pole-chart").bounding_box()
    assert box is not None
    lines = board.state(0).automatic.frf.frequency
    band = board.state(0).automatic.result.band
    margin = 0.05 * (band[1] - band[0])
    inside = [f for f in lines if band[0] - margin <= f <= band[1] + margin]
    # The margins of the drawing, as in pole_chart.js.
    share = (table.frequency[row] - inside[0]) / (inside[-1] - inside[0])
    return box["x"] + 46 + share * (box["width"] - 46 - 14), box["y"] + 38 + 8


def test_clicks_boxes_and_keys_choose_poles_that_the_results_keep(
    page: "Page", serve: Serve, tmp_path: Path
) -> None:
    """A box clears 300 Hz, a click brings it back to 0.01 Hz; undo; a reload; a kill.

    A file named like a script is shown as text.
    """
    folder = tmp_path / "frfs"
    board = opened_board(folder)
    with serve((desk_part(board),)) as screen:
        page.goto(screen.access.link("/poles"))
        page.wait_for_selector(".desk-grid tbody tr")
        assert SCRIPT in page.locator("select[aria-label=Response]").inner_text()
        x, y = place(page, board, 300.0)
        page.mouse.move(x - 40, y + 60)
        page.mouse.down()
        page.mouse.move(x + 40, y + 90, steps=3)
        page.mouse.up()
        wait_for_fit(page, 2)
        page.mouse.click(x, y)
        wait_for_fit(page, 3)
        model = board.state(0).chain.result.model
        assert model.natural_frequency[1] == pytest.approx(300.0, abs=0.01)
        assert list(model.by_hand) == [False, True, False]
        cell = page.locator(".desk-grid tbody tr").nth(1).inner_text()
        assert "300.0" in cell
        assert "hand" in cell
        by_keys(page, board)
        shown = page.locator(".desk-grid tbody").inner_text()
        page.reload()
        page.wait_for_selector(".desk-grid tbody tr")
        assert page.locator(".desk-grid tbody").inner_text() == shown
    log = choices_of(read_run(folder / "p1-txt.results.h5").modes[0].steps)
    assert [one.action for one in log] == ["clear", "choose", "pin", "undo"]
    assert {one.who for one in log} == {"A. Person"}
    assert all(one.when.endswith("+00:00") for one in log)
    again = opened_board(folder)
    with serve((desk_part(again),)) as screen:
        page.goto(screen.access.link("/poles"))
        page.wait_for_selector(".desk-grid tbody tr")
        assert page.locator(".desk-grid tbody").inner_text() == shown


def by_keys(page: "Page", board: DeskBoard) -> None:
    """Pin the first pole of the highest order by keys alone, and take it back."""
    page.focus("canvas.pole-chart")
    page.mouse.move(5, 5)
    page.keyboard.press("ArrowRight")
    holds = "([where, text, there]) => there === document.querySelector(where)"
    holds += ".textContent.includes(text)"
    table = ".desk-grid tbody"
    page.wait_for_function(holds, arg=[".pole-detail", "MPC", True])
    page.keyboard.press("p")
    page.wait_for_function(holds, arg=[table, "pinned", True])
    assert any(one.pinned for one in board.state(0).chosen)
    page.keyboard.press("u")
    page.wait_for_function(holds, arg=[table, "pinned", False])


def test_every_screen_of_the_desk_is_reached_by_its_link(
    page: "Page", serve: Serve, tmp_path: Path
) -> None:
    """FRFs, shapes, joint and gap, report: on a phone nothing is wider than it."""
    board = opened_board(tmp_path / "frfs")
    found = {
        "verdict": "named",
        "reason": SCRIPT,
        "effects": [],
        "gap_before": 7.0,
        "gap_after": 0.1,
        "experiment": "hit harder",
    }
    (tmp_path / "frfs" / "p1.gap.json").write_text(json.dumps(found), "utf-8")
    page.set_viewport_size({"width": 400, "height": 800})
    with serve((desk_part(board),)) as screen:
        for name, words in (
            ("frfs", "p2"),
            ("shapes", "AutoMAC"),
            ("joint", SCRIPT),
            ("report", "modes of the automatic"),
        ):
            page.goto(screen.access.link(f"/{name}"))
            page.wait_for_selector(".desk-place > *")
            page.wait_for_function(
                "words => document.querySelector('main').textContent.includes(words)",
                arg="modes" if name == "report" else words,
            )
            assert page.evaluate("document.documentElement.scrollWidth") <= 400
            assert page.locator("h1").count() == 1
            unnamed = page.evaluate(
                "[...document.querySelectorAll('button, select, input, canvas')]"
                ".filter(e => !e.closest('[role=img]') || e.role)"
                ".filter(e => !e.textContent.trim() && !e.ariaLabel)"
                ".filter(e => !e.labels?.length)"
                ".length"
            )
            assert unnamed == 0
        refused = page.evaluate(
            "fetch('/desk/0/choose', {method: 'POST', body: '{\"action\": \"x\"}'})"
            ".then(answer => answer.text())"
        )
        assert "a choice is one of" in refused


def shaded(route: "Route") -> None:
    """Answer with the shapes as they are and an AutoMAC of every shade."""
    answer = route.fetch()
    route.fulfill(response=answer, json={**answer.json(), "mac": SHADES})


def test_numbers_on_every_shade_of_the_mac_are_legible(
    page: "Page", serve: Serve, tmp_path: Path
) -> None:
    """The shades are mixtures of colours; what is too dark for ink is noticed."""
    board = opened_board(tmp_path / "frfs")
    with serve((desk_part(board),)) as screen:
        page.route("**/desk/0/shapes", shaded)
        page.goto(screen.access.link("/shapes"))
        for shade in (1, 2, 3):
            page.locator(f"table.mac td.mac-{shade}").first.wait_for()
        legible(page)
        page.evaluate(INKED)
        assert [one.split()[1] for one in page.evaluate(ILLEGIBLE)] == ["1.00"]
