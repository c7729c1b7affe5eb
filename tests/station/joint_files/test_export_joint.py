"""``jointbench export-joint`` from the command line."""

import json
from pathlib import Path

import pytest
from marble_block import marble_block

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.main import app
from jointbench.station.screen.exit_codes import (
    EXIT_BAD_DATA,
    EXIT_USAGE,
    exit_code,
)

BLOCKS = marble_block("""
[sensors.a1]
body = "block"
position = ["200 mm", "100 mm", "50 mm"]
direction = [0, 0, 1]
mass = "10 g"

[identify]
known = { "bed.tangential_2" = "40 MN/m" }
sought = ["bed.normal", "bed.tangential_1"]
""")


def one(value: float, unit: str = "N/m") -> dict[str, object]:
    """A parameter as identify writes it."""
    ends = [0.9 * value, None]
    return {
        "value": value,
        "sd": 0.05 * value,
        "interval_95": ends,
        "unit": unit,
        "identifiable": True,
    }


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """A model and the parameters of two states."""
    model, values = tmp_path / "block.toml", tmp_path / "joint.json"
    model.write_text(BLOCKS, encoding="utf-8")
    found = {
        "low:bed.normal_stiffness": one(3e8),
        "high:bed.normal_stiffness": one(5e8),
        "bed.tangential_1_stiffness": one(1e8),
        "low:bed.normal_damping": one(2e3, "N s/m"),
        "block.modulus": one(0.98, ""),
        "a1.mass": one(1.2, ""),
    }
    values.write_text(json.dumps({"parameters": found}), encoding="utf-8")
    return model, values


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", "export-joint", *map(str, words)])
    return exit_code(app, debug=False)


def test_a_joint_goes_to_all_programs_with_its_uncertainty_and_a_drawing(
    monkeypatch: pytest.MonkeyPatch, files: tuple[Path, Path], tmp_path: Path
) -> None:
    """Values, intervals and what is known stand above every file; axes are drawn."""
    out = tmp_path / "joint"
    code = run(monkeypatch, *files, "--out", out, "--state", "low", "--pieces", "2,1")
    assert code == 0
    names = {path.name for path in out.iterdir()}
    assert names == {
        "bed-values.csv",
        "bed-pieces.csv",
        "bed-ansys-matrix27.inp",
        "bed-ansys-combin14.inp",
        "bed-abaqus.inp",
        "bed-abaqus-nodes.inp",
        "bed-nastran.bdf",
        "bed-nastran-nodes.bdf",
        "bed-calculix-nodes.inp",
        "calculix-model.inp",
        "bed.html",
    }
    head = (out / "bed-nastran.bdf").read_text(encoding="utf-8")
    assert "low:bed.normal_stiffness = 3e+08 +- 1.5e+07 N/m, 95 %: 2.7e+08" in head
    assert "bed.tangential_2_stiffness = 4e+07 N/m" in head
    assert "known, not identified" in head
    page = (out / "bed.html").read_text(encoding="utf-8")
    assert page.count('class="solid"') == 1
    assert page.count(">t2</text>") == 2


def test_a_script_writes_what_the_command_writes(
    monkeypatch: pytest.MonkeyPatch, files: tuple[Path, Path], tmp_path: Path
) -> None:
    """The same files; the pieces as records, the drawing last."""
    words = ("--state", "low", "--to", "table,nastran", "--pieces", "2,1")
    assert run(monkeypatch, *files, "--out", tmp_path / "command", *words) == 0
    out = tmp_path / "script"
    done = jb.export_joint(
        *files, out, state="low", to=["table", "nastran"], pieces=(2, 1)
    )
    assert done.faithful
    assert [path.parent for path in done.files] == [out] * 5
    for path in done.files[:-1]:
        assert path.read_bytes() == (tmp_path / "command" / path.name).read_bytes()
    assert sum(one.stiffness[0, 0] for one in done.pieces) == pytest.approx(3e8)
    assert "bed-nastran.bdf" in str(done)
    with pytest.raises(UsageError, match="no program 'adina'"):
        jb.export_joint(*files, out, to=["adina"])
    with pytest.raises(UsageError, match="give a list"):
        jb.export_joint(*files, out, to="table")


def test_a_law_of_gap_joins_the_files(
    monkeypatch: pytest.MonkeyPatch, files: tuple[Path, Path], tmp_path: Path
) -> None:
    """Its parameters with their deviations, and the sliders."""
    law, out = tmp_path / "gap.json", tmp_path / "joint"
    kt = {"value": 3e7, "sd": 2e6, "unit": "N/m"}
    force = {"value": 60.0, "sd": 4.0, "unit": "N"}
    effect = {"name": "jenkins", "site": "bed", "parameters": {"kt": kt, "Fs": force}}
    law.write_text(json.dumps({"effects": [effect]}), encoding="utf-8")
    words = ("--state", "high", "--to", "table,ansys")
    code = run(monkeypatch, *files, "--out", out, *words, "--law", law)
    assert code == 0
    table = (out / "bed-law.csv").read_text(encoding="utf-8")
    assert table.splitlines()[1] == "1,30000000,60"
    head = (out / "bed-ansys-combin14.inp").read_text(encoding="utf-8")
    assert "jenkins at bed: kt = 3e+07 +- 2e+06 N/m" in head


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ((), EXIT_USAGE, "the file holds the states ['low', 'high']; choose one"),
        (("--state", "mid"), EXIT_USAGE, "no state 'mid'"),
        (("--state", "low", "--to", "adina"), EXIT_USAGE, "no program 'adina'"),
        (("--state", "low", "--pieces", "4"), EXIT_USAGE, "as 4,3"),
        (("--state", "low", "--joint", "b"), EXIT_USAGE, "no joint 'b'"),
        (("--state", "low", "--law", "x.json"), EXIT_USAGE, "no file 'x.json'"),
    ],
)
def test_a_wrong_request_is_said_with_what_there_is(
    monkeypatch: pytest.MonkeyPatch,
    files: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: int,
    said: str,
) -> None:
    """One line, and the exit code of a usage error."""
    assert run(monkeypatch, *files, "--out", tmp_path / "joint", *words) == code
    assert said in " ".join(capsys.readouterr().err.split())


def test_parameters_of_another_model_are_refused(
    monkeypatch: pytest.MonkeyPatch,
    files: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A direction that is neither in the file nor known; a file that is no JSON."""
    model, values = files
    values.write_text('{"parameters": {}}', encoding="utf-8")
    out = tmp_path / "joint"
    assert run(monkeypatch, model, values, "--out", out) == EXIT_BAD_DATA
    assert "holds no bed.normal_stiffness" in capsys.readouterr().err
    values.write_text("[1]", encoding="utf-8")
    assert run(monkeypatch, model, values, "--out", out) == EXIT_BAD_DATA
    assert "no table of identified parameters" in capsys.readouterr().err
    values.write_text("{}", encoding="utf-8")
    assert run(monkeypatch, model, values, "--out", out) == EXIT_BAD_DATA
    assert "no key 'parameters'; give the file that" in capsys.readouterr().err
