"""Preload from load washers and elongations, and the temperature of each hit."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import jointbench
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.simulators.plates.slow_sensors import SlowSensors
from jointbench.station.bolts.bolt_forces import BoltForce, BoltForces, preload_of
from jointbench.station.doctor.bolt_checks import bolt_findings
from jointbench.station.measure.bench_session import run_measure
from jointbench.station.measure.plan import read_plan
from jointbench.station.pipeline.recordings_by_preload import by_preload, preload_words
from jointbench.station.schemas.bolt_force_table import BoltForceTable

PLAN = Path(__file__).parents[3] / "examples" / "plates-preload.toml"
SOURCE = "sim:plates?seed=1&modules=2&washers=2&thermometer=1"
CHANNELS = (
    Channel("force", Quantity.FORCE, unit="N"),
    Channel("w1", Quantity.VOLTAGE, unit="V"),
    Channel("t1", Quantity.TEMPERATURE, point="1", unit="degC"),
)


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Yield the session of the example's plan, one point."""
    folder = tmp_path_factory.mktemp("bolts")
    text = PLAN.read_text(encoding="utf-8").replace('["1", "2"]', '["1"]')
    plan = folder / "plan.toml"
    plan.write_text(text.replace("repeats = 3", "repeats = 2"), encoding="utf-8")
    out = folder / "s.h5"
    run_measure(
        plan, out, source=SOURCE, overwrite=False, json_target=str(folder / "s.json")
    )
    yield out


def hit_runs(session: Session) -> dict[float, tuple[float, float]]:
    """Return preload and sd of the conditions [N] by torque [N m]."""
    return {
        float(str(dict(r.provenance[0].detail)["torque"])): (r.preload, r.preload_sd)
        for r in session.recordings
        if r.hits and r.preload is not None and r.preload_sd is not None
    }


def test_the_preload_of_a_session_is_that_of_its_washers(measured: Path) -> None:
    """Its interval holds what the bolts have, which the plan's nut factor misses."""
    found = hit_runs(read_session(measured))
    assert sorted(found) == [20.0, 50.0]
    bolts = SlowSensors(2, thermometer=True, seed=1)
    for torque, (preload, sd) in found.items():
        bolts.tighten(torque, 0.0)
        truth = 2 * bolts.forces(0.0).sum()  # two of four have a washer
        assert abs(preload - truth) < 3 * sd
        assert 0.01 < sd / preload < 0.1


def test_recordings_of_one_tightening_have_one_preload_and_go_together(
    measured: Path,
) -> None:
    """Two torques are two groups, which are shown with what was measured."""
    groups = by_preload(read_session(measured).recordings)
    assert len(groups) == 2
    assert "measured (sd " in preload_words(*groups[0])


def test_preload_and_temperature_survive_a_copy_and_are_shown(
    measured: Path, tmp_path: Path
) -> None:
    """Through HDF5, the library's arrays and the log of the bolts."""
    session = read_session(measured)
    write_session(session, tmp_path / "copy.h5")
    again = read_session(tmp_path / "copy.h5")
    assert hit_runs(again) == hit_runs(session)
    warm = [h.temperature for r in again.recordings for h in r.hits]
    assert warm == [h.temperature for r in session.recordings for h in r.hits]
    assert all(t is not None and 20.9 < t < 21.2 for t in warm)
    table = jointbench.hits(jointbench.open(measured)).to_xarray()
    assert table["temperature"].attrs["units"] == "degC"
    assert float(table["preload_sd"].min()) > 0
    steps = [dict(s.detail) for s in session.provenance if s.name == "preload"]
    assert [s["torque"] for s in steps] == [20.0, 50.0]


def test_a_session_without_such_sensors_has_neither(
    measured: Path, tmp_path: Path
) -> None:
    """No attribute and no variable: the layout of a file is what it was."""
    session = read_session(measured)
    plain = tuple(
        replace(
            r, preload_sd=None, hits=tuple(replace(h, temperature=None) for h in r.hits)
        )
        for r in session.recordings
    )
    write_session(replace(session, recordings=plain), tmp_path / "plain.h5")
    again = read_session(tmp_path / "plain.h5")
    assert hit_runs(again) == {}
    assert {h.temperature for r in again.recordings for h in r.hits} == {None}
    described = json.dumps(
        jointbench.hits(jointbench.open(tmp_path / "plain.h5"))
        .to_xarray()
        .to_dict(data=False)
    )
    assert "temperature" not in described


@pytest.mark.parametrize(
    ("table", "newtons"),
    [
        ({"channel": "w", "scale": "20 kN/V"}, 20e3),
        ({"channel": "w", "scale": "2 mV/V", "rated": "100 kN", "supply": "5 V"}, 1e7),
        ({"channel": "w", "scale": "50 um/V", "stiffness": "350 N/um"}, 17.5e3),
    ],
)
def test_a_volt_is_a_force_in_three_ways(table: dict[str, str], newtons: float) -> None:
    """An amplifier, a bridge with its supply, a transducer along the bolt."""
    found = BoltForceTable.model_validate({"bolt": 1, **table}).newtons_per_volt()
    assert found == pytest.approx(newtons)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('scale = "20 kN/V"', 'scale = "20 kN"', "write it as '20 kN/V'"),
        ('channel = "w3"', 'channel = "a1"', "list it in \\[\\[sensors\\]\\]"),
        ("bolt = 3", "bolt = 1", "names a bolt twice"),
        ("bolt = 3", "bolt = 5", "\\[joint\\] has 4"),
        ('stiffness = "350 N/um"', "", "give channel and scale"),
        ('stiffness = "350 N/um"', 'stiffness = "350 N/V"', "350 N/um"),
    ],
)
def test_a_wrong_table_is_refused_with_the_way_out(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """Each by the key that is wrong."""
    path = tmp_path / "plan.toml"
    path.write_text(PLAN.read_text(encoding="utf-8").replace(old, new), "utf-8")
    with pytest.raises(BadData, match=words):
        read_plan(path)


def test_bolts_without_a_sensor_widen_the_uncertainty() -> None:
    """One of one bolt: its own; one of four: half of the scatter of 10 % more."""
    bolt = BoltForce(1, 10e3, 100.0, "load washer")
    assert preload_of([bolt], 1) == (10e3, 100.0)
    preload, sd = preload_of([bolt], 4)
    assert preload == 40e3
    assert sd == pytest.approx(4 * np.hypot(100.0, 1e3 * np.sqrt(0.75)))


def test_an_elongation_that_is_typed_in_is_a_force() -> None:
    """35.2 um at 350 N/um; it counts until the bolts have another torque."""
    table = BoltForceTable(bolt=2, stiffness="350 N/um", sd=0.05)
    forces = BoltForces((table,), CHANNELS, 1)
    assert forces.elongation(3, 1e-6) is None
    found = forces.elongation(2, 35.2e-6)
    assert found is not None
    assert found.force == pytest.approx(12320.0)
    for name in ("first", "second"):
        read = forces.preload(name, 20.0)
        assert read is not None
        assert (read.preload, read.preload_sd) == pytest.approx((12320.0, 616.0))
    forces.loosen()
    assert forces.preload("third", 50.0) is None


def test_the_doctor_names_a_washer_that_is_wired_the_wrong_way_round() -> None:
    """And a temperature that no bench has."""
    table = BoltForceTable(bolt=1, channel="w1", scale="20 kN/V")
    samples = np.array([[0.0] * 8, [-1.0] * 8, [300.0] * 8])
    found = list(bolt_findings((table,), CHANNELS, samples))
    assert [f.health.value for f in found] == ["look", "look"]
    assert "swap the wires" in found[0].remedy
    good = list(bolt_findings((table,), CHANNELS, np.abs(samples) / 12.0))
    assert [f.health.value for f in good] == ["good", "good"]
