"""What goes wrong around a measurement: disk, folder, Ctrl-C, calibration."""

import signal
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.session_file import read_session
from jointbench.station.measure import run_measure
from jointbench.station.verify import run_verify

EXAMPLE = Path(__file__).parents[2] / "examples" / "plates.toml"
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals and limits: POSIX")
START = """
import sys
sys.path[:0] = {path!r}
{before}
from jointbench.station.main import run
sys.argv = ["jointbench", "measure", {plan!r}, "--out", {out!r}, "--source", {source!r}]
run()
"""
LIMIT = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2_600_000, 2_600_000))
"""


def plan_file(folder: Path) -> Path:
    """Return the example's plan at 12.8 kHz: one point, many hits, no trial."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    hits = (
        'points = ["1"]\ntorques = ["20 N m"]\nrepeats = 30\nmost_repeats = 30\n'
        'trial_hits = 0\nlength = "0.3 s"\n'
    )
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{hits}\n[joint]{tail}", encoding="utf-8")
    return path


def start(folder: Path, source: str, before: str = "") -> "subprocess.Popen[str]":
    """Start the command in a process of its own."""
    code = START.format(
        path=sys.path,
        before=before,
        plan=str(plan_file(folder)),
        out=str(folder / "s.h5"),
        source=source,
    )
    return subprocess.Popen(
        [sys.executable, "-u", "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@POSIX
def test_a_disk_that_is_full_is_one_line_and_the_hits_until_then_are_there(
    tmp_path: Path,
) -> None:
    """A file that may not grow past 2.6 MB stands for the disk; exit code 4."""
    with start(tmp_path, "sim:plates", LIMIT) as process:
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 4
    assert "the disk refuses more" in errors
    assert len(errors.strip().splitlines()) == 1
    session = read_session(tmp_path / "s.h5")
    assert sum(len(recording.hits) for recording in session.recordings) >= 3


@POSIX
@pytest.mark.parametrize("word", ["recording", "hit 2"])
def test_ctrl_c_leaves_a_finished_file(tmp_path: Path, word: str) -> None:
    """Right after recording began, and in the middle of hits in real time."""
    with start(tmp_path, "sim:plates?speed=4") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith(word):
                process.send_signal(signal.SIGINT)
                break
        process.communicate(timeout=60)
    assert run_verify(tmp_path / "s.h5", json_target=None)
    ends = [dict(s.detail) for s in read_session(tmp_path / "s.h5").provenance]
    assert any(end.get("interrupted") is True for end in ends)
    assert not (tmp_path / "s.h5.part").exists()
    assert not (tmp_path / "s.h5.lock").exists()


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs a /proc")
def test_a_folder_that_takes_no_file_is_a_usage_error_before_any_hit(
    tmp_path: Path,
) -> None:
    """/proc takes no file from anybody, not even from root."""
    with pytest.raises(UsageError, match="cannot be written"):
        run_measure(
            plan_file(tmp_path),
            Path("/proc/self/s.h5"),
            source="sim:plates",
            overwrite=False,
            json_target=None,
        )


def test_an_expired_calibration_warns_on_the_screen_and_in_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The hammer's is two years old, the others' is a week old: one warning."""
    today = datetime.now(UTC).date()
    text = plan_file(tmp_path).read_text(encoding="utf-8").replace("= 30", "= 1")
    week = (today - timedelta(days=7)).isoformat()
    text = text.replace("2026-03-02", week)
    text = text.replace(week, (today - timedelta(days=730)).isoformat(), 1)
    (tmp_path / "plan.toml").write_text(text, encoding="utf-8")
    run_measure(
        tmp_path / "plan.toml",
        tmp_path / "s.h5",
        source="sim:plates",
        overwrite=False,
        json_target=None,
    )
    steps = read_session(tmp_path / "s.h5").provenance
    (warning,) = [dict(s.detail)["words"] for s in steps if s.name == "warning"]
    assert "'force' (41230): calibrated" in str(warning)
    assert "warning: sensor 'force'" in capsys.readouterr().out
