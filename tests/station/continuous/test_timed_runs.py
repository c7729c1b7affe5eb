"""Timed runs on the simulated chassis, recorded and identified by the commands."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigvals

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.session_file.store import read_session
from jointbench.simulators.machines.machine_design import MachineDesign
from jointbench.station.bench_view.watch_session import run_watch
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.continuous.channel_checks import ChannelChecks
from jointbench.station.continuous.record_plan import read_record_plan
from jointbench.station.main import app, exit_code

EXAMPLES = Path(__file__).parents[3] / "examples"


def truth() -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and damping ratios from the matrices of the machine."""
    mass, damping, stiffness = MachineDesign().matrices()
    zero, one = np.zeros_like(mass), np.eye(len(mass))
    roots = eigvals(
        np.block([[zero, one], [-stiffness, -damping]]),
        np.block([[one, zero], [zero, mass]]),
    )
    roots = roots[roots.imag > 0]
    roots = roots[np.argsort(np.abs(roots))]
    return np.abs(roots) / (2 * np.pi), -roots.real / np.abs(roots)


def plan_file(folder: Path, name: str, **changes: str) -> Path:
    """Return an example's plan, changed."""
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    for old, new in changes.items():
        text = text.replace({"duration": 'duration = "120 s"'}.get(old, old), new)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def command(*words: object) -> int:
    """Run a command in this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["jointbench", *(str(word) for word in words)])
        return exit_code(app, debug=False)


def test_an_operating_run_is_recorded_and_identified(tmp_path: Path) -> None:
    """Thirty seconds; all four modes within 4 of their standard deviations."""
    plan = plan_file(tmp_path, "operating.toml", duration='duration = "30 s"')
    out, found = tmp_path / "s.h5", tmp_path / "m.json"
    assert command("record", plan, "--out", out, "--json", tmp_path / "r.json") == 0
    words = ("--output-only", "--band", "20:450", "--json", found)
    assert command("modal", out, *words) == 0
    modes = [m for m in json.loads(found.read_text())["modes"] if not m["sine_like"]]
    frequency, _ = truth()
    assert len(modes) == 4
    for mode, true in zip(modes, frequency, strict=True):
        assert abs(mode["frequency_hz"] - true) < 4 * mode["frequency_sd_hz"]
        assert mode["frequency_hz"] == pytest.approx(true, rel=5e-3)
    summary = json.loads((tmp_path / "r.json").read_text())
    assert summary["lost_samples"] == 0
    assert summary["runs"] == ["3000 rpm"]


def test_a_shaker_run_is_recorded_and_identified(tmp_path: Path) -> None:
    """Forty seconds of random force; frequency to 1e-5, damping to 0.1 %."""
    plan = plan_file(tmp_path, "shaker.toml", duration='duration = "40 s"')
    out, found = tmp_path / "s.h5", tmp_path / "m.json"
    source = ("--source", "sim:shaker?seed=3")
    assert command("record", plan, "--out", out, *source) == 0
    assert command("modal", out, "--band", "20:450", "--json", found) == 0
    modes = json.loads(found.read_text())["modes"]
    frequency, damping = truth()
    assert [m["frequency_hz"] for m in modes] == pytest.approx(frequency, rel=1e-5)
    assert [m["damping_ratio"] for m in modes] == pytest.approx(damping, rel=1e-3)


def test_any_sensor_is_recorded_in_its_unit_and_the_session_is_whole(
    tmp_path: Path,
) -> None:
    """Two runs of two seconds: pascal, pulses, degrees, with the purpose of each."""
    two = 'duration = "2 s"\n[[runs]]\nname = "quiet"\nduration = "1 s"'
    plan = plan_file(tmp_path, "operating.toml", duration=two)
    out = tmp_path / "s.h5"
    assert command("record", plan, "--out", out) == 0
    first, second = read_session(out).recordings
    assert (first.name, second.name) == ("3000 rpm", "quiet")
    assert dict(first.provenance[0].detail)["purpose"] == "operating"
    assert first.samples.shape[1] == 4096
    air = first.samples[first.row(Quantity.TEMPERATURE)]
    assert air.mean() == pytest.approx(21.0, abs=0.5)
    tacho = first.samples[first.row(Quantity.TACHO)]
    assert np.sum(np.diff((tacho > 2.0).astype(int)) == 1) == pytest.approx(100, abs=1)
    assert 0.05 < first.samples[first.row(Quantity.PRESSURE)].std() < 5.0
    assert run_verify(out, json_target=None)
    state = run_watch(out, once=True, json_target=None)
    assert list(state.finished) == ["3000 rpm", "quiet"]


def test_velocity_displacement_and_strain_come_as_voltages(tmp_path: Path) -> None:
    """A vibrometer, a gap sensor and a gauge; a sensitivity each."""
    text = (EXAMPLES / "operating.toml").read_text(encoding="utf-8")
    rows = (
        ("v", "velocity", "Mod3/ai0", "100 mV/(mm/s)", "40 mm/s"),
        ("x", "displacement", "Mod3/ai1", "10 mV/um", "400 um"),
        ("e", "strain", "Mod3/ai2", "10 mV/(um/m)", "400 um/m"),
    )
    for name, quantity, at, sensitivity, full in rows:
        point = 'point = "4"\n' if quantity in {"velocity", "displacement"} else ""
        text += (
            f'\n[[sensors]]\nname = "{name}"\nquantity = "{quantity}"\n{point}'
            f'physical = "cDAQSim1{at}"\nsensitivity = "{sensitivity}"\n'
            f'range = "{full}"\n'
        )
    plan = tmp_path / "p.toml"
    plan.write_text(text.replace('"120 s"', '"4 s"'), encoding="utf-8")
    out = tmp_path / "s.h5"
    assert command("record", plan, "--out", out) == 0
    (run,) = read_session(out).recordings
    speed = run.samples[run.row(Quantity.VELOCITY)]
    push = run.samples[3]
    assert np.gradient(speed, 1 / 2048).std() == pytest.approx(push.std(), rel=0.3)
    assert 1e-8 < run.samples[run.row(Quantity.DISPLACEMENT)].std() < 1e-4
    assert 1e-8 < run.samples[run.row(Quantity.STRAIN)].std() < 1e-4


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "operating"', 'kind = "shaker"', "has 0 force channels"),
        ('kind = "operating"', 'kind = "party"', "kind"),
        ('quantity = "tacho"', 'quantity = "noise"', "quantity"),
        ('"50 mV/Pa"', '"50 mV/g"', "pressure"),
        ('name = "tacho"', 'name = "air"', "used twice"),
    ],
)
def test_a_plan_that_cannot_be_recorded_is_refused(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """In one line, with the key."""
    text = (EXAMPLES / "operating.toml").read_text(encoding="utf-8")
    path = tmp_path / "p.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(BadData, match=words):
        read_record_plan(path)


def test_channels_that_are_full_or_dead_are_named_once() -> None:
    """Full is 98 % of the range; dead is a millionth of it."""
    channels = read_record_plan(EXAMPLES / "shaker.toml").sensors
    from jointbench.acquisition.ni.sensors import table_channels

    checks = ChannelChecks(table_channels(channels)[:2])
    block = np.array([np.linspace(-399, 399, 50), np.full(50, 0.2)])
    first, again = list(checks.feed(block)), list(checks.feed(block))
    assert len(first) == 1
    assert "'force' is overloaded" in first[0]
    assert again == []
    (dead,) = checks.dead()
    assert "'bed' stands still" in dead


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('range = "45 g"', 'range = "-45 g"', "range '-45 g' of sensor 'bed' must be"),
        ('duration = "120 s"', "", r"'runs\.0\.duration' is missing; add it$"),
        ('"120 s"', '"1 ms"', r"run '3000 rpm' lasts 0\.001 s, less than a block of 0"),
        ('"50 mV/Pa"', '"50 mV/g"', "sensor 'microphone', sensitivity: "),
        ('"120 s"', '"0 s"', r"value '0 s': Input should be greater than 0$"),
    ],
)
def test_a_wrong_value_is_one_mistake(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """The key is named, no table is printed, and nothing else is counted."""
    path = plan_file(tmp_path, "operating.toml", **{old: new})
    with pytest.raises(BadData, match=words):
        read_record_plan(path)


def test_a_folder_to_record_is_said_to_be_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """And not a source with an unknown scheme."""
    assert command("record", tmp_path, "--out", tmp_path / "s.h5") == 2
    words = " ".join(capsys.readouterr().err.split())
    assert "is a folder; 'record' takes a plan whose name ends in '.toml'" in words
