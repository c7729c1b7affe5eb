# SPDX-License-Identifier: MIT
"""Parts of the screen of a session: head, progress, points, levels, messages."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from rich.text import Text

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.bench_view.level_meter import Level
from jointbench.station.session_events.condition_states import (
    ConditionMark,
    ConditionState,
    condition_states,
    seconds_left,
)
from jointbench.station.session_events.session_state import SessionState

_CELL = 40  # columns that a level takes
_NAME, _NAME_SHARE = 8, 4  # columns of a name at least; its share of a level at most
_MARKS = {
    ConditionMark.DONE: ("✓", "green"),
    ConditionMark.OPEN: ("·", "default"),
    ConditionMark.INCOMPLETE: ("!", "bold red"),
    ConditionMark.NOW: ("▶", "bold reverse"),
}
_WARNINGS = 3  # that are shown at once
ALERT = "bold white on red"


def fitted(line: Text, width: int) -> Text:
    """Return a line cut to a width, an ellipsis for what is left out."""
    cut = line.copy()
    cut.truncate(width, overflow="ellipsis")
    return cut


def head_line(state: SessionState, file: str, free: int | None, width: int) -> Text:
    """Return badge, operator, free disk and file in one line."""
    line = Text(style="bold")
    if state.begun is not None and state.begun.simulated:
        line.append(" SIMULATED ", style="bold black on yellow").append(" ")
    operator = state.begun.operator if state.begun is not None else ""
    line.append(visible(f"operator {operator or 'not given'}  "))
    if free is not None:
        line.append(f"disk {free / 1e9:.1f} GB free  ")
    room = width - line.cell_len
    name = visible(file)
    return line.append(name if len(name) <= room else "…" + name[1 - room :])


def progress_line(state: SessionState, now: float) -> Text:
    """Return what is left: hits, conditions and time."""
    conditions = condition_states(state)
    end = now if state.ended is None else state.last_time
    elapsed = 0.0 if state.first_time is None else max(0.0, end - state.first_time)
    if state.run is not None and state.run.duration is not None:
        rest = max(0.0, state.run_time + state.run.duration - end)
        return Text(f"{_clock(elapsed)} elapsed  {_clock(rest)} left of this run")
    if not conditions:
        return Text(f"{_clock(elapsed)} elapsed")
    left = seconds_left(state, end)
    here = sum(c.left for c in conditions if c.mark is ConditionMark.NOW)
    words = [
        f"hits left {here} here, {sum(c.left for c in conditions)} in all",
        f"{_clock(elapsed)} elapsed",
        "time left not known yet" if left is None else f"about {_clock(left)} left",
    ]
    return Text("  ".join(words))


def point_lines(state: SessionState, *, width: int, rows: int) -> Iterator[Text]:
    """Yield the points of the plan, by torque and level, with where each stands."""
    conditions = condition_states(state)
    if not conditions:
        return
    count = {mark: sum(c.mark is mark for c in conditions) for mark in ConditionMark}
    yield Text(
        f"points: {count[ConditionMark.DONE]} done ✓  "
        f"{count[ConditionMark.OPEN] + count[ConditionMark.NOW]} open ·  "
        f"{count[ConditionMark.INCOMPLETE]} incomplete !",
        style="dim",
    )
    groups = [list(g) for _, g in groupby(conditions, lambda c: (c.torque, c.level))]
    now = next(
        (
            n
            for n, g in enumerate(groups)
            if any(c.mark is ConditionMark.NOW for c in g)
        ),
        0,
    )
    first = max(0, min(now - rows // 2, len(groups) - rows))
    for group in groups[first : first + rows]:
        yield _group_line(group, width)


def level_lines(
    state: SessionState, levels: Sequence[Level], *, width: int, rows: int
) -> Iterator[Text]:
    """Yield the level of every channel, several in a line; what is open or full."""
    columns = max(1, width // _CELL)
    while -(-len(levels) // columns) > rows:
        columns += 1
    cell = width // columns
    longest = max((len(visible(level.name)) for level in levels), default=0)
    name = min(max(longest, _NAME), cell // _NAME_SHARE)
    for first in range(0, len(levels), columns):
        line = Text()
        for level in levels[first : first + columns]:
            line.append_text(_level(level, state.open_loops, cell, name))
        yield line


def message_lines(state: SessionState, *, width: int) -> Iterator[Text]:
    """Yield warnings that were not seen, lost samples, and the last message."""
    unseen = state.warnings[state.warnings_seen :]
    for number, words in enumerate(unseen[-_WARNINGS:]):
        more = len(unseen) - _WARNINGS
        lead = f"WARNING (+{more} more, w) " if more > 0 and not number else "WARNING "
        yield Text(visible(lead + words).ljust(width), style=ALERT)
    if state.lost:
        yield Text(f"{state.lost} samples lost in {state.gaps} gaps", style="red")
    last = state.answers[-1] if state.answers else None
    if last is not None:
        word = "" if last.done else "refused: "
        yield Text(visible(word + last.words), style="cyan" if last.done else "red")
    elif state.messages:
        yield Text(visible(state.messages[-1]), style="dim")


def _group_line(group: Sequence[ConditionState], width: int) -> Text:
    head = "".join(
        f"{value:g} {unit} "
        for value, unit in ((group[0].torque, "N m"), (group[0].level, "N"))
        if value is not None
    )
    line = Text(head and f"{head:>12}")
    at = next((n for n, c in enumerate(group) if c.mark is ConditionMark.NOW), 0)
    cells = [_point(c) for c in group]
    # The present point stays visible where the list is longer than the line.
    while at and sum(c.cell_len for c in cells[: at + 1]) > width - line.cell_len - 2:
        cells.pop(0)
        at -= 1
    for cell in cells:
        line.append_text(cell)
    return line


def _point(condition: ConditionState) -> Text:
    sign, style = _MARKS[condition.mark]
    count = f" {condition.good}/{condition.wanted}"
    now = count if condition.mark is ConditionMark.NOW else ""
    return Text(f" {visible(condition.point)}{sign}{now}", style=style).append(" ")


def _level(level: Level, open_loops: str, cell: int, room: int) -> Text:
    """Return name, bar and number of a channel; the name has so many columns."""
    style = ALERT if level.full else "green"
    lamp = " OVERLOAD" if level.full else ""
    if level.name in open_loops.split(", "):
        style, lamp = ALERT, " OPEN"
    name = fitted(Text(f"{visible(level.name):{room}}"), room)
    number = f"{100 * level.share:5.1f} %{lamp}"
    bar = max(0, cell - name.cell_len - 20)
    filled = min(bar, round(bar * level.share))
    line = Text().append_text(name).append(" ")
    line.append("█" * filled + "·" * (bar - filled), style=style)
    line.append(f" {number}", style=style)
    line = fitted(line, cell - 1)
    line.pad_right(cell - line.cell_len)
    return line


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}"
