"""The screen of a session: a function of its events, read from two metres away."""

import io
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.cells import cell_len
from rich.console import Console
from rich.live import Live

from jointbench.station.bench_view.bell import Bell
from jointbench.station.bench_view.big_letters import big_lines
from jointbench.station.bench_view.curve_lines import axis_line, curve_rows, with_axis
from jointbench.station.bench_view.level_meter import Level, LevelMeter
from jointbench.station.bench_view.operator_keys import KEYS, OperatorKeys
from jointbench.station.bench_view.session_screen import (
    Look,
    ViewContext,
    session_lines,
)
from jointbench.station.bench_view.terminal_view import TerminalView
from jointbench.station.session_events.condition_states import (
    condition_states,
    seconds_left,
)
from jointbench.station.session_events.event_codec import Event, Stamped
from jointbench.station.session_events.flow_commands import (
    AddNote,
    ContinueSession,
    PauseSession,
    QuitSession,
)
from jointbench.station.session_events.flow_events import (
    Asked,
    CableChanged,
    ConditionDone,
    RunBegun,
    SamplesMissing,
    SessionEnded,
    Warned,
)
from jointbench.station.session_events.hit_commands import AcceptHit, RejectHit
from jointbench.station.session_events.hit_events import GainForecast, HitJudged
from jointbench.station.session_events.operator_events import (
    CommandAnswered,
    PauseChanged,
    WarningsSeen,
)
from jointbench.station.session_events.session_state import SessionState, state_after
from jointbench.station.session_events.view_events import (
    BoltAsked,
    FileFinishing,
    HitAveraged,
    SessionBegun,
)

POINTS = ("1", "2", "a long name of a point")
BEGUN = SessionBegun(
    operator="A. Miller, of the laboratory for machine tools and their joints",
    source="sim:plates",
    simulated=True,
    sample_rate=1000.0,
    direction="+z",
    repeats=2,
    channels=[{"name": f"channel{k}", "range": 10.0} for k in range(16)],
    conditions=[
        {"name": f"{t:g} Nm, point {p}", "point": p, "torque": t, "level": None}
        for t in (20.0, 50.0)
        for p in (*POINTS, *(f"p{k}" for k in range(60)))
    ],
)
FRF = {name: [10.0 * (k % 7) for k in range(128)] for name in ("a1", "a2")}
COHERENCE = {name: [0.5] * 128 for name in FRF}
LEVELS = tuple(Level(str(c["name"]), 0.06 * k) for k, c in enumerate(BEGUN.channels))


def hit(
    number: int, verdict: str = "ok", reason: str = "single clean pulse"
) -> HitJudged:
    """Return a hit at point 1."""
    return HitJudged(number, 0, 10, 90, "1", 150.0, verdict, 0.1, reason)


def averaged(number: int, *, trial: bool = False) -> HitAveraged:
    """Return the average after a hit."""
    average = HitAveraged(number, 1, 2, trial, [0.0, 9.0, 1.0], 6e-3)
    if trial:
        return average
    return replace(
        average, band=[5.0, 4000.0], frf=FRF, coherence=COHERENCE, mean_coherence=0.5
    )


def after(*events: Event) -> SessionState:
    """Return the state after events, one a second from 1000 s on."""
    stamped = (Stamped(n, 1000.0 + n, 0, e) for n, e in enumerate(events))
    return state_after(SessionState(), stamped)


def gain(hit: int) -> GainForecast:
    """Return what two more hits would buy at five resonances, the last one worst."""
    peaks = [
        {
            "frequency": 100.0 * k,
            "damping": 0.01,
            "frequency_sd": 0.01 * k,
            "damping_sd": 0.03 * k,
            "frequency_sd_after": 0.008 * k,
            "damping_sd_after": 0.02 * k,
        }
        for k in range(1, 6)
    ]
    return GainForecast(hit, 2, peaks)


ASKED = Asked("20 Nm, point 1", "1", 0, 126)
RUN = RunBegun("20 Nm, point 1", "measurement", "1", 20.0)
TRIAL = RunBegun("trial", "trial", "1", 20.0)
LONG = Asked(f"20 Nm, point {POINTS[2]}", POINTS[2], 0, 126)
REFUSED = CommandAnswered(0, "terminal", {"command": "go"}, False, "no point " * 20)
STATES: dict[str, tuple[Event, ...]] = {
    "nothing": (),
    "begun": (BEGUN,),
    "asked": (BEGUN, RUN, ASKED),
    "trial": (BEGUN, TRIAL, ASKED, hit(0, "operator"), averaged(0, trial=True)),
    "good": (BEGUN, RUN, ASKED, hit(0), averaged(0)),
    "rejected": (BEGUN, RUN, ASKED, hit(0, "double", "two pulses " * 20), averaged(0)),
    "gain": (BEGUN, RUN, ASKED, hit(0), averaged(0), gain(0)),
    "paused": (BEGUN, RUN, ASKED, hit(0), averaged(0), PauseChanged(True)),
    "cable": (BEGUN, RUN, ASKED, CableChanged("channel2, channel7")),
    "bolt": (BEGUN, BoltAsked(2, 4, 50.0)),
    "long point": (BEGUN, RUN, LONG),
    "warned": (BEGUN, RUN, ASKED, *(Warned(f"{k} drifts " * 20) for k in range(5))),
    "lost": (BEGUN, RUN, ASKED, SamplesMissing("overrun", 0, 9, 500, 0.1, "-200279")),
    "refused": (BEGUN, RUN, ASKED, REFUSED),
    "done": (BEGUN, RUN, ASKED, ConditionDone("20 Nm, point 1", True), LONG),
    "ended": (BEGUN, RUN, ASKED, hit(0), averaged(0), SessionEnded(True)),
    "finishing": (BEGUN, RUN, SessionEnded(False), FileFinishing(0.456)),
}


def lines(
    events: Iterable[Event], width: int = 80, height: int = 24, prompt: str = ""
) -> list[str]:
    """Return the screen of events as plain text."""
    around = ViewContext("/long/" * 30 + "s.h5", 3_000_000_000, 1010.0, LEVELS)
    look = Look(width, height, prompt=prompt, keys=KEYS)
    return [line.plain for line in session_lines(after(*events), around, look)]


def test_an_ended_session_says_how_far_its_file_is_written() -> None:
    """Finishing the file of some hours takes minutes."""
    assert any("46 % of the session file" in one for one in lines(STATES["finishing"]))


@pytest.mark.parametrize(
    ("events", "words"),
    [
        ((SamplesMissing("lost", 0, 9, 0, 0.0, "gone"),), "is lost; hits wait"),
        (
            (
                SamplesMissing("lost", 0, 9, 0, 0.0, "gone"),
                SamplesMissing("back", 0, 9, 0, 2.0, "back"),
            ),
            "strike point 1",
        ),
        ((ConditionDone("20 Nm, point 1", False),), "the next point follows"),
    ],
)
def test_no_hit_is_asked_for_that_would_not_count(
    events: tuple[Event, ...], words: str
) -> None:
    """While the device is away, and between a point and the next one."""
    assert any(words in one for one in lines((BEGUN, RUN, ASKED, *events)))


@pytest.mark.parametrize("name", STATES)
@pytest.mark.parametrize("size", [(80, 24), (160, 50), (80, 50), (40, 12)])
def test_no_line_is_wider_and_no_screen_higher_than_the_terminal(
    name: str, size: tuple[int, int]
) -> None:
    """In all states, with long names, sixteen channels and 126 conditions."""
    for prompt in ("", "command: " + "note " * 60):
        shown = lines(STATES[name], *size, prompt=prompt)
        assert len(shown) <= size[1]
        assert max(cell_len(line) for line in shown) <= size[0]


def test_keys_fit_eighty_columns_whole() -> None:
    """None is cut."""
    assert tuple(lines(STATES["asked"])[-2:]) == KEYS


def test_what_to_strike_is_in_block_letters_and_in_words() -> None:
    """Point, direction and torque; small letters at 80 columns, large at 160."""
    shown = lines(STATES["asked"])
    assert tuple(s.rstrip() for s in shown[1:5]) == tuple(
        s.rstrip() for s in big_lines("1 +z 20 Nm", large=False)
    )
    assert "strike point 1 in +z, bolts at 20 N m" in shown[5]
    assert big_lines("1 +z 20 Nm", large=True)[0] in lines(STATES["asked"], 160, 50)[1]


@pytest.mark.parametrize(
    ("name", "word", "style"),
    [
        ("good", "OK", "green"),
        ("rejected", "DOUBLE", "red"),
        ("trial", "TRIAL", "cyan"),
    ],
)
def test_the_verdict_is_a_band_of_colour_over_the_whole_width(
    name: str, word: str, style: str
) -> None:
    """With the number of the hit and the reason below."""
    around = ViewContext("s.h5", None, 1010.0)
    shown = session_lines(after(*STATES[name]), around, Look(80, 24))
    (band,) = (line for line in shown if "HIT 1" in line.plain)
    assert word in band.plain
    assert band.cell_len == 80
    assert style in str(band.style)


def test_what_two_more_hits_buy_is_in_hertz_and_percent_until_the_next_hit() -> None:
    """The resonance whose damping is least certain; more of them on a wide screen."""
    wanted = "2 more hits: 500.0 Hz ±0.05 to ±0.04 Hz, damping ±15 to ±10 %"
    assert wanted in lines(STATES["gain"])
    (wide,) = (s for s in lines(STATES["gain"], 160, 50) if "2 more hits" in s)
    assert wide.startswith(f"{wanted}; 400.0 Hz")
    later = (*STATES["gain"], hit(1, "weak"), averaged(1))
    assert not any("more hits" in line for line in lines(later))


def test_before_the_first_event_nothing_is_said_of_hammer_hits_or_keys() -> None:
    """It may be a machine that is recorded; its keys have no hits either."""
    shown = "\n".join(lines(()))
    assert "the device and the session file are opened" in shown
    assert "hits left" not in shown
    console = Console(file=io.StringIO(), force_terminal=True, width=80, height=24)
    with Live(console=console, auto_refresh=False) as live:
        view = TerminalView(live, lambda: "", Path("s.h5"))
        runs = replace(BEGUN, conditions=[])
        run = RunBegun("3000 rpm", "operating", "", None, duration=9.0)
        view.follow((Stamped(0, 1.0, 0, runs), Stamped(1, 1.0, 0, run)))
    output = console.file
    assert isinstance(output, io.StringIO)
    assert "n next run" in output.getvalue()
    assert "r reject" not in output.getvalue()


def test_points_are_listed_as_done_open_and_incomplete() -> None:
    """With the hits that are left and the time, after one of two hits at one point."""
    state = after(*STATES["good"])
    marks = [c.mark.value for c in condition_states(state)][:2]
    assert marks == ["now", "open"]
    shown = "\n".join(lines(STATES["good"]))
    assert "hits left 1 here, 251 in all" in shown
    assert seconds_left(state, 1010.0) == pytest.approx(251 * 10.0)
    assert "1 incomplete" in "\n".join(lines(STATES["done"]))


def test_head_has_badge_operator_disk_and_the_end_of_the_file_name() -> None:
    """All in one line."""
    head = lines(STATES["begun"], 160, 50)[0]
    assert "SIMULATED" in head
    assert "A. Miller" in head
    assert "3.0 GB free" in head
    assert head.endswith("s.h5")


def test_warnings_stay_until_they_are_seen() -> None:
    """Five warnings, three of them on the screen; none once they are seen."""
    warned = STATES["warned"]
    assert sum("WARNING" in line for line in lines(warned)) == 3
    seen = (*warned, WarningsSeen(5))
    assert not any("WARNING" in line for line in lines(seen))


def test_every_channel_has_a_level_and_lamps() -> None:
    """Sixteen names; those near their range are overloaded, open loops are open."""
    shown = "\n".join(lines(STATES["cable"], 160, 50))
    assert all(str(c["name"])[:7] in shown for c in BEGUN.channels)
    assert "OPEN" in shown
    assert not LEVELS[-1].full
    assert Level("force", 0.98).full


def test_levels_are_the_largest_of_the_last_half_second() -> None:
    """A peak leaves after half a second; the range is the scale."""
    meter = LevelMeter()
    meter.feed(np.full((1, 100), 5.0), sample_rate=1000.0)
    for _ in range(4):
        meter.feed(np.full((1, 100), 0.5), sample_rate=1000.0)
    channels = [{"name": "force", "range": 10.0}]
    assert meter.levels(channels) == (Level("force", 0.5),)
    meter.feed(np.full((1, 100), 0.5), sample_rate=1000.0)
    assert meter.levels(channels) == (Level("force", 0.05),)


def test_a_curve_rises_from_its_low_to_its_high_and_has_numbers_at_its_axes() -> None:
    """Empty at the low, full at the high; the ends of both axes are stated."""
    rows = curve_rows([k / 640 for k in range(641)], 0.0, 1.0, width=64, rows=2)
    assert rows[1][0] == " "
    assert rows[0][-1] == "█"
    assert with_axis(rows, "0 dB", "-60 dB")[0].startswith("   0 dB │")
    axis = axis_line(0.0, 4000.0, "Hz", width=71)
    assert axis.startswith("0")
    assert axis.endswith("4000 Hz")


def test_the_channel_of_the_frf_is_chosen_by_key() -> None:
    """Once on and once back."""
    keys = OperatorKeys()
    around = ViewContext("s.h5", None, 1010.0)
    for key, name in (("c", "FRF of a2"), ("C", "FRF of a1")):
        keys.press(key, SessionState())
        look = Look(80, 30, channel=keys.channel)
        shown = session_lines(after(*STATES["good"]), around, look)
        assert any(name in line.plain for line in shown)


@pytest.mark.parametrize(
    ("pressed", "command"),
    [
        ("a", AcceptHit()),
        ("R", RejectHit()),
        ("h17\r", RejectHit(17)),
        ("tbolt 2 rubs\n", AddNote("bolt 2 rubs")),
        ("ta\x7fbolt\n", AddNote("bolt")),
        (":accept 3\n", AcceptHit(3)),
        (" ", PauseSession()),
        ("qy", QuitSession(confirmed=True)),
        ("qx", None),
        ("h\x1b", None),
        (":dance\n", None),
        ("x", None),
        ("", None),
    ],
)
def test_keys_become_commands(pressed: str, command: object) -> None:
    """Single keys, typed lines, a question before quitting; other keys do nothing."""
    assert OperatorKeys().press(pressed, SessionState()) == command


def test_a_typed_line_that_is_no_command_says_so_until_a_key() -> None:
    """And space continues a session that pauses."""
    keys = OperatorKeys()
    keys.press(":rejct 3\n", SessionState())
    assert "did you mean 'reject'" in keys.prompt
    keys.press("x", SessionState())
    assert keys.prompt == ""
    paused = after(PauseChanged(True))
    assert keys.press(" ", paused) == ContinueSession()


def test_the_bell_rings_once_for_a_good_hit_and_twice_for_a_rejected_one() -> None:
    """A quarter of a second apart; a trial hit that is fit counts as good."""
    rings: list[float] = []
    clock = iter([k / 10 for k in range(100)])
    time = 0.0

    def now() -> float:
        return time

    bell = Bell(lambda: rings.append(time), now=now)
    for verdict, trial, count in (("ok", False, 1), ("weak", False, 2)):
        bell.hit(hit(0, verdict), averaged(0, trial=trial))
        rings.clear()
        for _ in range(10):
            time = next(clock)
            bell.tick()
        assert len(rings) == count


def test_who_joins_late_rings_no_bell_and_sees_the_same() -> None:
    """The state is equal; only events after joining ring."""
    made = []
    for join in (False, True):
        console = Console(file=io.StringIO(), force_terminal=True, width=80, height=24)
        with Live(console=console, auto_refresh=False) as live:
            view = TerminalView(live, lambda: "", Path("s.h5"))
            stamped = tuple(Stamped(n, 1.0, 0, e) for n, e in enumerate(STATES["good"]))
            (view.join if join else view.follow)(stamped)
            view.command()
        output = console.file
        assert isinstance(output, io.StringIO)
        made.append((view.state, "\x07" in output.getvalue()))
    assert made[0][0] == made[1][0]
    assert [rang for _, rang in made] == [True, False]
