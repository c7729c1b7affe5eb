# SPDX-License-Identifier: MIT
"""What ``jointbench modal`` says beside its modes, as a user reads it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import NoModeFound
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.station.commands.import_command import ImportRequest, run_import
from jointbench.station.commands.modal_command import run_modal

RATE = 25600.0
COLUMNS = "time:s,force:N,acceleration:m/s^2"
MODES = np.array([400.0, 480.0, 1500.0])


def files(
    folder: Path,
    *,
    seconds: float = 0.5,
    scale: float = 1.0,
    shift: float = 0.0,
    levels: tuple[float, ...] = (100.0, 100.0, 100.0),
    modes: FloatArray = MODES,
) -> list[Path]:
    """Write one hit a file on modes of 1 %; `shift` of frequency by doubling."""
    found = []
    time = np.arange(int(seconds * RATE)) / RATE
    for number, level in enumerate(levels):
        rng = np.random.default_rng(number)
        pulse = np.where(
            (time > 0.01) & (time < 0.0105), np.sin(np.pi * (time - 0.01) / 0.0005), 0.0
        )
        omega = 2.0 * np.pi * modes[:, None] * (1.0 + shift * np.log2(level / 100.0))
        ring = np.sum(omega * np.exp(-0.01 * omega * time) * np.sin(omega * time), 0)
        size = 2 * time.size
        answer = np.fft.irfft(np.fft.rfft(pulse, size) * np.fft.rfft(ring, size))
        rows = np.array(
            [time * scale, level * pulse, level * answer[: time.size] / RATE]
        )
        rows[1:] += rng.normal(0.0, 0.01, (2, time.size))
        path = folder / f"hit{number}.csv"
        np.savetxt(path, rows.T, delimiter=",")
        found.append(path)
    return found


def modal(paths: list[Path], folder: Path) -> dict[str, Any]:
    """Run the command and return its JSON."""
    run_modal(paths, samples=SampleOptions(COLUMNS), json_target=str(folder / "m.json"))
    content: dict[str, Any] = json.loads((folder / "m.json").read_text())
    return content


def test_good_data_bring_no_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three sure modes, none apart, no level that disagrees."""
    found = modal(files(tmp_path), tmp_path)
    assert [round(m["frequency_hz"]) for m in found["modes"]] == [400, 480, 1500]
    assert [m["grade"] for m in found["modes"]] == ["sure"] * 3
    assert sorted(m["rank"] for m in found["modes"]) == [1, 2, 3]
    assert found["warnings"] == []
    shown = capsys.readouterr().out
    assert "warning" not in shown
    assert "or doubtful" not in shown


def test_milliseconds_given_as_seconds_are_reported_by_import_and_modal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The pulse of 0.5 ms lasts half a second; the way out is in the warning."""
    paths = files(tmp_path, scale=1e3)
    assert "'time:ms'" in modal(paths, tmp_path)["warnings"][0]
    run_import(
        paths,
        tmp_path / "s.h5",
        ImportRequest(
            SampleOptions(COLUMNS),
            overwrite=False,
            json_target=str(tmp_path / "i.json"),
        ),
    )
    assert "'time:ms'" in json.loads((tmp_path / "i.json").read_text())["warnings"][0]
    assert capsys.readouterr().out.count("warning: recording 'hit0'") == 2


def test_a_block_too_short_for_the_modes_is_reported(tmp_path: Path) -> None:
    """8.6 ms after the hit: modes 80 Hz apart need 25 ms."""
    found = modal(files(tmp_path, seconds=0.0186), tmp_path)
    assert len(found["modes"]) < 3
    assert "modes closer than" in found["warnings"][0]
    assert "record longer" in found["warnings"][0]


def test_no_mode_for_want_of_length_says_so(tmp_path: Path) -> None:
    """4 ms: the error names the length of the block, not more hits alone."""
    with pytest.raises(NoModeFound, match=r"a block of \S+ ms has lines"):
        modal(files(tmp_path, seconds=0.0145), tmp_path)


def test_levels_that_disagree_are_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Frequencies fall by 0.5 % for each doubling of the force."""
    levels = (100.0, 200.0, 140.0, 280.0, 110.0)
    hits = files(tmp_path, shift=-0.005, levels=levels, modes=MODES[:1])
    found = modal(hits, tmp_path)
    assert found["linearity"]["nonlinear"]
    assert "levels disagree" in found["notes"][0]
    assert "note: levels disagree" in capsys.readouterr().out


def test_one_hit_says_that_its_level_is_compared_with_nothing(tmp_path: Path) -> None:
    """Neither a plan nor another hit."""
    found = modal(files(tmp_path, levels=(100.0,)), tmp_path)
    assert "single hit" in found["warnings"][0]
    assert not found["linearity"]["checked"]


def test_the_glancing_hit_of_five_files_is_refused_with_its_reason(
    tmp_path: Path,
) -> None:
    """5 N in a file of its own beside 100 N."""
    levels = (100.0, 95.0, 5.0, 108.0, 99.0)
    found = modal(files(tmp_path, levels=levels), tmp_path)
    assert [hit["verdict"] for hit in found["hits"]] == ["ok", "ok", "weak", "ok", "ok"]
    assert found["averages"] == 4


def test_each_rejected_hit_has_a_line_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line end between them is printed, not written out as an escape."""
    modal(files(tmp_path, levels=(100.0, 100.0, 100.0, 100.0, 4.0)), tmp_path)
    shown = capsys.readouterr().out
    assert "\n  hit 1 weak: " in shown
    assert "\\n" not in shown
