"""Records at several levels: a TOML file, files beside it, and the verdict on them."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import JointbenchError, SamplingError
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.gap.level_files import names_levels, read_levels

RATE, SAMPLES = 200.0, 1024
MODEL = """
[base]
band = ["5 Hz", "40 Hz"]
modes = 1
beyond = false

[records]
columns = "time:s,force.F@mass:N,displacement.y@mass:m"

[ports.foot]
between = ["ground", "y"]

[[levels]]
name = "soft"
files = ["soft.csv"]

[[levels]]
name = "hard"
files = ["hard.csv"]

[[levels]]
name = "hard"
files = ["other.csv"]
held_out = true
"""


def linear_record(level: float, seed: int) -> FloatArray:
    """Return time, force and displacement of 2 kg on 2e4 N/m, 6 N s/m, from rest."""
    rng = np.random.default_rng(seed)
    n = np.arange(SAMPLES)
    force = rng.standard_normal(SAMPLES)
    lines = np.fft.rfftfreq(SAMPLES, 1 / RATE)
    force = np.fft.irfft(np.fft.rfft(force) * (lines < 45.0), SAMPLES)
    ramp = np.sin(0.5 * np.pi * np.minimum(1, np.minimum(n, n[::-1]) / 100))
    force *= level * ramp**2
    s = 4.0 + 2j * np.pi * np.fft.rfftfreq(2 * SAMPLES, 1 / RATE)
    grow = np.exp(4.0 * n / RATE)
    spectrum = np.fft.rfft(force / grow, 2 * SAMPLES) / (2 * s * s + 6 * s + 2e4)
    motion = np.fft.irfft(spectrum)[:SAMPLES] * grow
    motion += 1e-7 * rng.standard_normal(SAMPLES)
    return np.stack([n / RATE, force, motion])


def written(folder: Path, model: str = MODEL) -> Path:
    """Write a model and its records, and return the path of the model."""
    for name, level, seed in (("soft", 1, 1), ("hard", 8, 2), ("other", 8, 3)):
        rows = linear_record(level, seed).T
        np.savetxt(folder / f"{name}.csv", rows, "%.12g", ",", header="t,F,y")
    path = folder / "bench.toml"
    path.write_text(model, encoding="utf-8")
    return path


def test_levels_sensors_inputs_and_ports_are_read(tmp_path: Path) -> None:
    """A force at the point of a sensor acts where that sensor is."""
    path = written(tmp_path)
    assert names_levels(path)
    given, wanted = read_levels(path)
    assert (given.sensors, given.inputs) == (("y",), ("y",))
    assert [r.level for r in given.training] == ["soft", "hard"]
    assert given.records[2].held_out
    assert given.lowest[0].name == "soft"
    assert (wanted.band, wanted.modes) == ((5.0, 40.0), 1)


def test_a_linear_structure_lacks_nothing_at_any_level(tmp_path: Path) -> None:
    """The modes of the lowest level explain the others, and a record held out."""
    done = examine([str(written(tmp_path))], GapRequest(), progress=lambda line: None)
    assert done.found.verdict.value == "none"
    (score,) = done.scores
    assert score.before < 2e-3 * score.rms
    assert any("base of the lowest level (soft)" in line for line in done.remarks)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('["5 Hz", "40 Hz"]', '["40 Hz", "5 Hz"]', "lower frequency first"),
        ("held_out = true", "held = true", "held_out"),
        (
            'files = ["hard.csv"]',
            'files = ["hard.csv"]\nheld_out = true',
            "two or more",
        ),
        ('"ground", "y"', '"ground", "z"', "'foot'.*sensors"),
        (
            "force.F@mass:N,displacement.y",
            "displacement.F@mass:m,displacement.y",
            "force",
        ),
    ],
)
def test_a_fault_is_one_line_with_the_way_out(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """Of the band, a key, the levels, a port and the columns."""
    path = written(tmp_path, MODEL.replace(old, new, 1))
    with pytest.raises(JointbenchError, match=words) as fault:
        read_levels(path)
    assert "\n" not in str(fault.value)


def test_files_of_another_rate_are_refused(tmp_path: Path) -> None:
    """Both files and both rates are named."""
    path = written(tmp_path)
    rows = linear_record(8, 2)
    rows[0] *= 2.0
    np.savetxt(tmp_path / "hard.csv", rows.T, "%.12g", ",", header="t,F,y")
    with pytest.raises(SamplingError, match="'hard' is sampled at 100 Hz"):
        read_levels(path)
