"""The command line's contract: exit codes, one-line errors, JSON."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from jointbench.station.main import app, exit_code

HITS = "time:s,force:N,acceleration:m/s^2"


def jointbench(*words: object) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user does, in a process of its own."""
    code = "from jointbench.station.main import run; run()"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
    )


Refused = Callable[..., str]


@pytest.fixture
def refused(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Refused:
    """Run a command that must fail on bad data; return its one line of error.

    Standard error is taken as the process writes it, libraries in C included.
    """

    def run(*words: object) -> str:
        monkeypatch.setattr(sys, "argv", ["jointbench", *map(str, words)])
        assert exit_code(app, debug=False) == 3
        (line,) = capfd.readouterr().err.strip().splitlines()
        assert line.startswith("jointbench: error: ")
        return line

    return run


def hit_table(path: Path, *, rows: int = 400) -> Path:
    """Write a small, valid hit file and return its path."""
    time = np.arange(rows) / 1000
    force = np.where((time > 0.02) & (time < 0.025), 100.0, 0.0)
    rings = np.exp(-10 * time) * np.sin(300 * time)
    np.savetxt(path, np.stack([time, force, rings], 1), delimiter=",")
    return path


def test_a_missing_file_is_one_line_and_code_three(tmp_path: Path) -> None:
    """The line names the file; in a process of its own."""
    done = jointbench("modal", tmp_path / "gone.h5")
    assert done.returncode == 3, done.stderr
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith("jointbench: error: ")
    assert "gone.h5" in line


def test_a_table_without_units_is_refused_with_what_to_type(
    refused: Refused, tmp_path: Path
) -> None:
    """Units are never guessed."""
    path = hit_table(tmp_path / "hit.csv")
    line = refused("import", path, "--out", tmp_path / "s.h5")
    assert "--columns" in line
    assert not (tmp_path / "s.h5").exists()


def test_a_wrong_unit_is_refused(refused: Refused, tmp_path: Path) -> None:
    """A force in metres is no force."""
    path = hit_table(tmp_path / "hit.csv")
    wrong = "time:s,force:m,acceleration:m/s^2"
    line = refused("import", path, "--out", tmp_path / "s.h5", "--columns", wrong)
    assert "'m'" in line


@pytest.mark.parametrize(
    ("name", "edit"),
    [
        ("a row that lacks a column", lambda t: t.replace("\n", "\n0.1,5\n", 1)),
        ("a NaN in the force", lambda t: t.replace("1.0000", "nan", 1)),
        ("time that runs backwards", lambda t: "\n".join(t.splitlines()[::-1])),
    ],
)
def test_a_damaged_table_is_refused(
    name: str, edit: "object", refused: Refused, tmp_path: Path
) -> None:
    """Unequal columns, NaN and a clock that runs backwards never get in."""
    path = hit_table(tmp_path / "hit.csv")
    assert callable(edit)
    path.write_text(edit(path.read_text()))
    refused("import", path, "--out", tmp_path / "s.h5", "--columns", HITS)
    assert not (tmp_path / "s.h5").exists(), name


def test_swapped_columns_are_named_where_no_hit_is_accepted(
    refused: Refused, tmp_path: Path
) -> None:
    """`modal` names the cause as `import` does, not only the double hit."""
    path = hit_table(tmp_path / "hit.csv")
    line = refused("modal", path, "--columns", "time:s,acceleration:m/s^2,force:N")
    assert "are the columns swapped?" in line


@pytest.fixture(scope="module")
def whole_session(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Import a hit once; return the bytes of its session file."""
    folder = tmp_path_factory.mktemp("whole")
    path = hit_table(folder / "hit.csv")
    done = jointbench("import", path, "--out", folder / "s.h5", "--columns", HITS)
    assert done.returncode == 0, done.stderr
    return (folder / "s.h5").read_bytes()


@pytest.mark.parametrize("command", ["modal", "report", "inspect", "surface"])
@pytest.mark.parametrize("kept", [0, 100, 5000])
def test_an_empty_or_truncated_session_is_refused(
    command: str,
    kept: int,
    tmp_path: Path,
    whole_session: bytes,
    refused: Refused,
) -> None:
    """Whatever is asked of it, a cut session file is one line and code three."""
    cut = tmp_path / "cut.h5"
    cut.write_bytes(whole_session[:kept])
    assert "cut.h5" in refused(command, cut)


def test_an_unknown_option_is_a_usage_error() -> None:
    """Code two, one line, and the near match named."""
    done = jointbench("modal", "--jsom", "-", "x.h5")
    assert done.returncode == 2
    assert "--jsom" in done.stderr


def test_import_reports_channels_and_records_as_json(tmp_path: Path) -> None:
    """JSON on standard output is nothing but JSON."""
    path = hit_table(tmp_path / "hit.csv")
    done = jointbench(
        "import", path, "--out", tmp_path / "s.h5", "--columns", HITS, "--json", "-"
    )
    content = json.loads(done.stdout)
    assert [c["quantity"] for c in content["channels"]] == ["force", "acceleration"]
    assert list(content["records"]) == ["hit"]


def test_inspect_shows_what_import_brought_in(
    tmp_path: Path, whole_session: bytes
) -> None:
    """The file speaks for itself."""
    session = tmp_path / "s.h5"
    session.write_bytes(whole_session)
    shown = jointbench("inspect", session)
    assert shown.returncode == 0
    assert "hit" in shown.stdout
    assert "acceleration" in shown.stdout


def test_an_unexpected_error_is_one_line_too() -> None:
    """The traceback is for --debug; the operator gets a line and code one."""
    code = (
        "from jointbench.station.main import exit_code\n"
        "def broken(standalone_mode):\n"
        "    raise ZeroDivisionError('by zero')\n"
        "raise SystemExit(exit_code(broken, debug=False))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "--debug" in done.stderr
