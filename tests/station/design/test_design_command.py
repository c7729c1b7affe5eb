"""``jointbench design`` from the command line."""

import json
import re
from pathlib import Path

import pytest

from jointbench.station.design import run_design
from jointbench.station.main import app
from jointbench.station.measure.plan import read_plan
from jointbench.station.screen.exit_codes import (
    EXIT_BAD_DATA,
    EXIT_USAGE,
    exit_code,
)

EXAMPLES = Path(__file__).parents[3] / "examples"


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", "design", *map(str, words)])
    return exit_code(app, debug=False)


def test_the_plan_that_is_written_is_taken_by_measure(
    monkeypatch: pytest.MonkeyPatch, model: Path, tmp_path: Path
) -> None:
    """Points of hits and sensors are those chosen; better than 200 random plans."""
    target, plan = tmp_path / "design.json", tmp_path / "plan.toml"
    words = ("--plan", EXAMPLES / "plates.toml", "--out", plan, "--json", target)
    assert run(monkeypatch, model, *words, "--deviation", "5 %") == 0
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["best_random_over_plan"] >= 1.0 - 1e-9
    assert found["evenly_spread_over_plan"] >= 1.0 - 1e-9
    written = read_plan(plan)
    assert list(written.hits.points) == found["hits"]
    own = [one.point for one in written.sensors if one.point]
    assert own == found["sensors"]


def test_the_next_step_of_a_measured_plan(
    monkeypatch: pytest.MonkeyPatch, measured_block: Path, tmp_path: Path
) -> None:
    """Hit points, sensors, one more hit, a mass, and the torques of the plan."""
    target = tmp_path / "next.json"
    words = ("--next", "--mass", "500 g", "--plan", EXAMPLES / "plates.toml")
    assert run(monkeypatch, measured_block, *words, "--json", target) == 0
    found = json.loads(target.read_text(encoding="utf-8"))
    kinds = {one["kind"] for one in found["next"]}
    assert kinds == {"hit point", "sensor", "repeat", "mass", "torque"}
    assert found["next"][0]["width_ratio"] < 0.9
    assert [one["torque"] for one in found["torques"]] == [31.6, 50.0, 63.2, 80.0]


def test_what_a_design_lacks_is_said(
    monkeypatch: pytest.MonkeyPatch,
    model: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """No template for the plan; no expected damping; no points."""
    assert run(monkeypatch, model, "--out", tmp_path / "p.toml") == EXIT_USAGE
    assert "--out needs --plan" in capsys.readouterr().err
    text = model.read_text(encoding="utf-8")
    model.write_text(text.replace('"bed.normal" = "2 kN s/m"\n', ""), encoding="utf-8")
    assert run(monkeypatch, model) == EXIT_BAD_DATA
    assert "design.damping holds no 'bed.normal'" in capsys.readouterr().err
    model.write_text(text.split("[design]")[0], encoding="utf-8")
    assert run(monkeypatch, model) == EXIT_BAD_DATA
    assert "a design needs a table [design]" in " ".join(
        capsys.readouterr().err.split()
    )


def test_counts_of_sensors_are_checked_before_the_meshes(
    monkeypatch: pytest.MonkeyPatch,
    model: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Of two faults, a mesh that is not there and too many sensors, the second."""
    text = model.read_text(encoding="utf-8")
    box = 'box = ["200 mm", "100 mm", "50 mm"]\ncells = [2, 1, 1]'
    text = text.replace(box, 'mesh = "none.msh"\nmesh_unit = "1 mm"')
    model.write_text(text.replace("sensors = 3", "sensors = 99"), encoding="utf-8")
    assert run(monkeypatch, model) == EXIT_USAGE
    assert "99 sensors" in " ".join(capsys.readouterr().err.split())


def test_names_and_band_are_checked_before_the_meshes_are_reduced(
    monkeypatch: pytest.MonkeyPatch,
    model: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A parameter that is not there, and a band between two lines."""

    def reduced(*_: object, **__: object) -> None:
        raise AssertionError("the meshes were reduced")

    monkeypatch.setattr(run_design, "reduce_structure", reduced)
    text = model.read_text(encoding="utf-8")
    wanted = text.replace("[design]\n", '[design]\nwanted = ["bed.moral"]\n')
    model.write_text(wanted, encoding="utf-8")
    assert run(monkeypatch, model) == EXIT_USAGE
    assert "no 'bed.moral'" in " ".join(capsys.readouterr().err.split())
    narrow = re.sub(r"(?m)^band = .*", 'band = ["300.1 Hz", "300.2 Hz"]', text)
    model.write_text(narrow, encoding="utf-8")
    assert run(monkeypatch, model) == EXIT_BAD_DATA
    assert "no line between" in " ".join(capsys.readouterr().err.split())
