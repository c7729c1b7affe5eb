"""`import --guess`: the proposal, its picture, and nothing written before a yes."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.commands.import_command import ImportRequest, run_import
from jointbench.station.guess.run_guess import GuessRequest, run_guess

RATE, COUNT = 10_000.0, 3000
TIME = np.arange(COUNT) / RATE
FORCE = np.zeros(COUNT)
FORCE[100:120] = 200.0 * np.sin(np.pi * (np.arange(20) + 0.5) / 20)
AFTER = np.where(TIME > 0.01, TIME - 0.01, 0.0)
MOTION = 30.0 * np.exp(-9.0 * AFTER) * np.sin(2 * np.pi * 150.0 * AFTER)


def guessed(
    path: Path, *, yes: bool = True, rate: float | None = None
) -> tuple[bool, Path]:
    """Run the command on one file; return whether it wrote, and the session."""
    out = path.with_name("s.h5")
    picture = path.with_name("p.html")
    given, asked = SampleOptions(rate=rate), GuessRequest(yes=yes, picture=picture)
    options = run_guess([path], out, given, asked, None)
    if options is not None:
        run_import([path], out, ImportRequest(options))
    assert "Proposal for" in picture.read_text(encoding="utf-8")
    return options is not None, out


def test_columns_without_names_or_units_are_proposed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Milliseconds, the response before a negative force, decimal commas."""
    path = tmp_path / "h.csv"
    rows = zip(1e3 * TIME, MOTION, -FORCE, strict=True)
    lines = ("; ".join(f"{v:.6f}" for v in row).replace(".", ",") for row in rows)
    path.write_text("\n".join(lines), encoding="ascii")
    wrote, out = guessed(path, yes=False)
    shown = capsys.readouterr().out
    assert not wrote
    assert not out.exists()
    assert "--columns 'time:ms,acceleration:m/s^2,force:-N'" in shown
    assert "nothing was written" in shown
    assert "█" in shown
    assert guessed(path)[0]
    (one,) = read_session(out).recordings
    assert one.sample_rate == RATE
    by_name = {c.name: row for c, row in zip(one.channels, one.samples, strict=True)}
    np.testing.assert_allclose(by_name["force"], FORCE, atol=1e-6)
    np.testing.assert_allclose(by_name["acceleration"], MOTION, atol=1e-6)


def test_the_rate_comes_from_the_header_or_from_a_variable(tmp_path: Path) -> None:
    """A sampling frequency above the table; fs in an archive."""
    text = tmp_path / "h.txt"
    with text.open("w", encoding="ascii") as file:
        file.write("Test 7\nSampling frequency: 10 kHz\nhammer\tresponse\n")
        np.savetxt(file, np.c_[FORCE, MOTION], delimiter="\t", fmt="%.6f")
    assert guessed(text)[0]
    archive = tmp_path / "other" / "h.npz"
    archive.parent.mkdir()
    np.savez(archive, x1=MOTION, x2=FORCE, fs=RATE)
    wrote, out = guessed(archive)
    assert wrote
    (one,) = read_session(out).recordings
    assert one.sample_rate == RATE
    assert [c.name for c in one.channels] == ["x1", "x2"]


def test_what_nothing_shows_is_asked_for(tmp_path: Path) -> None:
    """No rate anywhere, and no column that is a hammer's pulse."""
    path = tmp_path / "h.npy"
    np.save(path, np.array([FORCE, MOTION]))
    with pytest.raises(UsageError, match="pass it as well"):
        guessed(path)
    assert guessed(path, rate=RATE)[0]
    ringing = tmp_path / "r.npy"
    np.save(ringing, np.array([MOTION, 2 * MOTION]))
    with pytest.raises(UsageError, match="no column is a short pulse"):
        guessed(ringing, rate=RATE)
