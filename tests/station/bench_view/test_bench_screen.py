"""The bench screen: what the operator sees of levels, hits and keys."""

import io

import numpy as np
import pytest
from rich.console import Console
from rich.live import Live

from jointbench.acquisition.records.recordings import Channel, Hit, Quantity, Verdict
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.bench_screen import BenchScreen, level_row, spark
from jointbench.station.measure.observer import Command, HitNews
from jointbench.station.measure.plan import Condition

HAMMER = Channel("force", Quantity.FORCE, "1", range=100.0)


def shown(keys: str = "", verdict: Verdict = Verdict.OK) -> tuple[str, BenchScreen]:
    """Return the screen after one hit, as text."""
    console = Console(file=io.StringIO(), force_terminal=True, width=100)
    pressed = iter(keys)
    with Live(console=console, auto_refresh=False) as live:
        screen = BenchScreen(live, lambda: next(pressed, ""))
        screen.begin((HAMMER,), 1000.0)
        condition = Condition(0, 20.0, None, "3", None)
        screen.ask(condition, 4, 15)
        samples = np.zeros((1, 200))
        samples[0, 20:29] = 99.0 * np.sin(np.pi * np.arange(9) / 8)
        screen.block(samples)
        hit = Hit(0, 20, 200, "3", 99.0, verdict, 0.1, "the reason")
        cut = CutHit(samples, 0, 20, True)
        screen.hit(HitNews(7, cut, hit, condition, 2, 3, None, None))
        live.refresh()
    output = console.file
    assert isinstance(output, io.StringIO)
    return output.getvalue(), screen


def test_the_screen_says_what_to_hit_and_how_far_the_plan_is() -> None:
    """Point, torque, progress."""
    text, _ = shown()
    assert "HIT 20 Nm, point 3" in text
    assert "4 of 15" in text


@pytest.mark.parametrize("verdict", [Verdict.OK, Verdict.DOUBLE])
def test_a_hit_is_shown_with_verdict_count_and_reason(verdict: Verdict) -> None:
    """Accepted or not, the reason is there."""
    text, _ = shown(verdict=verdict)
    assert f"hit 7 {verdict.value}" in text
    assert "2/3" in text
    assert "the reason" in text


def test_a_channel_at_its_range_lights_the_overload_lamp() -> None:
    """From 98 % of the range on."""
    assert "OVERLOAD" in level_row(HAMMER, 98.0)[2].plain
    assert "OVERLOAD" not in level_row(HAMMER, 97.0)[2].plain


@pytest.mark.parametrize(
    ("key", "command"),
    [
        ("a", Command.ACCEPT),
        ("R", Command.REJECT),
        ("u", Command.UNDO),
        ("q", Command.QUIT),
        ("x", None),
        ("", None),
    ],
)
def test_keys_stand_for_commands(key: str, command: Command | None) -> None:
    """Any other key does nothing."""
    _, screen = shown(key)
    assert screen.command() is command


def test_a_line_of_bars_rises_from_its_low_to_its_high() -> None:
    """Empty at the low, full at the high."""
    line = spark(np.linspace(0.0, 1.0, 640), 0.0, 1.0)
    assert line[0] == " "
    assert line[-1] == "█"
    assert list(line) == sorted(line)
