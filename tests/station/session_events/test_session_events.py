"""Events of a session: one list that is log, screen and replay."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.finish import finish_live
from jointbench.acquisition.session_file.live_write import LiveSession
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.bench_view.watch_session import run_watch
from jointbench.station.session_events.event_codec import (
    Event,
    Stamped,
    from_log,
    to_entry,
)
from jointbench.station.session_events.event_words import event_words
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
    HitJudged,
    SettingProposed,
    VerdictChanged,
)
from jointbench.station.session_events.session_state import SessionState, state_after
from jointbench.station.session_events.view_events import FileFinishing

FIRST = HitJudged(0, 0, 10, 90, "1", 150.0, "ok", 0.0, "single clean pulse")
OTHER = HitJudged(1, 100, 110, 190, "1", 20.0, "weak", 0.1, "below a third")
AGAIN = VerdictChanged(0, 0, 10, 90, "1", 150.0, "operator", 0.0, "rejected")
EVENTS: tuple[Event, ...] = (
    Warned("calibrated two years ago"),
    RunBegun("20 Nm, point 1", "measurement", "1", 20.0, 25e3, None),
    Asked("20 Nm, point 1", "1", 0, 2),
    SettingProposed("trigger_n", 2.5, "five times the noise"),
    BoltRead(1, 20.0, 20.4, True, "20.4 Nm"),
    FIRST,
    OTHER,
    AGAIN,
    CheckDone("driving point 1", 0.01, 0.05, True),
    SamplesMissing("overrun", 0, 200, 50, 0.01, "-200279"),
    CableChanged("a1"),
    CableChanged("all closed again"),
    Said("hit 1 is taken out"),
    ConditionDone("20 Nm, point 1", True),
    SessionEnded(True, "the measuring program ended"),
)
META = {
    "uuid": "u",
    "sample_rate": 1000.0,
    "simulated": True,
    "channels": [
        {
            "name": "force",
            "quantity": "force",
            "point": "1",
            "direction": "+z",
            "unit": "N",
            "sensitivity": 1e-3,
            "range": 1000.0,
        }
    ],
}


def stamped() -> tuple[Stamped, ...]:
    """Return the events as a log gives them."""
    return tuple(from_log(json.loads(json.dumps([to_entry(e) for e in EVENTS]))))


@pytest.mark.parametrize("event", EVENTS)
def test_an_event_goes_through_json_and_back(event: Event) -> None:
    """Kind, values and types are the same; its words are one line."""
    entry = json.loads(json.dumps(to_entry(event)))
    (back,) = from_log([entry], first=7)
    assert back == Stamped(7, 0.0, 0, event)
    assert type(back.event) is type(event)
    assert len(event_words(event).splitlines()) == 1


def test_the_share_of_a_file_that_is_written_changes_nothing_else() -> None:
    """It comes after the last event of the log, whose number and time stay."""
    before = state_after(SessionState(), stamped())
    after = state_after(before, (Stamped(-1, 0.0, 0, FileFinishing(0.25)),))
    assert after == replace(before, finishing=0.25)


def test_other_entries_of_a_log_are_no_events_but_keep_their_number() -> None:
    """The books at the end are for `verify`."""
    log = [{"kind": "continuity", "lost": 0}, to_entry(Said("words"))]
    assert [one.id for one in from_log(log)] == [1]


def test_an_event_that_lacks_a_value_is_refused() -> None:
    """The kind is named."""
    with pytest.raises(FormatError, match="'hit'"):
        list(from_log([{"kind": "hit", "number": 0}]))


def test_the_state_is_that_of_the_latest_verdicts() -> None:
    """Two hits, one rejected later; a gap, a warning that stays, the end."""
    state = state_after(SessionState(), stamped())
    assert [hit.verdict for hit in state.hits.values()] == ["operator", "weak"]
    assert (state.lost, state.gaps, state.open_loops) == (50, 1, "")
    assert state.warnings == ("calibrated two years ago",)
    assert state.finished == {"20 Nm, point 1": True}
    assert state.ended is not None
    assert state.ended.interrupted


@pytest.mark.parametrize("seen", range(len(EVENTS)))
def test_who_joins_late_sees_the_same(seen: int) -> None:
    """A state computed at once and one continued from any event are equal."""
    early = state_after(SessionState(), stamped()[:seen])
    assert state_after(early, stamped()[seen:]) == state_after(
        SessionState(), stamped()
    )


def test_watch_shows_a_recording_and_the_finished_session_alike(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """While it is written, after it was finished, and as JSON."""
    path, out = tmp_path / "s.h5", tmp_path / "s.json"
    with LiveSession(path, META, channels=1, block=100) as live:
        live.append(np.zeros((1, 200)), segment=0, first=0)
        for event in EVENTS[:-1]:
            live.log(to_entry(event))
        live.written()
        before = run_watch(path, once=True, json_target=str(out))
        content = json.loads(out.read_text())
        live.log(to_entry(EVENTS[-1]))
    finish_live(path, path, overwrite=True)
    after = run_watch(path, once=False, json_target=None)
    assert content["recording"] is True
    assert [hit["verdict"] for hit in content["hits"]] == ["operator", "weak"]
    assert replace(after, last_time=before.last_time) == replace(
        before, ended=EVENTS[-1], last=before.last + 1
    )
    assert "interrupted: the measuring program ended" in capsys.readouterr().out
    assert [s.name for s in read_session(path).provenance].count("message") == 0


def test_a_session_without_events_says_what_to_do(tmp_path: Path) -> None:
    """An imported one, for example."""
    path = tmp_path / "s.h5"
    write_session(new_session(source="file:", simulated=False), path)
    with pytest.raises(BadData, match="holds no events"):
        run_watch(path, once=True, json_target=None)
