"""A session by a plan, hands-free, on the simulated chassis through the real client."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.modal.modes import ModalSettings
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.simulators.measuring.operator import Fate, SimulatedOperator
from jointbench.simulators.plates.plates import PlatesDesign, natural_frequencies
from jointbench.simulators.plates.plates_bench import PlatesBench
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.commands.verify_command import run_recover, run_verify
from jointbench.station.main import app, exit_code
from jointbench.station.measure.bench_session import Measured, measure, run_measure
from jointbench.station.measure.chassis import (
    OpenChassis,
    OperatorOfSimulation,
    open_chassis,
)
from jointbench.station.measure.plan import conditions, read_plan
from jointbench.station.pipeline.chain import ChainSettings
from jointbench.station.screen.terminal import console

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"


def plan_file(folder: Path, **changes: str) -> Path:
    """Return the example's plan at 12.8 kHz, one torque, one point, changed."""
    hits = {
        "points": '["1"]',
        "torques": '["20 N m"]',
        "repeats": "2",
        "trial_hits": "0",
        "length": '"0.5 s"',
        "levels": '["150 N"]',
    } | changes
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    table = "\n".join(f"{key} = {value}" for key, value in hits.items())
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{table}\n[joint]{tail}", encoding="utf-8")
    return path


def run(folder: Path, source: str = "sim:plates", **changes: str) -> Measured:
    """Measure a small plan."""
    return run_measure(
        plan_file(folder, **changes),
        folder / "s.h5",
        source=source,
        overwrite=False,
        json_target=str(folder / "s.json"),
    )


def test_a_plan_is_measured_to_its_end_without_a_key(tmp_path: Path) -> None:
    """Two points, two hits each; every sample that the device made is in the file."""
    measured = run(tmp_path, points='["1", "2"]')
    content = json.loads((tmp_path / "s.json").read_text())
    session = read_session(tmp_path / "s.h5")
    stored = sum(r.samples.shape[1] for r in session.recordings)
    assert measured.whole
    assert content["verdicts"]["ok"] == len(content["hits"]) == 4
    assert content["lost_samples"] == 0
    assert stored == content["acquired_samples"]
    assert session.simulated


def test_a_recording_carries_the_preload_of_its_torque(tmp_path: Path) -> None:
    """P = n T / (K d) = 4 x 20 / (0.2 x 0.016) = 25 kN."""
    run(tmp_path, repeats="1")
    last = read_session(tmp_path / "s.h5").recordings[-1]
    assert last.preload == pytest.approx(25e3)
    assert last.hits[0].point == "1"


def test_the_driving_point_and_a_reciprocal_pair_are_checked(tmp_path: Path) -> None:
    """Points 1 and 2 carry sensors: two driving points and one pair, all good."""
    measured = run(tmp_path, points='["1", "2"]')
    names = [check.name for check in measured.record.checks]
    assert names == ["driving point 1", "driving point 2", "reciprocity 1 - 2"]
    assert all(check.passed for check in measured.record.checks)


def test_trial_hits_propose_settings_and_enter_no_average(tmp_path: Path) -> None:
    """Trigger, length, windows, band and a range for each channel, with reasons."""
    measured = run(tmp_path, trial_hits="2", repeats="1")
    values = {p.name: p.value for p in measured.record.proposals}
    assert 0.5 < values["trigger_n"] < 20.0
    assert 500.0 < values["band_hz"] < 6400.0
    assert "range_a6" in values
    assert all(p.reason for p in measured.record.proposals)
    verdicts = [hit.verdict for hit in measured.record.hits]
    assert verdicts == [Verdict.OPERATOR, Verdict.OPERATOR, Verdict.OK]


FATES = (Fate.GOOD, Fate.DOUBLE, Fate.OVERLOAD, Fate.WEAK, Fate.GOOD)
VERDICTS = {
    Fate.GOOD: Verdict.OK,
    Fate.DOUBLE: Verdict.DOUBLE,
    Fate.OVERLOAD: Verdict.OVERLOAD,
    Fate.WEAK: Verdict.WEAK,
}


def test_every_scripted_hit_gets_its_verdict_and_only_good_ones_count(
    tmp_path: Path,
) -> None:
    """Good, double, overload, weak, good: two are averaged, five are in the file."""
    plan = read_plan(plan_file(tmp_path))
    bench = PlatesBench(operator=SimulatedOperator(fates=FATES))
    setup = ChassisSetup(bench=bench, speed=math.inf)
    with SimulatedChassis(setup) as server:
        chassis = Chassis(server.address)
        opened = OpenChassis(chassis, "sim:", True, OperatorOfSimulation(chassis))
        measured = measure(plan, opened, tmp_path / "s.h5", TextScreen(console("-")))
        chassis.close()
        wanted = [VERDICTS[stroke.fate] for stroke in server.history]
    assert [hit.verdict for hit in measured.record.hits] == wanted
    stored = [h for r in read_session(tmp_path / "s.h5").recordings for h in r.hits]
    assert [hit.verdict for hit in stored] == wanted


def test_the_first_hit_of_a_point_is_compared_with_those_before_it(
    tmp_path: Path,
) -> None:
    """No level in the plan: a weak first stroke at point 2 is asked for again."""
    fates = (Fate.GOOD, Fate.WEAK, Fate.GOOD)
    plan = read_plan(plan_file(tmp_path, points='["1", "2"]', repeats="1", levels="[]"))
    setup = ChassisSetup(
        bench=PlatesBench(operator=SimulatedOperator(fates=fates)), speed=math.inf
    )
    with SimulatedChassis(setup) as server:
        chassis = Chassis(server.address)
        opened = OpenChassis(chassis, "sim:", True, OperatorOfSimulation(chassis))
        measured = measure(plan, opened, tmp_path / "s.h5", TextScreen(console("-")))
        chassis.close()
    verdicts = [hit.verdict for hit in measured.record.hits]
    assert verdicts == [Verdict.OK, Verdict.WEAK, Verdict.OK]


def test_a_dropped_server_pauses_the_session_and_the_gap_is_in_the_file(
    tmp_path: Path,
) -> None:
    """Two drops of a tenth of a second; the plan is done nevertheless."""
    faults = "drop@6000:0.1,drop@14000:0.1"
    measured = run(tmp_path, f"sim:plates?faults={faults}")
    session = read_session(tmp_path / "s.h5")
    gaps = [dict(s.detail)["what"] for s in session.provenance if s.name == "gap"]
    assert measured.whole
    assert gaps == ["lost", "back", "lost", "back"]


def test_an_overrun_is_counted_as_lost_samples(tmp_path: Path) -> None:
    """3000 samples are overwritten at the device; the file ends one recording there."""
    measured = run(tmp_path, "sim:plates?faults=overrun@6400:3000")
    content = json.loads((tmp_path / "s.json").read_text())
    assert measured.whole
    assert content["lost_samples"] == 3000
    assert content["lost_samples"] == content["gaps"][0]["samples"]


def test_a_cable_off_pauses_the_session_until_it_is_back(tmp_path: Path) -> None:
    """The loop of a1 opens after a hit and closes again; no hit falls in between."""
    faults = "open@12000:1,close@40000:1"
    measured = run(tmp_path, f"sim:plates?faults={faults}", repeats="3")
    session = read_session(tmp_path / "s.h5")
    words = [
        dict(s.detail)["channels"] for s in session.provenance if s.name == "cable"
    ]
    assert words == ["a1", "all closed again"]
    assert measured.whole


def test_a_wrong_teds_warns_by_channel(tmp_path: Path) -> None:
    """The warning is in the file, the session continues."""
    measured = run(tmp_path, "sim:plates?faults=wrong_teds@0:1", repeats="1")
    session = read_session(tmp_path / "s.h5")
    warnings = [
        str(dict(s.detail)["words"]) for s in session.provenance if s.name == "warning"
    ]
    assert measured.whole
    assert any("'a1'" in words and "131231" in words for words in warnings)


def test_the_same_seed_gives_the_same_session_bit_for_bit(tmp_path: Path) -> None:
    """Simulated sessions do not depend on timing."""
    streams = []
    for name in ("one", "two"):
        folder = tmp_path / name
        folder.mkdir()
        run(folder, "sim:plates?seed=7")
        recordings = read_session(folder / "s.h5").recordings
        streams.append(np.concatenate([r.samples for r in recordings], axis=1))
    np.testing.assert_array_equal(streams[0], streams[1])


def test_modes_of_each_torque_are_the_specimens_own(tmp_path: Path) -> None:
    """Two torques are never averaged: each finds its modes within 0.2 %."""
    run(
        tmp_path,
        torques='["20 N m", "80 N m"]',
    )
    run_modal(
        [tmp_path / "s.h5"],
        ChainSettings(modal=ModalSettings(band=(200.0, 1100.0))),
        json_target=str(tmp_path / "m.json"),
    )
    pages = json.loads((tmp_path / "m.json").read_text())["preloads"]
    assert [page["preload_n"] for page in pages] == pytest.approx([25e3, 100e3])
    for page, torque in zip(pages, (20.0, 80.0), strict=True):
        own = natural_frequencies(PlatesDesign(), torque)
        own = own[(own > 210) & (own < 1090)]
        assert own.size >= 5
        found = np.array([mode["frequency_hz"] for mode in page["modes"]])
        nearest = found[np.argmin(np.abs(found[:, None] - own), axis=0)]
        np.testing.assert_allclose(nearest, own, rtol=2e-3)


def test_verify_reads_a_session_through(tmp_path: Path) -> None:
    """Whole means: checksums right, hits inside, every sample accounted for."""
    run(tmp_path, repeats="1")
    assert run_verify(tmp_path / "s.h5", json_target=None)


def test_a_finished_session_needs_no_recovery(tmp_path: Path) -> None:
    """The error names what to type instead."""
    run(tmp_path, repeats="1")
    with pytest.raises(UsageError, match="verify"):
        run_recover(tmp_path / "s.h5", out=None, overwrite=False, json_target=None)


def test_a_session_that_is_there_is_not_overwritten(tmp_path: Path) -> None:
    """It takes --force to do that."""
    (tmp_path / "s.h5").write_bytes(b"precious")
    with pytest.raises(UsageError, match="--force"):
        run(tmp_path)
    assert (tmp_path / "s.h5").read_bytes() == b"precious"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"2.25 mV/N"', '"2.25"', "volts per unit"),
        ('"cDAQSim1Mod1/ai1"', '"cDAQSim1Mod1/ai0"', "used twice"),
        ('range = "2200 N"', "range = 2200", "range"),
        ("repeats = 2", "repeats = 0", "repeats"),
        ("[joint]", "[joints]", "joints"),
    ],
)
def test_a_plan_that_makes_no_sense_names_the_key(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """File, key, value and rule are in one line."""
    path = plan_file(tmp_path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(BadData, match=words):
        read_plan(path)


def test_conditions_come_torque_by_torque(tmp_path: Path) -> None:
    """A torque wrench is taken up once for all points."""
    path = plan_file(tmp_path, points='["1", "2"]', torques='["20 N m", "50 N m"]')
    names = [condition.name for condition in conditions(read_plan(path))]
    assert names == [
        "20 Nm, point 1, 150 N",
        "20 Nm, point 2, 150 N",
        "50 Nm, point 1, 150 N",
        "50 Nm, point 2, 150 N",
    ]


def test_an_unknown_source_says_what_there_is() -> None:
    """Exit code 2 and one line."""
    with (
        pytest.raises(UsageError, match=r"ni\+grpc"),
        open_chassis("ni-grpc://host:1"),
    ):
        raise AssertionError


def test_without_a_driver_measure_leaves_with_the_instrument_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 4 on a computer without NI-DAQmx."""
    plan = plan_file(tmp_path)
    out = tmp_path / "s.h5"
    words = ["jointbench", "measure", str(plan), "--out", str(out), "--source", "ni:"]
    monkeypatch.setattr("sys.argv", words)
    assert exit_code(app, debug=False) == 4
    assert not out.exists()


def test_a_stand_alone_server_is_measured_by_its_address(tmp_path: Path) -> None:
    """`ni+grpc://` finds the simulated device and its operator."""
    setup = replace(ChassisSetup(), speed=math.inf)
    with SimulatedChassis(setup) as server:
        measured = run(tmp_path, f"ni+grpc://{server.address}", repeats="1")
    assert measured.whole
