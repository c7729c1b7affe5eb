"""Bolt torques from a tester on a line, into the session and its preload."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import BadData, InstrumentError
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.serial_lines.mark10 import Reading
from jointbench.acquisition.session_file.store import read_session
from jointbench.simulators.serial_instruments.dialogue import (
    Mark10Simulator,
    WrenchSimulator,
)
from jointbench.simulators.serial_instruments.serial_simulator import SerialSimulator
from jointbench.station.measure.bench_session import Measured, run_measure
from jointbench.station.measure.bolt_torques import PeakHold
from jointbench.station.measure.plan import read_plan

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
HITS = """
points = ["1"]
torques = ["20 N m", "50 N m"]
repeats = 1
trial_hits = 0
length = "0.3 s"
wait = "20 s"
"""


def plan_file(folder: Path, line: str, hits: str = HITS) -> Path:
    """Return the example's plan with a torque tester."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    path = folder / "plan.toml"
    torque = f'[torque]\nline = "{line}"\npoll = "0.1 ms"\n'
    path.write_text(f"{head}[hits]\n{hits}\n{torque}[joint]{tail}", encoding="utf-8")
    return path


def run(folder: Path, simulator: SerialSimulator, wait: str = "20 s") -> Measured:
    """Measure two torques with a tester."""
    return run_measure(
        plan_file(folder, simulator.name, HITS.replace("20 s", wait)),
        folder / "s.h5",
        source="sim:plates",
        overwrite=False,
        json_target=None,
    )


def bolts(folder: Path) -> Iterator[dict[str, object]]:
    """Return what the session says of its bolts."""
    steps: tuple[Step, ...] = read_session(folder / "s.h5").provenance
    return (dict(step.detail) for step in steps if step.name == "bolt")


@pytest.mark.parametrize("over_socket", [False, True])
def test_every_bolt_is_in_the_session_and_the_preload_is_theirs(
    tmp_path: Path, over_socket: bool
) -> None:
    """Bolts at +2, -1, 0, +3 %: P is 1.01 times 25 kN at 20 N m, hands-free."""
    wrench = WrenchSimulator((20.0, 50.0), 4, (0.02, -0.01, 0.0, 0.03))
    with SerialSimulator(wrench.answer, over_socket=over_socket) as simulator:
        measured = run(tmp_path, simulator)
    found = list(bolts(tmp_path))
    assert measured.whole
    assert [b["bolt"] for b in found] == [1, 2, 3, 4] * 2
    assert [b["torque"] for b in found[:4]] == pytest.approx([20.4, 19.8, 20.0, 20.6])
    preloads = {r.preload for r in read_session(tmp_path / "s.h5").recordings if r.hits}
    assert sorted(preloads) == pytest.approx([1.01 * 25e3, 1.01 * 62.5e3])


def test_a_bolt_beside_its_target_is_asked_for_again_and_both_are_kept_in_the_file(
    tmp_path: Path,
) -> None:
    """The second bolt is 30 % loose, then right: nine readings for eight bolts."""
    errors = (0.0, -0.3, 0.0, 0.0, 0.0)
    with SerialSimulator(WrenchSimulator((20.0,), 4, errors).answer) as simulator:
        run_measure(
            plan_file(tmp_path, simulator.name, HITS.replace(', "50 N m"', "")),
            tmp_path / "s.h5",
            source="sim:plates",
            overwrite=False,
            json_target=None,
        )
    found = [(b["bolt"], b["kept"]) for b in bolts(tmp_path)]
    assert found == [(1, True), (2, False), (2, True), (3, True), (4, True)]


def test_a_tester_unplugged_between_bolts_is_waited_for(tmp_path: Path) -> None:
    """It breaks off in an answer and comes back; nothing is lost, the plan is done."""
    wrench = WrenchSimulator((20.0, 50.0), 4)
    simulator = SerialSimulator(
        wrench.answer, over_socket=True, unplug_after=131, comes_back=True
    )
    with simulator:
        measured = run(tmp_path, simulator)
    assert measured.whole
    assert len(list(bolts(tmp_path))) == 8


@dataclass
class NoisyWrench:
    """A wrench of which every fifth answer is what noise made of it."""

    wrench: WrenchSimulator
    noise: bytes
    turn: int = 0

    def answer(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer with noise at times; the wrench waits for its reading to be taken."""
        self.turn += 1
        if self.turn % 5 == 0 and b"\r" in received:
            return received.index(b"\r") + 1, self.noise
        return self.wrench.answer(received)


@pytest.mark.parametrize(
    "noise",
    [b"\x81\r\n", b"20.\x8d4 Nm\r\n", b"nan Nm\r\n", b"9999.9 Nm\r\n", b"\r\n", b"12"],
)
def test_a_reading_that_is_none_ends_nothing_and_is_no_torque(
    tmp_path: Path, noise: bytes
) -> None:
    """Junk bytes, numbers that are none, five hundred times the target, half a line."""
    wrench = NoisyWrench(WrenchSimulator((20.0, 50.0), 4), noise)
    with SerialSimulator(wrench.answer, over_socket=True) as simulator:
        measured = run(tmp_path, simulator, "60 s")
    found = list(bolts(tmp_path))
    assert measured.whole
    assert [b["torque"] for b in found] == pytest.approx([20.0] * 4 + [50.0] * 4)


def test_a_bolt_that_is_not_tightened_ends_in_one_line_and_a_valid_file(
    tmp_path: Path,
) -> None:
    """The display stays at nothing for longer than the plan waits."""
    with (
        SerialSimulator(Mark10Simulator("0.000 Nm").answer) as simulator,
        pytest.raises(InstrumentError, match="bolt 1 was not tightened"),
    ):
        run(tmp_path, simulator, "0.2 s")
    assert read_session(tmp_path / "s.h5").recordings == ()


def test_a_gauge_that_shows_a_force_is_no_torque_tester(tmp_path: Path) -> None:
    """The reason is in the line."""
    with (
        SerialSimulator(Mark10Simulator("12.5 N").answer) as simulator,
        pytest.raises(InstrumentError, match="a torque is needed"),
    ):
        run(tmp_path, simulator, "0.2 s")


def test_a_torque_tester_without_torques_in_the_plan_is_refused(tmp_path: Path) -> None:
    """The key is named."""
    hits = HITS.replace('torques = ["20 N m", "50 N m"]', "")
    with pytest.raises(BadData, match="torques"):
        read_plan(plan_file(tmp_path, "COM3", hits))


def test_the_torque_of_a_bolt_is_the_largest_reading_between_two_rests() -> None:
    """20.3 N m, whichever readings lie around it; a touch of 1 N m begins nothing."""
    hold = PeakHold(20.0)
    shown = (0.0, 1.0, 0.2, 8.0, 15.0, 20.3, 19.9, 20.1, 9.0, 0.0)
    done = [hold.feed(Reading(value, "torque", "")) for value in shown]
    assert [reading.value for reading in done if reading is not None] == [20.3]
    assert done[-2] is not None
