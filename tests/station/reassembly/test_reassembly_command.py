"""``jointbench reassembly`` from the command line and from Python."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import jointbench as jb
from jointbench.station.main import app
from jointbench.station.screen.exit_codes import (
    EXIT_QUALITY,
    EXIT_USAGE,
    exit_code,
)

EXAMPLE = Path(__file__).parents[3] / "examples" / "joint-stiffness.toml"
JOINT = """
table = "states.csv"

[joint]
bolts = 4
diameter = "10 mm"
area = "100 cm^2"
torque_scatter = "3 %"
reassembly = "10 %"

[bodies]
modulus = "200 GPa"
poisson = 0.3

[law]
family = "power"
stiffness = "1e8 N/m"
exponent = 0.7
preload = "10 kN"
"""
USUAL = (1.0, 1.05, 0.94, 1.08, 0.97)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Run the command line and return its exit code."""

    def called(*words: object) -> int:
        argv = ["jointbench", "reassembly", *map(str, words)]
        monkeypatch.setattr("sys.argv", argv)
        return exit_code(app, debug=False)

    return called


def written(folder: Path, factors: tuple[float, ...]) -> Path:
    """Write a joint k = factor 1e8 (T/10)^0.7 in as many assemblies as factors."""
    lines = ["torque:N m,branch,assembly,kn:N/m,kn_sd:%"]
    for k, factor in enumerate(factors, start=1):
        for torque in (10.0, 20.0, 40.0):
            stiffness = factor * 1e8 * (torque / 10.0) ** 0.7
            lines.append(f"{torque},rising,{k},{stiffness:.6e},2")
    (folder / "states.csv").write_text("\n".join(lines) + "\n")
    path = folder / "joint.toml"
    path.write_text(JOINT)
    return path


def test_a_joint_as_before_ends_well_and_states_the_range_of_the_next(
    run: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, USUAL)
    code = run(path, "--level", "30 N m", "--json", "-")
    said = json.loads(capsys.readouterr().out)
    (low,), (high,) = (
        said["quantities"]["kn"]["next_assembly"][key] for key in ("low_95", "high_95")
    )
    assert code == 0
    assert said["verdict"] == "within its scatter"
    assert low < 1e8 * 3.0**0.7 < high < 1.5 * low


def test_a_joint_that_lost_its_stiffness_ends_with_the_code_of_a_failed_criterion(
    run: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, (*USUAL, 0.45))
    code = run(path, "--report", tmp_path / "a.html")
    assert code == EXIT_QUALITY
    assert "the joint has changed: kn is 0.45 times that expected" in (
        " ".join(capsys.readouterr().out.split())
    )
    assert "the joint has changed" in (tmp_path / "a.html").read_text()


def test_a_level_of_another_quantity_is_refused(
    run: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(EXAMPLE, "--level", "3 kN") == EXIT_USAGE
    assert "a unit of force, not of torque" in capsys.readouterr().err


def test_the_library_gives_what_the_command_writes(
    run: Callable[..., int], tmp_path: Path
) -> None:
    path = written(tmp_path, USUAL)
    assert run(path, "--json", tmp_path / "a.json") == 0
    found = jb.reassembly(path)
    assert not found.changed
    assert found.to_dict() == json.loads((tmp_path / "a.json").read_text())
