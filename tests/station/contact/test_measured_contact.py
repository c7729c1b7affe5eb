"""``jointbench contact`` on measured surfaces: table, JSON, page, refusals, recipes."""

import json
from pathlib import Path

import numpy as np
import pytest

from jointbench.station.main import app, exit_code

JOINT = ["contact", "--modulus=115 GPa", "--hardness=60 GPa", "--columns=x:um,z:um"]
AREA = "--nominal-area=0.01"


@pytest.fixture(scope="module")
def ground(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two profiles of 800 points of correlated heights, in one folder."""
    folder = tmp_path_factory.mktemp("faces")
    random = np.random.default_rng(8)
    kernel = np.exp(-0.5 * (np.arange(-40, 41) / 9) ** 2)
    for name in ("a", "b"):
        z = np.convolve(random.standard_normal(880), kernel, mode="valid")[:800]
        rows = zip(np.arange(800) * 1.0, 0.1 * z, strict=True)
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
    """Without D and G there are laws of the spectrum, a verdict and a picture."""
    target, page = tmp_path / "contact.json", tmp_path / "contact.html"
    files = [f"--surface={ground / name}.csv" for name in "ab"]
    code = run(monkeypatch, *files, AREA, "--load=25 kN", f"--json={target}",
               f"--plot={page}", "--modulus-sd=3 %")  # fmt: skip
    assert code == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "all laws lie within a factor" in said
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["models"] == []
    measured = found["measured"]
    assert measured["reference_area_m2"] == 0.01
    laws = {one["name"]: one for one in measured["laws"]}
    assert {"persson", "greenwood_williamson", "bush_gibson_thomas"} <= set(laws)
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
