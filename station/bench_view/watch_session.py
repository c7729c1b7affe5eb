# SPDX-License-Identifier: MIT
"""``jointbench watch``: a session in a second terminal, from its file alone."""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.basics.steady_memory import keep_memory_steady
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.session_file.follow_log import read_last, read_log
from jointbench.station.bench_view.level_meter import WINDOW
from jointbench.station.bench_view.terminal_view import TerminalView, viewing
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, table, write_json
from jointbench.station.session_events.condition_states import (
    ConditionMark,
    condition_states,
)
from jointbench.station.session_events.event_codec import Stamped, from_log
from jointbench.station.session_events.event_words import event_words
from jointbench.station.session_events.flow_commands import QuitSession
from jointbench.station.session_events.session_state import SessionState, state_after

_EVERY = 0.5  # [s] between looks at the file
_KEYS_EVERY = 0.1  # [s] between looks at the keyboard
_ONLY_WATCHING = ("c channel  q leaves; the session continues",)


def run_watch(
    session: Path, *, once: bool, json_target: str | None, every: float = _EVERY
) -> SessionState:
    """Show a session, and follow it to its end.

    Args:
        session: file of a recording, or a finished one.
        once: show the state and leave.
        json_target: where the JSON of the last state goes.
        every: time between looks at the file [s].

    Returns:
        The state shown last.

    Raises:
        BadData: it cannot be read, or holds no events.
    """
    check_outputs([session], [json_target])
    keep_memory_steady()
    screen = console(json_target)
    events, live = _events(session)
    state = state_after(SessionState(), events)
    if live and not once and screen.is_terminal:
        state = _watch_on_terminal(session, screen, every)
    elif live and not once:
        _show(session, state, screen)
        for stamped in _following(session, state.last, every):
            state = state_after(state, (stamped,))
            screen.print(_line(stamped), soft_wrap=True, markup=False)
    _show(session, state, screen)
    write_json(json_target, _summary(session, state, live=live))
    return state


def _watch_on_terminal(session: Path, screen: Console, every: float) -> SessionState:
    """Draw the screen of `measure`, until the end or until the viewer leaves."""
    with viewing(screen, session) as view:
        assert isinstance(view, TerminalView)
        view.show_keys(_ONLY_WATCHING)
        view.join(_events(session)[0])
        for stamped in _following(
            session, view.state.last, every, lambda: _look(session, view)
        ):
            view.follow((stamped,))
        return view.state


def _look(session: Path, view: TerminalView) -> bool:
    """Show the levels; return whether the viewer stays."""
    begun = view.state.begun
    if begun is not None:
        samples = read_last(session, round(WINDOW * begun.sample_rate))
        if samples is not None:
            view.level(samples)
    return not isinstance(view.command(), QuitSession)


def _events(session: Path) -> tuple[tuple[Stamped, ...], bool]:
    """Return the events so far, and whether the file is that of a recording.

    Raises:
        BadData: it cannot be read, or holds no events.
    """
    log, live = read_log(session)
    if not log and not live:
        raise FormatError(
            f"'{session}' holds no events: it was imported, or recorded without the "
            "steps of 'jointbench measure'; `jointbench inspect` lists its content"
        )
    return tuple(from_log(log)), live


def _following(
    session: Path,
    last: int,
    every: float,
    stays: Callable[[], bool] = lambda: True,
) -> Iterator[Stamped]:
    """Yield the events after a number, until the recording is over."""
    live = True
    while live:
        until = time.monotonic() + every
        while time.monotonic() < until:
            time.sleep(min(every, _KEYS_EVERY))
            if not stays():
                return
        # Asked before the log is read: a recording that ended in between has its end.
        recording = is_held(session)
        try:
            events, live = _events(session)
        except BadData:
            if recording:  # the finished file takes its place just now
                continue
            raise
        for stamped in events:
            if stamped.id > last:
                last = stamped.id
                yield stamped
        live = live and recording


def _line(stamped: Stamped) -> str:
    clock = datetime.fromtimestamp(stamped.time).astimezone()
    return f"{clock:%H:%M:%S} {stamped.id:5d}  {event_words(stamped.event)}"


def _show(session: Path, state: SessionState, screen: Console) -> None:
    rows = [
        ("now", _now(state)),
        ("conditions" if state.planned else "runs", _finished(state)),
        ("given up", ", ".join(n for n, g in state.finished.items() if g) or "none"),
        ("hits", _counted(state)),
        ("missing samples", f"{state.lost} in {state.gaps} gaps"),
        ("warnings", "; ".join(state.warnings) or "none"),
        ("notes", "; ".join(state.notes) or "none"),
        ("last message", state.messages[-1] if state.messages else "none"),
    ]
    screen.print(table(f"{session}", ("session", "state"), rows))


def _finished(state: SessionState) -> str:
    """Return how many conditions of a plan are over, or the names of timed runs."""
    if state.planned:
        return f"{len(state.finished)} of {state.planned} are done"
    whole = [name for name, early in state.finished.items() if not early]
    return ", ".join(whole) or "none"


def _now(state: SessionState) -> str:
    if state.ended is not None:
        how = "interrupted" if state.ended.interrupted else "ended"
        return f"{how}: {state.ended.reason}" if state.ended.reason else how
    if state.disconnected:
        return "the connection to the device is lost"
    if state.open_loops:
        return f"sensor loop open: {state.open_loops}"
    if state.paused:
        return "pause"
    if state.run is not None and state.run.duration is not None:
        return f"{state.run.purpose} run {state.run.name!r} is recorded"
    return f"hit {state.asked}" if state.asked else "begins"


def _counted(state: SessionState) -> str:
    counts = Counter(hit.verdict for hit in state.hits.values())
    return ", ".join(f"{n} {word}" for word, n in sorted(counts.items())) or "none"


def _summary(session: Path, state: SessionState, *, live: bool) -> dict[str, object]:
    conditions = condition_states(state)
    return {
        "session": str(session),
        "recording": live,
        "asked": state.asked,
        "done": state.done,
        "planned": state.planned,
        "open": [
            c.name
            for c in conditions
            if c.mark in {ConditionMark.OPEN, ConditionMark.NOW}
        ],
        "hits": [
            {
                "number": number + 1,
                "point": hit.point,
                "peak_n": hit.peak_force,
                "verdict": hit.verdict,
                "reason": hit.reason,
            }
            for number, hit in sorted(state.hits.items())
        ],
        "incomplete": [name for name, given_up in state.finished.items() if given_up],
        "warnings": list(state.warnings),
        "notes": list(state.notes),
        "paused": state.paused,
        "lost_samples": state.lost,
        "ended": state.ended is not None,
        "interrupted": state.ended is not None and state.ended.interrupted,
        "last_event": state.last,
    }
