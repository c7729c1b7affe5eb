# SPDX-License-Identifier: MIT
"""``jointbench bench``: `measure` with its screen in a browser."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.bench_view.terminal_view import viewing
from jointbench.station.browser.app.screen_extra import require_screen_extra
from jointbench.station.browser.app.serve_screen import open_browser
from jointbench.station.browser.bench.screen_process import ScreenProcess
from jointbench.station.measure.bench_session import Measured, run_measure
from jointbench.station.schemas.geometry_file import Geometry, read_geometry
from jointbench.station.session_events.command_queue import CommandQueue


@dataclass(frozen=True, slots=True)
class ScreenOptions:
    """How the screen is served.

    Attributes:
        port: TCP port on the loopback interface; 0 for any that is free.
        browser: whether to open the browser.
        geometry: file of the points, None without.
    """

    port: int = 0
    browser: bool = True
    geometry: Path | None = None


def run_bench(
    plan_file: Path,
    out: Path,
    *,
    source: str | None,
    overwrite: bool,
    json_target: str | None,
    screen: ScreenOptions,
) -> Measured:
    """Measure by a plan, with a screen in the browser.

    The screen is served until the session has ended and no browser shows it any more.

    Args:
        plan_file: TOML.
        out: session file to write.
        source: URL of the chassis; None for the plan's own.
        overwrite: replace a session that is there, once the new one is whole.
        json_target: where the JSON goes.
        screen: how it is served.

    Raises:
        UsageError: the extra is not installed, the port is taken, or as `run_measure`.
        InstrumentError: as `run_measure`.
    """
    require_screen_extra()
    commands = CommandQueue()
    geometry = None if screen.geometry is None else read_geometry(screen.geometry)
    with ExitStack() as stack:
        served: list[ScreenProcess] = []

        @contextmanager
        def with_browser(console: Console, file: Path) -> Iterator[LiveView]:
            process = stack.enter_context(
                ScreenProcess(
                    file,
                    commands,
                    port=screen.port,
                    geometry=None if geometry is None else _places(geometry),
                    places=screen.geometry,
                    say=lambda line: console.print(line, soft_wrap=True),
                )
            )
            served.append(process)
            link = process.access.link("/measure")
            console.print(f"screen: {link}", soft_wrap=True, markup=False)
            if screen.browser:
                open_browser(link)
            with viewing(console, file) as view:
                yield view

        measured = run_measure(
            plan_file,
            out,
            source=source,
            overwrite=overwrite,
            json_target=json_target,
            viewing=with_browser,
            commands=commands,
        )
        for process in served:
            process.finished(measured.path)
            process.linger()
    return measured


def _places(geometry: Geometry) -> dict[str, object]:
    return {
        "points": {name: list(at) for name, at in geometry.points.items()},
        "lines": [list(line) for line in geometry.lines],
        "unit": geometry.unit,
    }
