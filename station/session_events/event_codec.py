# SPDX-License-Identifier: MIT
"""Events as entries of the log of a session file, and back.

The log is the one list of a session: what was written is what a second view shows and
what a replay repeats. The number of an entry in the log is the number of its event.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from jointbench.acquisition.basics.errors import FormatError
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
    BoltRead,
    CheckDone,
    GainForecast,
    HitJudged,
    PreloadRead,
    SettingProposed,
    VerdictChanged,
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

Event = (
    HitJudged
    | VerdictChanged
    | SettingProposed
    | CheckDone
    | BoltRead
    | PreloadRead
    | RunBegun
    | Asked
    | ConditionDone
    | Said
    | Warned
    | CableChanged
    | SamplesMissing
    | SessionEnded
    | FileFinishing
    | SessionBegun
    | HitAveraged
    | GainForecast
    | BoltAsked
    | CommandAnswered
    | NoteAdded
    | PauseChanged
    | WarningsSeen
    | ConditionReopened
)
_KINDS: Mapping[str, type[Event]] = {
    kind.kind: kind
    for kind in (
        *(HitJudged, VerdictChanged, SettingProposed, CheckDone, BoltRead),
        *(RunBegun, Asked, ConditionDone, Said, Warned, CableChanged),
        *(SamplesMissing, SessionEnded, SessionBegun, HitAveraged, CommandAnswered),
        *(GainForecast, PreloadRead, FileFinishing),
        *(NoteAdded, PauseChanged, WarningsSeen, ConditionReopened, BoltAsked),
    )
}


@dataclass(frozen=True, slots=True)
class Stamped:
    """An event in the log.

    Attributes:
        id: number of its entry, from 0.
        time: since 1970 [s].
        stored: samples per channel that it refers to.
        event: what happened.
    """

    id: int
    time: float
    stored: int
    event: Event


def to_entry(event: Event) -> dict[str, object]:
    """Return an event as an entry of the log."""
    return {"kind": event.kind, **asdict(event)}


def from_log(log: Iterable[Mapping[str, Any]], *, first: int = 0) -> Iterator[Stamped]:
    """Yield the events of a log; entries of other kinds are no events.

    Args:
        log: entries in their order.
        first: number of the first of them.

    Raises:
        FormatError: an entry lacks a value.
    """
    for number, entry in enumerate(log, first):
        kind = _KINDS.get(str(entry.get("kind")))
        if kind is not None:
            yield Stamped(
                id=number,
                time=float(entry.get("time", 0.0)),
                stored=int(entry.get("stored", 0)),
                event=_event(kind, entry),
            )


def _event(kind: type[Event], entry: Mapping[str, Any]) -> Event:
    names = {field.name for field in fields(kind)}
    try:
        return kind(**{n: v for n, v in entry.items() if n in names})
    except TypeError as error:
        raise FormatError(
            f"an entry of kind {entry.get('kind')!r} of the log is incomplete ({error})"
        ) from error
