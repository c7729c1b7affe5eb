"""What the operator says while a session runs, and what interrupts it."""

import io
import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from rich.live import Live

from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.records.recordings import Hit, Quantity, Verdict
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.hits.find_hits import HitCriteria, find_hits
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.simulators.measuring.operator import Fate, SimulatedOperator
from jointbench.simulators.plates.plates_bench import PlatesBench
from jointbench.station.bench_view.session_screen import (
    Look,
    ViewContext,
    session_lines,
)
from jointbench.station.bench_view.terminal_view import TerminalView
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.bench_view.watch_session import run_watch
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.measure.bench_session import Measured, measure, run_measure
from jointbench.station.measure.chassis import (
    OpenChassis,
    OperatorOfSimulation,
    open_chassis,
)
from jointbench.station.measure.observer import Operator as Striker
from jointbench.station.measure.plan import Condition, read_plan
from jointbench.station.pipeline.judge_again import StoredHits, judge_again
from jointbench.station.screen.terminal import console
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.event_codec import Stamped, from_log
from jointbench.station.session_events.flow_commands import (
    AddNote,
    ChangeSetting,
    ContinueSession,
    PauseSession,
    QuitSession,
    SeeWarnings,
)
from jointbench.station.session_events.hit_commands import (
    AcceptHit,
    GoToPoint,
    NextPoint,
    RejectHit,
    RepeatPoint,
    UndoVerdict,
)
from jointbench.station.session_events.session_state import SessionState, state_after
from jointbench.station.session_events.view_events import HitAveraged

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
HITS = """
points = ["1", "2"]
torques = ["20 N m"]
repeats = 2
trial_hits = 0
length = "0.3 s"
levels = ["150 N"]
"""


@dataclass
class Operator(TextScreen):
    """Says one thing after each of some hits; keeps what was reported."""

    after: dict[int, tuple[Command, ...]] = field(default_factory=dict)
    heard: list[str] = field(default_factory=list)
    on_hit: Callable[[int], None] = lambda number: None
    _waiting: list[Command] = field(default_factory=list)
    _paused: int = 0

    def __post_init__(self) -> None:
        """Give the commands that come before the first hit."""
        self._waiting += self.after.pop(0, ())

    def follow(self, events: Sequence[Stamped]) -> None:
        """Think of what to say."""
        TextScreen.follow(self, events)
        for stamped in events:
            if isinstance(stamped.event, HitAveraged):
                number = stamped.event.hit + 1
                self._waiting += self.after.pop(number, ())
                self.on_hit(number)

    def level(self, samples: np.ndarray) -> None:
        """Continue after forty blocks of a pause, however long they take."""
        self._paused = self._paused + 1 if self._state.paused else 0
        if self._paused == 40:
            self._waiting.append(ContinueSession())

    def command(self) -> Command | None:
        """Say it, one thing a block."""
        return self._waiting.pop(0) if self._waiting else None

    def _print(self, line: str) -> None:
        self.heard.append(line)


@dataclass(eq=False)
class Wandering:
    """Strikes point 3 the first time, whatever it is asked for."""

    chassis: Chassis
    asked: int = 0

    def ask(self, condition: Condition) -> None:
        """Ask for one stroke, once at the wrong place."""
        place = condition if self.asked else replace(condition, point="3")
        self.asked += 1
        OperatorOfSimulation(self.chassis).ask(place)


def plan_file(folder: Path) -> Path:
    """Write the plan: two points, two hits each."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{HITS}\n[joint]{tail}", encoding="utf-8")
    return path


def session(
    folder: Path,
    after: dict[int, tuple[Command, ...]],
    *,
    fates: tuple[Fate, ...] = (Fate.GOOD,),
    on_hit: Callable[[int], None] = lambda number: None,
    hand: Callable[[Chassis], Striker] = OperatorOfSimulation,
) -> tuple[Measured, Operator]:
    """Measure two points, two hits each, with an operator who says things."""
    path = plan_file(folder)
    operator = Operator(console("-"), after=dict(after), on_hit=on_hit)
    setup = ChassisSetup(
        bench=PlatesBench(operator=SimulatedOperator(fates=fates)), speed=math.inf
    )
    with SimulatedChassis(setup) as server:
        chassis = Chassis(server.address)
        opened = OpenChassis(chassis, "sim:", True, hand(chassis))
        measured = measure(read_plan(path), opened, folder / "s.h5", operator)
        chassis.close()
    return measured, operator


def stored(folder: Path) -> list[Hit]:
    """Return the hits as the file has them."""
    return [h for r in read_session(folder / "s.h5").recordings for h in r.hits]


def points(folder: Path, verdict: Verdict = Verdict.OK) -> list[str]:
    """Return the points of the hits of a verdict."""
    return [hit.point for hit in stored(folder) if hit.verdict is verdict]


def test_a_hit_rejected_by_the_operator_is_made_up_for(tmp_path: Path) -> None:
    """It stays in the file, with the operator and the earlier verdict."""
    measured, _ = session(tmp_path, {1: (RejectHit(),)})
    hits = stored(tmp_path)
    assert measured.whole
    assert hits[0].verdict is Verdict.OPERATOR
    assert hits[0].reason.startswith("rejected by the operator; was ok")
    assert points(tmp_path) == ["1", "1", "2", "2"]


def test_a_bad_hit_accepted_by_the_operator_counts(tmp_path: Path) -> None:
    """A double hit, kept: no hit more than the plan wants."""
    measured, _ = session(
        tmp_path, {1: (AcceptHit(),)}, fates=(Fate.DOUBLE, *[Fate.GOOD] * 9)
    )
    hits = stored(tmp_path)
    assert measured.whole
    assert len(hits) == 4
    assert hits[0].reason.startswith("accepted by the operator; was double")


def test_undo_takes_the_last_word_back(tmp_path: Path) -> None:
    """Rejected and undone: the hit has its own verdict again, word for word."""
    measured, _ = session(tmp_path, {1: (RejectHit(), UndoVerdict())})
    assert measured.whole
    assert len(stored(tmp_path)) == 4
    assert stored(tmp_path)[0].reason.startswith("single clean pulse")


def test_undo_without_a_word_takes_the_last_hit_out(tmp_path: Path) -> None:
    """A wrong key without an earlier command."""
    session(tmp_path, {1: (UndoVerdict(),)})
    assert stored(tmp_path)[0].reason.startswith("taken back by the operator")


def test_rejecting_the_hit_that_ended_a_point_goes_back_to_it(tmp_path: Path) -> None:
    """Hit 2 ends point 1; rejected, point 1 is struck once more before point 2."""
    measured, _ = session(tmp_path, {2: (RejectHit(),)})
    assert measured.whole
    assert [hit.point for hit in stored(tmp_path)] == ["1", "1", "1", "2", "2"]


def test_repeat_sets_the_hits_of_the_point_aside(tmp_path: Path) -> None:
    """After the first hit at point 2 that point starts again; point 1 stays."""
    measured, _ = session(tmp_path, {3: (RepeatPoint(),)})
    assert measured.whole
    assert points(tmp_path) == ["1", "1", "2", "2"]
    assert points(tmp_path, Verdict.OPERATOR) == ["2"]


def test_repeat_before_the_first_hit_repeats_the_point_before(tmp_path: Path) -> None:
    """Point 1 is just done; both its hits are set aside and it is struck again."""
    measured, _ = session(tmp_path, {2: (RepeatPoint(),)})
    assert measured.whole
    assert points(tmp_path, Verdict.OPERATOR) == ["1", "1"]
    assert points(tmp_path) == ["1", "1", "2", "2"]


def test_next_leaves_a_point_that_is_not_done_and_says_so(tmp_path: Path) -> None:
    """One hit at point 1, two at point 2; the session is not whole."""
    measured, _ = session(tmp_path, {1: (NextPoint(),)})
    assert measured.record.incomplete == ["20 Nm, point 1, 150 N"]
    assert not measured.whole
    assert points(tmp_path) == ["1", "2", "2"]


def test_quit_ends_with_a_valid_file(tmp_path: Path) -> None:
    """What was recorded until then is whole, and says that it was interrupted."""
    measured, _ = session(tmp_path, {2: (QuitSession(confirmed=True),)})
    ends = [dict(s.detail) for s in read_session(tmp_path / "s.h5").provenance]
    assert measured.record.interrupted
    assert run_verify(tmp_path / "s.h5", json_target=None)
    assert any(end.get("interrupted") is True for end in ends)
    assert len(stored(tmp_path)) == 2


@pytest.mark.parametrize("number", [1, 2, 3])
def test_ctrl_c_at_a_hit_ends_with_a_valid_file(tmp_path: Path, number: int) -> None:
    """All hits judged so far are in it."""

    def interrupt(count: int) -> None:
        if count == number:
            raise KeyboardInterrupt

    measured, _ = session(tmp_path, {}, on_hit=interrupt)
    assert measured.record.interrupted
    assert run_verify(tmp_path / "s.h5", json_target=None)
    assert len(stored(tmp_path)) == number


def test_a_word_before_the_first_hit_says_that_there_is_none(tmp_path: Path) -> None:
    """And nothing else comes of it."""
    measured, operator = session(tmp_path, {0: (AcceptHit(),)})
    assert "there is no hit yet" in operator.heard
    assert measured.whole


def test_a_hit_at_another_point_is_found_out_though_it_came_first(
    tmp_path: Path,
) -> None:
    """The first of three is struck at point 3: the other two agree, it is taken out."""
    measured, _ = session(tmp_path, {}, hand=Wandering)
    verdicts = [hit.verdict for hit in stored(tmp_path)]
    assert measured.whole
    assert verdicts[0] is Verdict.POOR_COHERENCE
    assert stored(tmp_path)[0].measure < 0.9
    assert verdicts.count(Verdict.OK) == 4


def test_a_hit_of_an_earlier_point_is_rejected_by_its_number_and_made_up_for(
    tmp_path: Path,
) -> None:
    """Hit 1 of point 1, rejected at point 2: point 1 is open again and asked for.

    Reprocessing keeps it rejected; the command with its answer is in the log.
    """
    measured, operator = session(tmp_path, {3: (RejectHit(1), RejectHit(99))})
    assert measured.whole
    assert "hit 1 is rejected, its point needs one more" in operator.heard
    assert "there is no hit 99; 3 were struck" in operator.heard
    assert points(tmp_path) == ["1", "2", "2", "1"]
    recordings = read_session(tmp_path / "s.h5").recordings
    judged = judge_again(recordings, HitCriteria(), StoredHits(again=True))
    verdicts = [hit.verdict for found in judged for hit in found.hits]
    assert verdicts.count(Verdict.OPERATOR) == 1
    log, _ = read_log(tmp_path / "s.h5")
    answers = [(e["words"], e["done"]) for e in log if e["kind"] == "command"]
    assert len(answers) == 2
    assert [done for _, done in answers] == [True, False]


def test_the_operator_goes_to_a_point_notes_and_quits_only_when_sure(
    tmp_path: Path,
) -> None:
    """Point 2 after one hit at point 1; then back, with the first hit still there."""
    words = {
        1: (GoToPoint("9"), GoToPoint("2"), AddNote(" bolt  2 rubs "), QuitSession()),
        3: (SeeWarnings(),),
    }
    measured, operator = session(tmp_path, words)
    assert measured.whole
    assert points(tmp_path) == ["1", "2", "2", "1"]
    assert "the plan has no point '9'; it has 1, 2" in operator.heard
    assert "2 of 2 conditions are open; confirm with 'quit yes'" in operator.heard
    steps = read_session(tmp_path / "s.h5").provenance
    assert [dict(s.detail)["words"] for s in steps if s.name == "note"] == [
        "bolt 2 rubs"
    ]


def test_the_operator_sets_trigger_and_length_within_their_limits(
    tmp_path: Path,
) -> None:
    """A trigger in the noise is refused; a longer record holds from the next hit on."""
    said = (
        ChangeSetting("trigger_n", 1e-6),
        ChangeSetting("band_hz", 100.0),
        ChangeSetting("trigger_n", 7.0),
        ChangeSetting("length_s", 0.75),
    )
    _, operator = session(tmp_path, {1: said})
    first, *_, last = stored(tmp_path)
    heard = "\n".join(operator.heard)
    assert "trigger_n is between" in heard
    assert "'band_hz' cannot be set" in heard
    assert "trigger_n is 7 from now on" in heard
    assert last.stop - last.trigger == round(0.75 * 12_800)
    assert first.stop - first.trigger < last.stop - last.trigger


def test_hits_during_a_pause_are_ignored_and_never_found_again(tmp_path: Path) -> None:
    """A hit of the simulated operator falls into the pause; the stream continues."""
    words = {1: (NextPoint(), PauseSession())}
    measured, _ = session(tmp_path, words, fates=(Fate.GOOD,))
    assert [hit.point for hit in measured.record.hits] == ["1", "2", "2"]
    recordings = read_session(tmp_path / "s.h5").recordings
    (pause,) = (r for r in recordings if r.name == "pause")
    assert find_hits(pause).hits
    judged = judge_again(recordings, HitCriteria(), StoredHits(again=True))
    assert sum(len(found.hits) for found in judged) == 3


def test_a_second_view_in_the_middle_of_a_session_draws_the_same_screen(
    tmp_path: Path,
) -> None:
    """From a copy of the file at hit 3, and from the finished file at the end."""
    plan = read_plan(plan_file(tmp_path))
    path, copy = tmp_path / "s.h5", tmp_path / "copy.h5"
    drawn: list[tuple[SessionState, SessionState]] = []

    class Copying(TerminalView):
        """Compares itself with a view that joins now."""

        def follow(self, events: Sequence[Stamped]) -> None:
            """Compare, once after hit 3."""
            TerminalView.follow(self, events)
            if len(self.state.hits) == 3 and not drawn:
                shutil.copy(path, copy)
                # The recorder may have written the next event already.
                logged = from_log(read_log(copy)[0])
                seen = [one for one in logged if one.id <= self.state.last]
                late = state_after(SessionState(), seen)
                drawn.append((self.state, late))

    terminal = Console(file=io.StringIO(), force_terminal=True, width=80, height=24)
    with (
        Live(console=terminal, auto_refresh=False) as live,
        open_chassis("sim:plates") as opened,
    ):
        view = Copying(live, lambda: "", path)
        measure(plan, opened, path, view)
    drawn.append((view.state, run_watch(path, once=True, json_target=None)))
    for own, late in drawn:
        assert late == own
        around = ViewContext("s.h5", None, late.last_time)
        one, other = (session_lines(s, around, Look(80, 24)) for s in (own, late))
        assert [line.plain for line in one] == [line.plain for line in other]
    assert view.state.ended is not None


def test_a_temperature_is_recorded_beside_every_hit(tmp_path: Path) -> None:
    """It is in no FRF and no check; each hit has its samples in the file."""
    plan = plan_file(tmp_path)
    air = (
        '\n[[sensors]]\nname = "air"\nquantity = "temperature"\n'
        'physical = "cDAQSim1Mod2/ai0"\nsensitivity = "10 mV/degC"\n'
        'range = "100 degC"\n'
    )
    plan.write_text(plan.read_text(encoding="utf-8") + air, encoding="utf-8")
    measured = run_measure(
        plan,
        tmp_path / "s.h5",
        source="sim:plates?modules=2",
        overwrite=False,
        json_target=None,
    )
    assert measured.whole
    assert len(measured.record.checks) == 3
    for recording in read_session(tmp_path / "s.h5").recordings:
        row = recording.row(Quantity.TEMPERATURE)
        for hit in recording.hits:
            assert recording.samples[row, hit.start : hit.stop].size > 3000
