"""``jointbench machine`` of bodies that were struck alone."""

import json
from pathlib import Path

import numpy as np
import pytest

from jointbench.station.main import app
from jointbench.station.screen.exit_codes import EXIT_BAD_DATA, EXIT_USAGE, exit_code

LINES = np.arange(20.0, 400.0, 0.5)
MASSES, SPRING, RATIO, LINK = (2.0, 3.0), 4e5, 0.01, 8e5
COLUMNS = "frequency.f:Hz,frf.H:m/N,variance.V:(m/N)^2"
MODEL = f"""
band = ["30 Hz", "390 Hz"]
points = ["pair:1", "mass:1"]
draws = 10

[measured.pair]
frfs = ["pair.npz"]
columns = "{COLUMNS}"

[measured.mass]
frfs = ["mass.npz"]
columns = "{COLUMNS}"

[links.between]
between = ["pair:2", "mass:1"]
stiffness = "800 kN/m"
"""


def matrices() -> tuple[np.ndarray, np.ndarray]:
    """Return K and C of two free masses on a spring, light damping."""
    k = SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    reduced = MASSES[0] * MASSES[1] / sum(MASSES)
    return k, 2 * RATIO * np.sqrt(reduced / SPRING) * k


def write(path: Path, k: np.ndarray, c: np.ndarray, m: np.ndarray) -> None:
    """Write receptances with noise of 60 dB below their median."""
    s = 2j * np.pi * LINES[:, None, None]
    clean = np.linalg.inv(s**2 * m + s * c + k)
    sd = 1e-3 * np.median(np.abs(clean))
    random = np.random.default_rng(3)
    noise = random.standard_normal((2, *clean.shape)) * sd / np.sqrt(2)
    seen = np.moveaxis(clean + noise[0] + 1j * noise[1], 0, 2)
    np.savez(path, f=LINES, H=seen, V=np.full(seen.shape, sd**2))


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """Two masses on a spring, and a block of two points that moves as one."""
    k, c = matrices()
    write(tmp_path / "pair.npz", k, c, np.diag(MASSES))
    other = 5e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    write(tmp_path / "mass.npz", other, 1e-5 * other, np.diag([4.0, 1.5]))
    path = tmp_path / "coupled.toml"
    path.write_text(MODEL, encoding="utf-8")
    return path


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *words])
    return exit_code(app, debug=False)


def test_coupled_modes_are_those_of_the_whole(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, model: Path
) -> None:
    """Frequencies and damping of four masses, in intervals; FRFs in the report."""
    target, page = tmp_path / "m.json", tmp_path / "m.html"
    words = ["machine", str(model), "--json", str(target), "--report", str(page)]
    assert run(monkeypatch, *words) == 0
    k, c = np.zeros((4, 4)), np.zeros((4, 4))
    k[:2, :2], c[:2, :2] = matrices()
    other = 5e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    k[2:, 2:], c[2:, 2:] = other, 1e-5 * other
    tie = np.array([0.0, 1.0, -1.0, 0.0])
    k += LINK * np.outer(tie, tie)
    m = np.diag([*MASSES, 4.0, 1.5])
    state = np.block(
        [
            [np.zeros((4, 4)), np.eye(4)],
            [-np.linalg.solve(m, k), -np.linalg.solve(m, c)],
        ]
    )
    pole = np.linalg.eigvals(state)
    pole = pole[pole.imag > 1.0]
    pole = pole[np.argsort(np.abs(pole))]
    found = json.loads(target.read_text(encoding="utf-8"))
    frequency = [one["frequency_hz"] for one in found["modes"]]
    assert frequency == pytest.approx(np.abs(pole) / (2 * np.pi), rel=2e-3)
    for one, exact in zip(found["modes"], pole, strict=True):
        ratio = -exact.real / np.abs(exact)
        assert one["damping_ratio"] == pytest.approx(ratio, rel=0.05)
        off = one["frequency_hz"] - np.abs(exact) / (2 * np.pi)
        assert abs(off) < 3 * one["frequency_sd_hz"] + 1e-3
    assert "frf-1" in page.read_text(encoding="utf-8")
    assert set(found["size_m_per_n"]) >= {"pair:1/pair:1", "pair:1/mass:1"}


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ('"pair:2", "mass', '"pair:7", "mass', EXIT_USAGE, "has the points"),
        ('"mass:1"]\nst', '"block:1"]\nst', EXIT_USAGE, "no body 'block'"),
        (",variance.V:(m/N)^2", "", EXIT_BAD_DATA, "no variance"),
        ('"800 kN/m"', "800", EXIT_BAD_DATA, "with its unit"),
    ],
)
def test_bad_input_is_one_line(
    monkeypatch: pytest.MonkeyPatch,
    model: Path,
    capsys: pytest.CaptureFixture[str],
    old: str,
    new: str,
    code: int,
    words: str,
) -> None:
    """A point, a body, the noise, a unit."""
    assert old in MODEL
    model.write_text(MODEL.replace(old, new), encoding="utf-8")
    assert run(monkeypatch, "machine", str(model)) == code
    assert words in capsys.readouterr().err
