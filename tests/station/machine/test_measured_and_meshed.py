"""A measured body and a meshed one in one machine file."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh

from jointbench.analysis.structures.matrices.structure import pick
from jointbench.station.files.toml_file import read_toml
from jointbench.station.machine.machine_file import MachineModel, machine_of
from jointbench.station.main import app
from jointbench.station.screen.exit_codes import EXIT_USAGE, exit_code

LINES = np.arange(20.0, 500.0, 0.5)
MASSES, SPRING, LINK = np.diag([0.4, 0.3]), 8e5, 5e5
PLACE = (0.3, 0.05, 0.02)
MODEL = """
[materials.steel]
youngs_modulus = "200 GPa"
density = "7850 kg/m^3"
loss_factor = 0.002

[bodies.arm]
box = ["400 mm", "100 mm", "20 mm"]
cells = [4, 1, 1]
material = "steel"

[[supports]]
body = "arm"
face = "x-"

[measured.unit]
frfs = ["unit.npz"]
columns = "frequency.f:Hz,frf.H:m/N,variance.V:(m/N)^2"
band = ["30 Hz", "480 Hz"]

[links.mount]
between = ["unit:2", "arm"]
position = ["300 mm", "50 mm", "20 mm"]
direction = [0, 0, 1]
stiffness = "500 kN/m"
damping = "20 N s/m"

[points.tool]
body = "arm"
position = ["400 mm", "50 mm", "20 mm"]

[analysis]
band = "400 Hz"
modes = 3
lines = 200
samples = 20
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """The file, and noisy FRFs of two masses on a spring that hang freely."""
    k = SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    s = 2j * np.pi * LINES[:, None, None]
    clean = np.linalg.inv(s**2 * MASSES + s * 3e-5 * k + k)
    sd = 1e-3 * np.median(np.abs(clean))
    noise = np.random.default_rng(3).standard_normal((2, *clean.shape)) / np.sqrt(2)
    seen = np.moveaxis(clean + sd * (noise[0] + 1j * noise[1]), 0, 2)
    np.savez(tmp_path / "unit.npz", f=LINES, H=seen, V=np.full(seen.shape, sd**2))
    path = tmp_path / "mixed.toml"
    path.write_text(MODEL, encoding="utf-8")
    return path


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *words])
    return exit_code(app, debug=False)


def whole(model: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return K, C, M and the row of the tool along z of mesh and masses together."""
    machine = machine_of(read_toml(model, MachineModel), model.parent)
    structure = machine.structure
    own = SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    tie = np.concatenate([pick(structure, "arm", PLACE).toarray()[2], [0.0, -1.0]])
    wide = np.zeros((structure.size,) * 2)
    stiffness = block_diag(structure.stiffness.toarray(), own)
    mass = block_diag(structure.mass.toarray(), MASSES)
    damping = block_diag(wide, 3e-5 * own) + 20.0 * np.outer(tie, tie)
    tool = pick(structure, "arm", (0.4, 0.05, 0.02)).toarray()[2]
    row = np.concatenate([tool, [0.0, 0.0]])
    return stiffness + LINK * np.outer(tie, tie), damping, mass, row


def test_a_measured_unit_on_a_meshed_arm(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, model: Path
) -> None:
    """Frequencies and receptance are those of both together; intervals hold them."""
    target = tmp_path / "m.json"
    words = ["machine", str(model), "--json", str(target), "--cache", str(tmp_path)]
    assert run(monkeypatch, *words) == 0
    found = json.loads(target.read_text(encoding="utf-8"))["jointed"]
    k, c, m, row = whole(model)
    value = eigh(k, m, eigvals_only=True, subset_by_index=(0, 2))
    level = np.sqrt(value) / (2 * np.pi)
    modes = found["modes"]
    for one, wanted in zip(modes, level, strict=True):
        assert one["natural_frequency_hz"] == pytest.approx(wanted, rel=2e-3)
        low, high = one["natural_frequency_95_hz"]
        assert low < high
        assert low * (1 - 1e-3) < wanted < high * (1 + 1e-3)
    shares = modes[0]["strain_energy"]
    assert set(shares) == {"arm", "unit", "mount"}
    tool = found["tool"]
    at = int(np.argmin(np.abs(np.array(tool["frequency_hz"]) - 0.5 * level[0])))
    s = 2j * np.pi * tool["frequency_hz"][at]
    exact = abs(row @ np.linalg.solve(k + s * c + s**2 * m, row))
    assert tool["size_m_per_n"]["z"][at] == pytest.approx(exact, rel=3e-3)
    assert tool["largest_relative_bound"] is not None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("unit:2", "unit:7", "no point '7' of measured body 'unit'"),
        ('"unit:2"', '"unit"', "write body:point for the measured body first"),
        ('position = ["300 mm"', '# ["300 mm"', "give its position on body 'arm'"),
    ],
)
def test_links_that_join_nothing(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    model: Path,
    old: str,
    new: str,
    message: str,
) -> None:
    """One line each."""
    model.write_text(MODEL.replace(old, new), encoding="utf-8")
    assert run(monkeypatch, "machine", str(model)) == EXIT_USAGE
    assert message in " ".join(capsys.readouterr().err.split())
