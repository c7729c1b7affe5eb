"""The doctor on the simulated chassis: each finding with what to do."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.ni.sensors import Axis, Sensor
from jointbench.acquisition.records.recordings import Quantity
from jointbench.station.doctor.bench_finding import BenchFinding, Health, bad
from jointbench.station.doctor.noise_checks import noise_findings
from jointbench.station.doctor.run_doctor import remedy_lines, run_doctor

EXAMPLES = Path(__file__).parents[3] / "examples"
SENSOR = Sensor(
    "a1",
    Quantity.ACCELERATION,
    "1",
    (Axis("cDAQ1Mod1/ai0", "+z", 0.01),),
    "g",
    500.0,
    noise=0.01,
)


def findings(
    source: str, plan: str | None = "plates.toml", hit: float = 5.0
) -> dict[tuple[str, str], BenchFinding]:
    """Return the findings by step and channel, one second of noise."""
    file = None if plan is None else EXAMPLES / plan
    found = run_doctor(
        file, source=source, noise_time=1.0, hit_time=hit, json_target=None
    )
    assert all(bool(f.remedy) == (f.health is not Health.GOOD) for f in found)
    return {(f.step, f.what): f for f in found}


def test_a_good_bench_is_found_good_from_driver_to_hit() -> None:
    """Driver, device, four sensors with their TEDS, noise, and a hit they all saw."""
    found = findings("sim:plates?seed=1")
    assert {f.health for f in found.values()} == {Health.GOOD}
    assert {step for step, _ in found} == {
        *("driver", "devices", "sensors", "noise", "hit")
    }
    assert "as in the plan" in found["sensors", "a1"].seen


def test_a_hit_is_asked_of_no_washer_and_no_thermometer() -> None:
    """They are slow, and a hit leaves them where they are."""
    source = "sim:plates?seed=1&modules=2&washers=2&thermometer=1"
    found = findings(source, "plates-preload.toml")
    assert {f.health for f in found.values()} == {Health.GOOD}
    assert {what for step, what in found if step == "hit"} == {
        *("hammer", "force", "a1", "a2", "a6")
    }


def test_findings_with_one_remedy_share_its_line() -> None:
    """In the order found; a URL keeps one colon."""
    found = [
        bad("noise", "a1", "x", "check"),
        bad("driver", "ni:", "y", "install"),
        bad("noise", "a2", "z", "check"),
    ]
    assert remedy_lines(found) == ["a1, a2: check", "ni: install"]


def test_a_swapped_sensor_an_open_cable_and_a_silent_hammer_are_found() -> None:
    """Each with its channel; the rest stays good."""
    found = findings("sim:plates?faults=wrong_teds@0:2,open@100:1,open@100:0", hit=0.5)
    bad = {key for key, f in found.items() if f.health is Health.BAD}
    assert bad == {
        ("sensors", "a2"),
        ("noise", "a1"),
        ("noise", "force"),
        ("hit", "hammer"),
    }
    assert "the sensor 131232, the plan 41232" in found["sensors", "a2"].seen


def test_a_bench_with_nothing_plugged_in_is_examined_without_a_plan() -> None:
    """All inputs of the first module, as voltages."""
    found = findings("sim:sine", None)
    assert {what for step, what in found if step == "noise"} == {
        *("ai0", "ai1", "ai2", "ai3")
    }
    assert found["devices", "cDAQSim1Mod1"].health is Health.GOOD


def test_a_plan_that_the_module_cannot_do_ends_before_the_stream() -> None:
    """An NI 9215 has no AC coupling."""
    found = findings("sim:sine?module=9215")
    assert "offers DC" in found["sensors", "force"].seen
    assert not any(step == "noise" for step, _ in found)


@pytest.mark.parametrize("source", ["ni:", "ni+grpc://127.0.0.1:9"])
def test_no_driver_and_no_server_are_findings_with_a_remedy(
    source: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """No traceback; the one finding states what to install or check."""
    found = findings(source, None)
    assert "::" not in capsys.readouterr().out
    assert [f.health for f in found.values()] == [Health.BAD]


def test_a_plan_without_a_source_asks_for_one() -> None:
    """In one line."""
    with pytest.raises(UsageError, match="no source"):
        findings("", None)


def test_noise_is_compared_with_the_stated_one_and_hum_is_recognised() -> None:
    """Data sheet 0.01: 0.02 is good, 0.05 is not, and a 50 Hz line is hum."""
    rng = np.random.default_rng(1)
    time = np.arange(20_000) / 10_000.0
    noise = rng.standard_normal((1, time.size))
    hum = 0.1 * np.sin(2 * np.pi * 50.0 * time)
    cases = ((0.02 * noise, "good", ""), (0.05 * noise, "look", "data sheet 0.01"))
    cases += ((0.01 * noise + hum, "look", "50 Hz"), (0.0 * noise, "bad", "quiet"))
    cases += ((0.01 * noise + 499.0, "bad", "end of its range"),)
    for samples, health, words in cases:
        (found,) = noise_findings(samples, (SENSOR,), sample_rate=10_000.0)
        assert found.health == health
        assert words in found.seen
