"""Periodic records given as complex lines, and FRFs of the lowest level."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.analysis.gap.diagnosis.level_diagnosis import diagnose_levels
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.station.gap.level_files import read_levels
from jointbench.station.gap.level_remarks import level_remarks
from jointbench.station.gap.line_files import LineRequest, read_lines

LINES = np.arange(1, 41) * 0.5
MODEL = """
[base]
band = ["1 Hz", "20 Hz"]

[records]
lines = "force.F@mass:N,displacement.y@mass:mm"
rate = "64 Hz"
repeatability = "0.1 %"

[ports.foot]
between = ["ground", "y"]

[[levels]]
name = "soft"
files = ["soft.csv"]
frf_force = "2 N"

[[levels]]
name = "hard"
files = ["hard.csv"]
"""


def receptance(frequency: FloatArray) -> ComplexArray:
    """Return y/F of 2 kg on 8e3 N/m and 6 N s/m [mm/N]."""
    s = 2j * np.pi * frequency
    return np.asarray(1e3 / (2 * s * s + 6 * s + 8e3))


def table(*rows: ComplexArray) -> FloatArray:
    """Return the frequency, then real and imaginary part of each row, in columns."""
    parts = [part for row in rows for part in (row.real, row.imag)]
    return np.stack([LINES, *parts], axis=1)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A model with an FRF at 2 N and periodic lines of 7.07 N beside it."""
    rng = np.random.default_rng(1)
    force = 10.0 / np.sqrt(40) * np.exp(2j * np.pi * rng.random(40))
    np.savetxt(tmp_path / "soft.csv", table(receptance(LINES)), "%.9g", ",")
    hard = table(force, receptance(LINES) * force)
    np.savetxt(tmp_path / "hard.csv", hard, "%.9g", ",")
    model = tmp_path / "bench.toml"
    model.write_text(MODEL, encoding="utf-8")
    return model


def test_lines_become_a_period_whose_transform_they_are(path: Path) -> None:
    """An amplitude of a line is that of its cosine, in SI units."""
    lines = LineRequest("force.F:N,displacement.y:mm", 64.0)
    record = read_lines(path.parent / "hard.csv", lines)
    assert record.samples.shape == (2, 128)
    columns = np.loadtxt(path.parent / "hard.csv", delimiter=",").T
    spectrum = np.fft.rfft(np.asarray(record.samples), axis=1)[:, 1:41] / 64
    assert np.allclose(spectrum[0], columns[1] + 1j * columns[2])
    assert np.allclose(spectrum[1], 1e-3 * (columns[3] + 1j * columns[4]))


CUBIC, PERIOD = 6e7, 512
"""Spring to the ground [N/m^3]; samples of a period."""


def periodic(level: float, seed: int) -> tuple[ComplexArray, ComplexArray]:
    """Return the lines of force [N] and motion [mm] of a mass on a cubic spring.

    The steady state is the fixed point of the linear response to the force less that of
    the spring, in the frequency domain: no integration in time.
    """
    force = np.zeros(PERIOD // 2 + 1, complex)
    phase = np.random.default_rng(seed).random(LINES.size)
    force[1 : 1 + LINES.size] = level * np.sqrt(2 / LINES.size) * np.exp(6.3j * phase)
    s = 2j * np.pi * LINES[0] * np.arange(force.size)
    flexible, x = 1.0 / (2 * s * s + 40 * s + 8e3), np.zeros(PERIOD)
    for _ in range(100):
        spring = np.fft.rfft(CUBIC * x**3) * 2 / PERIOD
        x = 0.5 * x + np.fft.irfft(0.25 * PERIOD * flexible * (force - spring), PERIOD)
    return force, 1e3 * np.fft.rfft(x) * 2 / PERIOD


def test_a_cubic_spring_is_named_from_an_frf_and_two_levels_of_lines(
    path: Path,
) -> None:
    """The FRF serves the base alone; the harmonics are in the lines."""
    count = 3 * LINES.size
    rows = np.arange(1, count + 1) * LINES[0]
    text = MODEL.replace("64 Hz", "160 Hz").replace("[base]", "[base]\nmodes = 1")
    text = text.replace("2 N", "1 N")
    text += '[[levels]]\nname = "harder"\nfiles = ["harder.csv"]\n'
    path.write_text(text, encoding="utf-8")
    for name, level in (("soft", 1.0), ("hard", 8.0), ("harder", 18.0)):
        force, motion = periodic(level, int(level))
        own = slice(1, count + 1)
        given = [force[own], motion[own]]
        if name == "soft":
            given = [motion[1:41] / force[1:41]]
        parts = [part for row in given for part in (row.real, row.imag)]
        lines = np.stack([rows[: given[0].size], *parts], axis=1)
        np.savetxt(path.parent / f"{name}.csv", lines, "%.9g", ",")
    levels, wanted = read_levels(path)
    done = diagnose_levels(levels, wanted)
    assert done.found.verdict is Finding.NAMED
    (named,) = done.found.effects
    assert (named.name, named.site) == ("cubic_stiffness", "link:foot")
    assert named.parameters[0].value == pytest.approx(CUBIC, rel=2e-3)
    assert "base alone" in " ".join(level_remarks(levels, done))


def test_an_frf_and_periodic_lines_are_levels_of_one_set(path: Path) -> None:
    """The FRF gets a force of its rms, and both obey the same receptance."""
    given, _ = read_levels(path)
    assert given.inputs == ("y",)
    assert [r.level for r in given.lowest] == ["soft"]
    assert [r.rms for r in given.records] == pytest.approx([2.0, 10 / np.sqrt(2)])
    for record in given.records:
        assert record.period == 128
        force, motion = (
            np.fft.rfft(rows[0, -128:])[1:41]
            for rows in (record.force, record.response)
        )
        assert np.allclose(motion / force, 1e-3 * receptance(LINES), rtol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('repeatability = "0.1 %"', "", "rate and a repeatability"),
        ('rate = "64 Hz"', 'rate = "30 Hz"', "more than 40 Hz"),
        ('rate = "64 Hz"', 'rate = "64.2 Hz"', "multiple of 0.5 Hz"),
        ('frf_force = "2 N"', 'frf_force = "20 N"', "lowest level"),
        ('frf_force = "2 N"', "", "3 columns and 5 are wanted"),
        ('"force.F@mass:N,', '"time:s,force.F@mass:N,', "'time'"),
        ('"hard.csv"]', '"hard.csv"]\nfrf_force = "9 N"', "2 levels are FRFs"),
    ],
)
def test_a_fault_of_lines_is_one_line(
    path: Path, old: str, new: str, words: str
) -> None:
    """Of the rate, the noise, the force of an FRF and the columns."""
    path.write_text(MODEL.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(JointbenchError, match=words) as fault:
        read_levels(path)
    assert "\n" not in str(fault.value)


def test_lines_without_a_period_are_refused(path: Path) -> None:
    """Frequencies that are no multiples of one spacing, or descend."""
    soft = path.parent / "soft.csv"
    rows = np.loadtxt(soft, delimiter=",")
    rows[3, 0] += 0.1
    np.savetxt(soft, rows, "%.9g", ",")
    with pytest.raises(JointbenchError, match="no multiples of"):
        read_levels(path)
    np.savetxt(soft, rows[::-1], "%.9g", ",")
    with pytest.raises(JointbenchError, match="ascend"):
        read_levels(path)
