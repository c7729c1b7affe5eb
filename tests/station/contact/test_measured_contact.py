"""``jointbench contact`` on measured surfaces: table, JSON, page, refusals, recipes."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from jointbench.station.main import app, exit_code

JOINT = ["contact", "--modulus=115 GPa", "--hardness=60 GPa", "--columns=x:um,z:um"]
AREA = "--nominal-area=0.01"


@pytest.fixture(scope="module")
def ground(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two profiles of 400 points, exponential correlation, in one folder."""
    folder = tmp_path_factory.mktemp("faces")
    random = np.random.default_rng(8)
    for name in ("a", "b"):
        z = lfilter([1.0], [1.0, -0.9], random.standard_normal(500))[100:]
        rows = zip(np.arange(400) * 1.0, 0.1 * z, strict=True)
        text = "\n".join(f"{x:.1f},{y:.6f}" for x, y in rows)
        (folder / f"{name}.csv").write_text(text + "\n", encoding="utf-8")
    return folder


def run(monkeypatch: pytest.MonkeyPatch, *options: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *JOINT, *options])
    return exit_code(app, debug=False)


def test_two_measured_surfaces_get_laws_with_intervals(
    monkeypatch: pytest.MonkeyPatch,
    ground: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Laws of the spectrum beside the fractal one, a verdict and a picture."""
    target, page = tmp_path / "contact.json", tmp_path / "contact.html"
    files = [f"--surface={ground / name}.csv" for name in "ab"]
    code = run(monkeypatch, *files, AREA, "--load=25 kN", f"--json={target}",
               f"--plot={page}", "--modulus-sd=3 %")  # fmt: skip
    assert code == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "all laws lie within a factor" in said
    found = json.loads(target.read_text(encoding="utf-8"))
    assert [one["name"] for one in found["models"]] == ["ke_3d_modified"]
    measured = found["measured"]
    assert measured["reference_area_m2"] == 0.01
    laws = {one["name"]: one for one in measured["laws"]}
    assert {"persson", "greenwood_williamson", "bush_gibson_thomas"} <= set(laws)
    assert laws.pop("ke_3d_modified")["real_area"] > 0
    for one in laws.values():
        low, high = one["normal_stiffness_interval"]
        assert low < one["normal_stiffness"] < high
        assert one["applies"] == (not one["reasons"])
    assert "law-curves" in page.read_text(encoding="utf-8")


def test_an_area_is_asked_for_where_there_is_no_scaling_range(
    monkeypatch: pytest.MonkeyPatch, ground: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The refusal of the fractal law names the option that helps."""
    assert run(monkeypatch, f"--surface={ground / 'a.csv'}", "--load=25 kN") == 3
    error = capsys.readouterr().err
    assert "--nominal-area" in error
    assert error.count("\n") == 1


def test_maps_get_pressures_and_profiles_are_refused(
    monkeypatch: pytest.MonkeyPatch,
    ground: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A table, JSON with waviness apart from roughness, and a picture."""
    random = np.random.default_rng(4)
    z = random.standard_normal((24, 24))
    rows = [f"{x},{y},{z[y, x]:.5f}" for y in range(24) for x in range(24)]
    face = tmp_path / "face.csv"
    face.write_text("\n".join(rows) + "\n", encoding="utf-8")
    target, page = tmp_path / "map.json", tmp_path / "map.html"
    given = ["jointbench", "pressure-map", "--modulus=115 GPa", "--hardness=231 HB",
             "--pressure=50 MPa", "--cutoff=10 um"]  # fmt: skip
    maps = [str(face), str(face), "--columns=x:um,y:um,z:um"]
    outputs = [f"--json={target}", f"--plot={page}"]
    monkeypatch.setattr("sys.argv", [*given, *maps, *outputs])
    assert exit_code(app, debug=False) == 0
    found = json.loads(target.read_text(encoding="utf-8"))
    state = found["states"][0]
    assert 0 < state["real_area_share"] < 1
    parts = ("waviness", "roughness")
    total = sum(state[f"{one}_compliance_times_area"] for one in parts)
    assert total == pytest.approx(state["compliance_times_area"])
    assert "pressures-0" in page.read_text(encoding="utf-8")
    capsys.readouterr()
    profile = [str(ground / "a.csv"), "--columns=x:um,z:um"]
    monkeypatch.setattr("sys.argv", [*given, *profile])
    assert exit_code(app, debug=False) == 2
    assert "'jointbench contact' has laws for profiles" in capsys.readouterr().err
