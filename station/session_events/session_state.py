# SPDX-License-Identifier: MIT
"""The state of a session: what its events amount to so far.

It is a pure function of the events, so that whoever joins late, or replays a session
that is over, sees what those saw who were there.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.flow_events import (
    Asked,
    CableChanged,
    ConditionDone,
    Said,
    SamplesMissing,
    SessionEnded,
    Warned,
)
from jointbench.station.session_events.hit_events import CheckDone, HitJudged

_LAST = 5  # messages that are kept


@dataclass(frozen=True, slots=True)
class SessionState:
    """What a session amounts to.

    Attributes:
        asked: name of the condition that hits are asked for, empty before.
        done: conditions that are over.
        planned: conditions of the plan, 0 before the first request.
        hits: latest verdict of each hit, by its number.
        finished: names of the conditions that are over, with whether given up.
        checks: on the part.
        warnings: all of them; they stay.
        messages: the last ones.
        lost: samples per channel known to be missing.
        gaps: number of gaps.
        open_loops: sensors that are disconnected, empty for none.
        ended: how the recording ended, None while it runs.
        last: number of the last event, -1 before.
    """

    asked: str = ""
    done: int = 0
    planned: int = 0
    hits: dict[int, HitJudged] = field(default_factory=dict)
    finished: dict[str, bool] = field(default_factory=dict)
    checks: tuple[CheckDone, ...] = ()
    warnings: tuple[str, ...] = ()
    messages: tuple[str, ...] = ()
    lost: int = 0
    gaps: int = 0
    open_loops: str = ""
    ended: SessionEnded | None = None
    last: int = -1


def state_after(state: SessionState, events: Iterable[Stamped]) -> SessionState:
    """Return the state after further events, in their order."""
    for stamped in events:
        state = replace(_after(state, stamped), last=stamped.id)
    return state


def _after(state: SessionState, stamped: Stamped) -> SessionState:
    match stamped.event:
        case HitJudged() as hit:
            return replace(state, hits={**state.hits, hit.number: hit})
        case Asked(name=name, done=done, planned=planned):
            return replace(state, asked=name, done=done, planned=planned)
        case ConditionDone(name=name, given_up=given_up):
            return replace(state, finished={**state.finished, name: given_up})
        case CheckDone() as check:
            return replace(state, checks=(*state.checks, check))
        case Warned(words=words):
            return replace(state, warnings=(*state.warnings, words))
        case Said(words=words):
            return replace(state, messages=(*state.messages, words)[-_LAST:])
        case CableChanged(channels=channels):
            loops = "" if channels.startswith("all closed") else channels
            return replace(state, open_loops=loops)
        case SamplesMissing(samples=samples):
            return replace(state, lost=state.lost + samples, gaps=state.gaps + 1)
        case SessionEnded() as ended:
            return replace(state, ended=ended)
    return state
