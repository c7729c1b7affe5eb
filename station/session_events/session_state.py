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
    RunBegun,
    Said,
    SamplesMissing,
    SessionEnded,
    Warned,
)
from jointbench.station.session_events.hit_events import (
    CheckDone,
    GainForecast,
    HitJudged,
    SettingProposed,
)
from jointbench.station.session_events.operator_events import (
    CommandAnswered,
    ConditionReopened,
    NoteAdded,
    PauseChanged,
    WarningsSeen,
)
from jointbench.station.session_events.view_events import (
    BoltAsked,
    FileFinishing,
    HitAveraged,
    SessionBegun,
)

_LAST = 5  # messages that are kept


@dataclass(frozen=True, slots=True)
class SessionState:
    """What a session amounts to.

    Attributes:
        begun: what was known before the first sample, None in older recordings.
        asked: name of the condition that hits are asked for, empty before.
        done: conditions that are over.
        planned: conditions of the plan, 0 before the first request.
        hits: latest verdict of each hit, by its number.
        struck_for: name of the condition of each hit, empty for a trial hit.
        on_trial: whether hits are trial hits.
        run: that was begun last, None before.
        run_time: when, since 1970 [s].
        tighten: bolt that is tightened now, None for none.
        average: after the last hit, None before.
        gains: the last two forecasts of what further hits would buy.
        settings: that trial hits proposed, by name; the latest ones.
        finished: names of the conditions that are over, with whether given up.
        checks: on the part.
        warnings: all of them; they stay.
        warnings_seen: number of them that the operator has seen.
        messages: the last ones.
        notes: of the operator.
        answers: to the last commands.
        paused: whether hits are ignored.
        lost: samples per channel known to be missing.
        gaps: number of gaps.
        disconnected: whether the connection to the device is lost.
        open_loops: sensors that are disconnected, empty for none.
        ended: how the recording ended, None while it runs.
        finishing: share of the session file that is written since then [-], None
            before, and when all of it is.
        first_time: of the first event, since 1970 [s]; None before.
        last_time: of the last event, since 1970 [s].
        last: number of the last event, -1 before.
    """

    begun: SessionBegun | None = None
    asked: str = ""
    done: int = 0
    planned: int = 0
    hits: dict[int, HitJudged] = field(default_factory=dict)
    struck_for: dict[int, str] = field(default_factory=dict)
    on_trial: bool = False
    run: RunBegun | None = None
    run_time: float = 0.0
    tighten: BoltAsked | None = None
    average: HitAveraged | None = None
    gains: tuple[GainForecast, ...] = ()
    settings: dict[str, SettingProposed] = field(default_factory=dict)
    finished: dict[str, bool] = field(default_factory=dict)
    checks: tuple[CheckDone, ...] = ()
    warnings: tuple[str, ...] = ()
    warnings_seen: int = 0
    messages: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    answers: tuple[CommandAnswered, ...] = ()
    paused: bool = False
    lost: int = 0
    gaps: int = 0
    disconnected: bool = False
    open_loops: str = ""
    ended: SessionEnded | None = None
    finishing: float | None = None
    first_time: float | None = None
    last_time: float = 0.0
    last: int = -1


def state_after(state: SessionState, events: Iterable[Stamped]) -> SessionState:
    """Return the state after further events, in their order."""
    for stamped in events:
        if isinstance(stamped.event, FileFinishing):  # after the last of the log
            share = stamped.event.share
            state = replace(state, finishing=share if share < 1.0 else None)
            continue
        state = replace(
            _after(state, stamped),
            first_time=stamped.time if state.first_time is None else state.first_time,
            last_time=stamped.time,
            last=stamped.id,
        )
    return state


def _after(state: SessionState, stamped: Stamped) -> SessionState:
    match stamped.event:
        case HitJudged() as hit:
            return _with_hit(state, hit)
        case HitAveraged() as average:
            return replace(state, average=average)
        case Asked(name=name, done=done, planned=planned):
            return replace(state, asked=name, done=done, planned=planned)
        case RunBegun(purpose=purpose) as run:
            return replace(
                state,
                on_trial=purpose == "trial",
                tighten=None,
                run=run,
                run_time=stamped.time,
            )
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
        case SamplesMissing(what=what, samples=samples):
            return replace(
                state,
                lost=state.lost + samples,
                gaps=state.gaps + 1,
                disconnected=what == "lost",
            )
        case SessionEnded() as ended:
            return replace(state, ended=ended)
    return _after_command(state, stamped)


def _after_command(state: SessionState, stamped: Stamped) -> SessionState:
    match stamped.event:
        case SessionBegun() as begun:
            return replace(state, begun=begun)
        case CommandAnswered() as answer:
            return replace(state, answers=(*state.answers, answer)[-_LAST:])
        case NoteAdded(words=words):
            return replace(state, notes=(*state.notes, words))
        case GainForecast() as gain:
            return replace(state, gains=(*state.gains, gain)[-2:])
        case SettingProposed(name=name) as setting:
            return replace(state, settings={**state.settings, name: setting})
        case PauseChanged(paused=paused):
            return replace(state, paused=paused)
        case WarningsSeen(count=count):
            return replace(state, warnings_seen=count)
        case ConditionReopened(name=name):
            rest = {n: up for n, up in state.finished.items() if n != name}
            return replace(state, finished=rest)
        case BoltAsked() as bolt:
            return replace(state, tighten=bolt)
    return state


def _with_hit(state: SessionState, hit: HitJudged) -> SessionState:
    """Return the state after a verdict; a hit belongs to what was asked for then."""
    known = state.struck_for
    if hit.number not in known:
        known = {**known, hit.number: "" if state.on_trial else state.asked}
    return replace(state, hits={**state.hits, hit.number: hit}, struck_for=known)
