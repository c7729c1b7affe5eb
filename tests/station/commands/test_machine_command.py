"""``jointbench machine`` from the command line."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite

from jointbench.station.main import app
from jointbench.station.screen.exit_codes import EXIT_BAD_DATA, EXIT_USAGE, exit_code

MACHINE = """
[materials.steel]
youngs_modulus = "200 GPa"
density = "7850 kg/m^3"
loss_factor = 0.002

[bodies.bed]
box = ["600 mm", "200 mm", "100 mm"]
cells = [3, 1, 1]
material = "steel"

[bodies.head]
box = ["200 mm", "200 mm", "100 mm"]
origin = ["100 mm", "0 mm", "100 mm"]
cells = [1, 1, 1]
material = "steel"

[[supports]]
body = "bed"
face = "z-"

[joints.foot]
between = ["head", "bed"]
stiffness = ["50 MN/m", "20 MN/m", "20 MN/m"]
damping = ["2 kN s/m", "1 kN s/m", "1 kN s/m"]
stiffness_sd = "20 %"

[rigid.motor]
position = ["200 mm", "100 mm", "250 mm"]
mass = "5 kg"
inertia = ["0.02 kg m^2", "0.02 kg m^2", "0.02 kg m^2"]

[springs.mount]
between = ["motor", "head"]
position = ["200 mm", "100 mm", "200 mm"]
face = ["", "z+"]
stiffness = ["5 MN/m", "5 MN/m", "9 MN/m"]
rotational_stiffness = ["50 kN m/rad", "50 kN m/rad", "50 kN m/rad"]

[points.tool]
body = "head"
position = ["300 mm", "100 mm", "150 mm"]

[[loads]]
at = "tool"
direction = [0, 3, 4]
amplitude = "100 N"
rate = "100 rad/s"

[[loads]]
at = "tool"
direction = [1, 0, 0]
file = "force.csv"

[transient]
duration = "0.2 s"
step = "1 ms"

[chatter]
coefficient = "2 GPa"
chip = [0, 0, 1]
force = [0, 0, 1]
speed = ["1000 rpm", "9000 rpm"]

[analysis]
band = "600 Hz"
modes = 4
lines = 60
samples = 20
"""


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *words])
    return exit_code(app, debug=False)


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A small machine in a folder with the table of its load."""
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE, encoding="utf-8")
    (tmp_path / "force.csv").write_text("# s, N\n0,0\n0.1,50\n", encoding="utf-8")
    return path


def test_a_machine_gives_tables_a_report_json_and_motion(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    model: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The keys of the contract; pictures; the second run reads reduced bodies."""
    page, target, motion = (tmp_path / name for name in ("m.html", "m.json", "m.csv"))
    words = ["machine", str(model), "--report", str(page), "--json", str(target)]
    words += ["--motion", str(motion), "--cache", str(tmp_path / "cache")]
    assert run(monkeypatch, *words) == 0
    screen = capsys.readouterr().out
    assert "Modes with joints" in screen
    content = json.loads(target.read_text(encoding="utf-8"))
    assert set(content) >= {"glued", "jointed", "pairs", "joints"}
    mode = content["jointed"]["modes"][0]
    assert (
        mode["natural_frequency_hz"]
        < (content["glued"]["modes"][0]["natural_frequency_hz"])
    )
    low, high = mode["natural_frequency_95_hz"]
    assert low < mode["natural_frequency_hz"] < high
    assert sum(mode["strain_energy"].values()) == pytest.approx(1.0)
    assert set(content["joints"]) == {"foot", "mount"}
    html = page.read_text(encoding="utf-8")
    parts = ("receptance-z", "lobes", "motion-begin", "energy-jointed")
    for part in ('class="scene"', *parts):
        assert part in html
    with motion.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert len(rows) == 202
    assert rows[0][0] == "time [s]"
    assert len(list((tmp_path / "cache").glob("*.npz"))) == 4
    before = content["jointed"]["modes"]
    assert run(monkeypatch, *words[:6], *words[8:]) == 0
    assert json.loads(target.read_text(encoding="utf-8"))["jointed"]["modes"] == before


FLOATING = MACHINE[: MACHINE.index("[springs.mount]")]
FLOATING += MACHINE[MACHINE.index("[points.tool]") :]
WRONG = {
    "a body that floats": (FLOATING, "'motor' can move in 6 ways"),
    "joints apart": (
        MACHINE.replace('"0 mm", "100 mm"]\ncells', '"0 mm", "150 mm"]\ncells'),
        "'foot' touches nothing",
    ),
    "no unit": (MACHINE.replace('"50 MN/m", "20', '50, "20'), "with its unit"),
    "no tool": (MACHINE.replace("[points.tool]", "[points.nose]"), "must be 'tool'"),
    "spring in the air": (
        MACHINE.replace('face = ["", "z+"]', 'radius = "1 mm"'),
        "0 nodes within 0.001 m",
    ),
    "table of one column": (MACHINE.replace("force.csv", "machine.toml"), "no table"),
}


@pytest.mark.parametrize("case", WRONG)
def test_bad_input_ends_with_one_line(
    monkeypatch: pytest.MonkeyPatch,
    model: Path,
    capsys: pytest.CaptureFixture[str],
    case: str,
) -> None:
    """Exit code 3, the value and the remedy."""
    text, words = WRONG[case]
    model.write_text(text, encoding="utf-8")
    assert run(monkeypatch, "machine", str(model)) == EXIT_BAD_DATA
    line = capsys.readouterr().err
    assert words in line
    assert line.count("\n") == 1


def test_matrices_that_are_not_symmetric_are_refused(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    model: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """K of another program, one entry changed."""
    wrong = np.eye(6)
    wrong[0, 1] = 0.5
    wrong[1, 0] = 0.1
    mmwrite(tmp_path / "k.mtx", wrong)
    text = MACHINE.replace(
        'cells = [1, 1, 1]\nmaterial = "steel"',
        'cells = [1, 1, 1]\nstiffness = "k.mtx"\nmass = "k.mtx"',
    )
    model.write_text(text, encoding="utf-8")
    assert run(monkeypatch, "machine", str(model)) == EXIT_BAD_DATA
    assert "not symmetric" in capsys.readouterr().err


def test_motion_needs_a_transient(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    model: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A usage error."""
    text = MACHINE.replace("[transient]", "[chatter_]").split("[chatter_]")
    rest = text[1][text[1].index("[chatter]") :]
    model.write_text(text[0] + rest, encoding="utf-8")
    words = ["machine", str(model), "--motion", str(tmp_path / "m.csv")]
    assert run(monkeypatch, *words) == EXIT_USAGE
    assert "[transient]" in capsys.readouterr().err
