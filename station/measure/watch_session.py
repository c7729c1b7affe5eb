# SPDX-License-Identifier: MIT
"""``jointbench watch``: a session in a second terminal, from its file alone."""

import time
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, table, write_json
from jointbench.station.session_events.event_codec import Stamped, from_log
from jointbench.station.session_events.event_words import event_words
from jointbench.station.session_events.session_state import SessionState, state_after

_EVERY = 0.5  # [s] between looks at the file


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
    screen = console(json_target)
    events, live = _events(session)
    state = state_after(SessionState(), events)
    _show(session, state, screen)
    if live and not once:
        for stamped in _following(session, state.last, every):
            state = state_after(state, (stamped,))
            screen.print(_line(stamped), soft_wrap=True, markup=False)
        _show(session, state, screen)
    write_json(json_target, _summary(session, state, live=live))
    return state


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


def _following(session: Path, last: int, every: float) -> Iterator[Stamped]:
    """Yield the events after a number, until the recording is over."""
    live = True
    while live:
        time.sleep(every)
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
        ("conditions", f"{state.done} of {state.planned} are done"),
        ("given up", ", ".join(n for n, g in state.finished.items() if g) or "none"),
        ("hits", _counted(state)),
        ("missing samples", f"{state.lost} in {state.gaps} gaps"),
        ("warnings", "; ".join(state.warnings) or "none"),
        ("last message", state.messages[-1] if state.messages else "none"),
    ]
    screen.print(table(f"{session}", ("session", "state"), rows))


def _now(state: SessionState) -> str:
    if state.ended is not None:
        how = "interrupted" if state.ended.interrupted else "ended"
        return f"{how}: {state.ended.reason}" if state.ended.reason else how
    if state.open_loops:
        return f"sensor loop open: {state.open_loops}"
    return f"hit {state.asked}" if state.asked else "begins"


def _counted(state: SessionState) -> str:
    counts = Counter(hit.verdict for hit in state.hits.values())
    return ", ".join(f"{n} {word}" for word, n in sorted(counts.items())) or "none"


def _summary(session: Path, state: SessionState, *, live: bool) -> dict[str, object]:
    return {
        "session": str(session),
        "recording": live,
        "asked": state.asked,
        "done": state.done,
        "planned": state.planned,
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
        "lost_samples": state.lost,
        "ended": state.ended is not None,
        "interrupted": state.ended is not None and state.ended.interrupted,
        "last_event": state.last,
    }
