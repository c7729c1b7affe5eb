# SPDX-License-Identifier: MIT
"""FRFs written as universal files and read back column by column."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modes import identify_modes
from jointbench.station.files.universal_frf import write_universal, write_universal_frf


def test_an_frf_comes_back_from_its_universal_file(tmp_path: Path) -> None:
    """Two outputs, one input: values to the 12 digits that are written."""
    rng = np.random.default_rng(0)
    frequency = np.linspace(1.0, 9.0, 7)
    values = rng.normal(size=(2, 1, 7)) + 1j * rng.normal(size=(2, 1, 7))
    frf = Frf(frequency, values, FrfKind.ACCELERANCE, outputs=("a@1", "b@2"))
    path = tmp_path / "frf.uff"
    write_universal_frf(path, frf)
    lines = path.read_text(encoding="ascii").splitlines()
    assert max(len(line) for line in lines) <= 80
    edges = [i for i, line in enumerate(lines) if line == "    -1"]
    assert len(edges) == 4
    for number, (first, last) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        assert int(lines[first + 1]) == 58
        assert int(lines[first + 7][41:51]) == number + 1
        assert int(lines[first + 8][:10]) == 6
        assert int(lines[first + 8][10:20]) == 7
        assert int(lines[first + 8][20:30]) == 1
        start, step = (float(lines[first + 8][i : i + 13]) for i in (30, 43))
        assert np.allclose(start + step * np.arange(7), frequency, rtol=1e-5)
        text = "".join(lines[first + 13 : last])
        parts = np.array([float(text[i : i + 20]) for i in range(0, len(text), 20)])
        assert np.allclose(parts[::2] + 1j * parts[1::2], values[number, 0], rtol=1e-10)


@pytest.mark.parametrize(
    "frequency", [np.linspace(1.0, 9.0, 7), np.array([1.0, 2.0, 4.0, 8.0])]
)
def test_another_program_reads_the_frf(tmp_path: Path, frequency: np.ndarray) -> None:
    """Even lines and uneven ones, negative numbers and large exponents."""
    pyuff = pytest.importorskip("pyuff")
    rng = np.random.default_rng(1)
    values = rng.normal(size=frequency.size) * 1e-120 - 1j * frequency
    frf = Frf(frequency, values[None, None], FrfKind.RECEPTANCE)
    path = tmp_path / "frf.uff"
    write_universal_frf(path, frf)
    read = pyuff.UFF(str(path)).read_sets(0)
    assert np.allclose(read["x"], frequency, rtol=1e-5)
    assert np.allclose(read["data"], values, rtol=1e-10)


def test_a_hostile_label_stays_on_its_line(tmp_path: Path) -> None:
    """A line break in a label would end the data set early."""
    frf = Frf(
        np.arange(1.0, 4.0),
        np.ones((1, 1, 3), complex),
        FrfKind.MOBILITY,
        outputs=("a\n    -1\nb@é" + 200 * "x",),
    )
    path = tmp_path / "frf.uff"
    write_universal_frf(path, frf)
    lines = path.read_text(encoding="ascii").splitlines()
    assert lines.count("    -1") == 2
    assert max(len(line) for line in lines) <= 80


def test_mode_shapes_follow_the_frfs_as_data_set_55(tmp_path: Path) -> None:
    """Pole and both complex components of every mode, to the six digits written."""
    frequency = np.linspace(1.0, 400.0, 800)
    pole = 2.0 * np.pi * np.array([100.0, 250.0]) * (1j - 0.01)
    shape = np.array([[1.0, -0.5], [0.4 + 0.1j, 1.0]])
    s = 2j * np.pi * frequency
    columns = 1.0 / (s - pole[:, None])
    mirrored = 1.0 / (s - pole.conj()[:, None])
    response = shape.T @ (columns / 1j) + shape.conj().T @ (mirrored / -1j)
    frf = Frf(frequency, response[:, None], FrfKind.RECEPTANCE)
    model = identify_modes(frf).model
    path = tmp_path / "all.uff"
    write_universal(path, frf, model)
    lines = path.read_text(encoding="ascii").splitlines()
    starts = [i for i, line in enumerate(lines) if line == "    55"]
    assert len(starts) == 2
    for number, start in enumerate(starts):
        assert [int(word) for word in lines[start + 6].split()] == [1, 3, 2, 8, 5, 3]
        assert [int(word) for word in lines[start + 7].split()] == [2, 6, 1, number + 1]
        found = [float(lines[start + 8][i : i + 13]) for i in (0, 13)]
        assert complex(*found) == pytest.approx(pole[number], rel=1e-4)
        for node in (0, 1):
            row = lines[start + 10 + 2 * node]
            value = complex(float(row[52:65]), float(row[65:78]))
            assert value == pytest.approx(model.shapes[number, node], abs=1e-5)
