"""What goes wrong around a measurement: disk, folder, Ctrl-C, calibration."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from finished_files import is_whole

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.measure.bench_session import run_measure
from jointbench.station.measure.session_record import Record
from jointbench.station.screen.interrupt import (
    hold_window,
    interruptible,
    interruptible_wait,
    patient_interrupt,
)

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
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


def start(
    folder: Path, source: str, before: str = "", plan: str | None = None
) -> "subprocess.Popen[str]":
    """Start the command in a process of its own."""
    file = plan_file(folder)
    if plan is not None:
        file.write_text(plan, encoding="utf-8")
    code = START.format(
        path=sys.path,
        before=before,
        plan=str(file),
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
        _, errors = process.communicate(timeout=300)
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
        process.communicate(timeout=300)
    assert is_whole(tmp_path / "s.h5")
    ends = [dict(s.detail) for s in read_session(tmp_path / "s.h5").provenance]
    assert any(end.get("interrupted") is True for end in ends)
    assert not (tmp_path / "s.h5.part").exists()
    assert not (tmp_path / "s.h5.lock").exists()


@POSIX
def test_a_polite_kill_leaves_a_finished_file(tmp_path: Path) -> None:
    """Two signals in a row; no lock is left. A hangup: where a terminal is closed."""
    with start(tmp_path, "sim:plates?speed=4") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("hit 2"):
                process.send_signal(signal.SIGTERM)
                process.send_signal(signal.SIGTERM)
                break
        process.communicate(timeout=300)
    assert process.returncode == 5
    assert is_whole(tmp_path / "s.h5")
    ends = [dict(s.detail) for s in read_session(tmp_path / "s.h5").provenance]
    assert any(end.get("interrupted") is True for end in ends)
    assert {p.name for p in tmp_path.iterdir()} == {"s.h5", "plan.toml"}


@POSIX
def test_a_session_whose_program_is_killed_is_finished_by_its_recording_process(
    tmp_path: Path,
) -> None:
    """After ``kill -9`` the file is finished, with the hits that were judged."""
    with start(tmp_path, "sim:plates?speed=4") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("hit 2"):
                process.kill()
                break
        # The recording process holds the output until it leaves.
        process.communicate(timeout=300)
    assert {p.name for p in tmp_path.iterdir()} == {"s.h5", "plan.toml"}
    session = read_session(tmp_path / "s.h5")
    assert sum(len(recording.hits) for recording in session.recordings) == 2
    (end,) = [dict(s.detail) for s in session.provenance if s.name == "end"]
    assert end["interrupted"] is True
    assert "the measuring program ended" in str(end["reason"])


@POSIX
def test_a_terminal_that_is_closed_leaves_a_finished_file(tmp_path: Path) -> None:
    """Its end sends SIGHUP, and from then on every line on the screen fails."""
    terminal, far = os.openpty()
    arguments = ["--source", "sim:plates?speed=4", "--json", str(tmp_path / "s.json")]
    code = START.format(
        path=sys.path,
        before="import fcntl, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0)",
        plan=str(plan_file(tmp_path)),
        out=str(tmp_path / "s.h5"),
        source="sim:plates?speed=4",
    ).replace("run()", f"sys.argv += {arguments!r}\nrun()")
    process = subprocess.Popen(
        [sys.executable, "-u", "-c", code],
        stdin=far,
        stdout=far,
        stderr=far,
        start_new_session=True,
    )
    os.close(far)
    seen = b""
    while b" HIT 2 " not in seen:
        seen += os.read(terminal, 65_536)
    os.close(terminal)
    assert process.wait(timeout=300) == 5
    assert is_whole(tmp_path / "s.h5")
    assert json.loads((tmp_path / "s.json").read_text())["interrupted"] is True
    assert not (tmp_path / "s.h5.lock").exists()


@POSIX
def test_a_reader_that_goes_away_does_not_end_a_session(tmp_path: Path) -> None:
    """``jointbench measure ... | head -1``: the plan is done nevertheless."""
    text = plan_file(tmp_path).read_text(encoding="utf-8").replace("= 30", "= 3")
    with start(tmp_path, "sim:plates?speed=4", plan=text) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.stdout.close()
        process.wait(timeout=300)
    session = read_session(tmp_path / "s.h5")
    assert sum(len(recording.hits) for recording in session.recordings) == 3


def test_a_closed_window_is_held_until_all_is_in_order() -> None:
    """The handler that Windows calls from a thread of its own returns only then."""
    record, over = Record(), threading.Event()
    number = signal.SIGTERM
    window = threading.Thread(target=hold_window, args=(number, over))
    with patient_interrupt(record):
        window.start()
        until = time.monotonic() + 300.0
        while not record.interrupted and time.monotonic() < until:
            pass
        assert record.interrupted
        assert window.is_alive()
        over.set()
        window.join(30.0)
    assert not window.is_alive()


def test_a_kill_before_anything_is_recorded_unwinds_at_once() -> None:
    """There is nothing to store: it is Ctrl-C."""
    with pytest.raises(KeyboardInterrupt), interruptible():
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            signal.raise_signal(signal.SIGTERM)  # does not disturb the unwinding


@POSIX
def test_a_hangup_that_is_ignored_stays_ignored() -> None:
    """As ``nohup`` wants it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    record = Record()
    try:
        with interruptible(), patient_interrupt(record):
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
    assert not record.interrupted


def test_who_waits_for_a_lost_device_hears_of_a_kill() -> None:
    """No one reads a note while the device is away."""
    record = Record()
    wait = interruptible_wait(record, sleep=lambda seconds: None)
    wait(0.2)
    record.interrupted = True
    with pytest.raises(KeyboardInterrupt):
        wait(0.2)


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
