# SPDX-License-Identifier: MIT
"""The screen of a session as lines of text: a function of its state alone.

`measure` and `watch` draw the same lines from the same events.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from rich.text import Text

from jointbench.station.bench_view.level_meter import Level
from jointbench.station.bench_view.screen_parts import (
    fitted,
    head_line,
    level_lines,
    message_lines,
    point_lines,
    progress_line,
)
from jointbench.station.bench_view.screen_plots import plot_lines
from jointbench.station.bench_view.task_lines import (
    gain_lines,
    task_lines,
    verdict_lines,
)
from jointbench.station.session_events.session_state import SessionState

_LEAST_PLOT = 3  # rows of an FRF below which it is left out
_MOST_PLOT = 24


@dataclass(frozen=True, slots=True)
class ViewContext:
    """What a view knows beside the events.

    Attributes:
        file: of the session.
        free: space on its disk [bytes], None if unknown.
        now: time since 1970 [s].
        levels: of the channels.
    """

    file: str
    free: int | None
    now: float
    levels: tuple[Level, ...] = ()


@dataclass(frozen=True, slots=True)
class Look:
    """How one view looks at the session.

    Attributes:
        width: of the terminal [columns].
        height: of the terminal [rows].
        channel: number of the response whose FRF is drawn, counted on from 0.
        prompt: what the operator types, or is asked; empty for the keys.
        keys: what keys do, one line each.
    """

    width: int
    height: int
    channel: int = 0
    prompt: str = ""
    keys: tuple[str, ...] = ()


def session_lines(
    state: SessionState, around: ViewContext, look: Look
) -> tuple[Text, ...]:
    """Return the screen, no line wider and no more lines than the terminal."""
    above = tuple(_above(state, around, look))
    below = tuple(_below(state, look))
    rows = look.height - len(above) - len(below)
    plot: tuple[Text, ...] = ()
    if rows > _LEAST_PLOT:
        plot = plot_lines(
            state, look.channel, width=look.width, rows=min(rows, _MOST_PLOT)
        )
    lines = (*above, *plot, *below)
    if len(lines) > look.height:
        kept = max(0, look.height - len(below))
        lines = (*above[:kept], *below)[: look.height]
    return tuple(fitted(line, look.width) for line in lines)


def _above(state: SessionState, around: ViewContext, look: Look) -> Iterator[Text]:
    tall = look.height >= 40
    yield head_line(state, around.file, around.free, look.width)
    yield from task_lines(state, width=look.width, tall=tall)
    yield from verdict_lines(state, width=look.width, tall=tall)
    yield from gain_lines(state, width=look.width)
    yield progress_line(state, around.now)
    yield from point_lines(state, width=look.width, rows=6 if tall else 2)
    yield from level_lines(
        state, around.levels, width=look.width, rows=16 if tall else 4
    )


def _below(state: SessionState, look: Look) -> Iterator[Text]:
    yield from message_lines(state, width=look.width)
    if look.prompt:
        yield from (Text() for _ in look.keys[1:])
        yield Text(look.prompt + "▏", style="bold black on yellow")
    else:
        yield from (Text(line, style="italic") for line in look.keys)
