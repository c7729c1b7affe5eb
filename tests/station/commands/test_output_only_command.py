# SPDX-License-Identifier: MIT
"""``jointbench modal --output-only`` as a user types it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from package_commands import run
from scipy.signal import lfilter

RATE = 1000.0


class Ended(NamedTuple):
    """What a command left: its exit code and what it wrote."""

    returncode: int
    stdout: str
    stderr: str


Command = Callable[..., Ended]


@pytest.fixture
def jointbench(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Command:
    """Run the command line in this process, which has imported it already."""

    def command(*words: object) -> Ended:
        capsys.readouterr()
        return Ended(run(monkeypatch, *words), *capsys.readouterr())

    return command


def shaken(path: Path, seconds: float, sine: float = 0.0) -> Path:
    """Write the response of one mode at 90 Hz, 1 %, to unmeasured noise.

    A sine of a spindle at 137 Hz has the given share of its standard deviation.
    """
    noise = np.random.default_rng(0).normal(size=round(seconds * RATE))
    pole = np.exp(2 * np.pi * 90.0 * (-0.01 + 1j * np.sqrt(1 - 1e-4)) / RATE)
    response = lfilter([1.0, -1.0], [1.0, -2 * pole.real, abs(pole) ** 2], noise)
    time = np.arange(noise.size) / RATE
    response += sine * response.std() * np.sin(2 * np.pi * 137.0 * time)
    np.save(path, np.stack([time, response]))
    return path


def test_modes_come_without_a_force_channel(
    tmp_path: Path, jointbench: Command
) -> None:
    """The frequency within 0.2 %, and its uncertainty beside it."""
    path = shaken(tmp_path / "run.npy", 60.0)
    done = jointbench(
        "modal", path, "--output-only", "--columns", "time:s,acceleration:m/s^2",
        "--json", "-",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    (mode,) = found["modes"]
    assert found["output_only"] is True
    assert abs(mode["frequency_hz"] / 90.0 - 1.0) < 2e-3
    assert abs(mode["damping_ratio"] - 0.01) < 3.0 * mode["damping_ratio_sd"]
    assert "Operational modes" in done.stderr


def test_sines_are_taken_out_unless_they_are_to_be_kept(
    tmp_path: Path, jointbench: Command
) -> None:
    """Kept, a sine is found as a mode that is marked; it is left out of the list else.

    Without --output-only there is nothing to keep.
    """
    path = shaken(tmp_path / "run.npy", 60.0, sine=0.5)
    for more, sines in (((), [137.0]), (("--keep-sines",), [])):
        done = jointbench(
            "modal", path, "--output-only", "--columns", "time:s,acceleration:m/s^2",
            "--json", "-", *more,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        found = json.loads(done.stdout)
        assert np.allclose(found["sines_hz"], sines, atol=0.01)
        marked = [one["frequency_hz"] for one in found["modes"] if one["sine_like"]]
        assert np.allclose(marked, [137.0] if more else [], atol=0.05)
    done = jointbench("modal", path, "--keep-sines", "--columns", "frf:m/N")
    assert done.returncode == 2
    assert "add --output-only" in done.stderr


def test_a_short_run_is_refused_in_one_line(
    tmp_path: Path, jointbench: Command
) -> None:
    """With the time it would take."""
    path = shaken(tmp_path / "run.npy", 3.0)
    columns = "time:s,acceleration:m/s^2"
    done = jointbench("modal", path, "--output-only", "--columns", columns)
    assert done.returncode == 3
    assert "record longer" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
