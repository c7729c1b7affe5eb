"""Commands from another process to a session that is recorded."""

import json
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError, UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.station.bench_view.send_command import run_send
from jointbench.station.session_events.command_mailbox import (
    CommandMailbox,
    post_command,
)
from jointbench.station.session_events.flow_commands import AddNote, PauseSession

EXAMPLES = Path(__file__).parents[3] / "examples"
RUN = "from jointbench.station.main import run; run()"


def test_commands_are_taken_once_and_in_no_wrong_form(tmp_path: Path) -> None:
    """What was there before is removed, and what is no command; nothing stays."""
    session = tmp_path / "a[1].h5"
    post_command(session, AddNote("of an earlier session"))
    box = CommandMailbox(session)
    sender = post_command(session, PauseSession()).name.rpartition(".")[2]
    (tmp_path / f"{session.name}.ask.send-zero").write_text("[1", encoding="utf-8")
    assert list(box.take()) == [(sender, PauseSession())]
    assert list(CommandMailbox(session).take()) == []
    assert list(tmp_path.iterdir()) == []


def test_a_session_that_is_not_recorded_takes_no_command(tmp_path: Path) -> None:
    """And a word that is no command is refused before."""
    with pytest.raises(UsageError, match="not being recorded"):
        run_send(tmp_path / "s.h5", "pause", json_target=None)
    with pytest.raises(FormatError, match="did you mean 'pause'"):
        run_send(tmp_path / "s.h5", "pausse", json_target=None)


def test_a_recording_answers_another_process(tmp_path: Path) -> None:
    """A note is done, a point is refused, quitting ends an hour after seconds."""
    plan, out, said = tmp_path / "p.toml", tmp_path / "s.h5", tmp_path / "a.json"
    text = (EXAMPLES / "operating.toml").read_text(encoding="utf-8")
    plan.write_text(text.replace('"120 s"', '"3600 s"'), encoding="utf-8")
    words = [sys.executable, "-c", RUN, "record", str(plan), "--out", str(out)]
    source = "sim:spindle?seed=1&rpm=3000&speed=1"
    with subprocess.Popen(
        [*words, "--source", source], stdout=subprocess.DEVNULL
    ) as recording:
        try:
            while recording.poll() is None and not (out.exists() and is_held(out)):
                time.sleep(0.2)
            assert run_send(out, "note chips", json_target=str(said))
            assert not run_send(out, "go 4", json_target=None)
            assert run_send(out, "quit yes", json_target=None)
            assert recording.wait(300) == 5
        finally:
            recording.kill()
    answer = json.loads(said.read_text(encoding="utf-8"))
    assert answer["command"] == "note"
    assert answer["done"] is True
    notes = [e["words"] for e in read_log(out)[0] if e["kind"] == "note"]
    assert notes == ["chips"]


def test_a_measurement_answers_another_process(tmp_path: Path) -> None:
    """Pause, hits, points, an elongation, a note and the end, while it strikes."""
    plan, out = tmp_path / "p.toml", tmp_path / "s.h5"
    text = (EXAMPLES / "plates-preload.toml").read_text(encoding="utf-8")
    plan.write_text(text.replace("repeats = 3", "repeats = 400"), encoding="utf-8")
    words = [sys.executable, "-c", RUN, "measure", str(plan), "--out", str(out)]
    source = "sim:plates?seed=1&modules=2&washers=2&thermometer=1&speed=4"

    def asked(line: str) -> bool:
        return run_send(out, line, json_target=None)

    with subprocess.Popen(
        [*words, "--source", source], stdout=subprocess.DEVNULL
    ) as measuring:
        try:
            while measuring.poll() is None and not (out.exists() and is_held(out)):
                time.sleep(0.2)
            while not [h for h in hits_of(out) if h["point"] == "1"][4:]:
                time.sleep(0.2)
            assert asked("reject 4")
            assert not asked("reject 4")
            assert not asked("reject 9999")
            assert asked("pause")
            assert not asked("pause")
            assert not asked("go 2")
            assert asked("note a bolt was loose")
            assert asked("set elongation_2_um 35.2")
            assert not asked("set elongation_4_um 35.2")
            assert asked("continue")
            assert asked("go 2")
            assert not asked("go 77")
            assert not asked("quit")
            assert asked("quit yes")
            assert measuring.wait(300) == 5
        finally:
            measuring.kill()
    log = read_log(out)[0]
    verdicts = [e for e in log if e["kind"] == "verdict" and e["number"] == 3]
    assert verdicts[-1]["verdict"] == "operator"
    assert [e["words"] for e in log if e["kind"] == "note"] == ["a bolt was loose"]
    assert [e["point"] for e in log if e["kind"] == "run"][-1] == "2"
    assert [e["paused"] for e in log if e["kind"] == "pause"] == [True, False]


def hits_of(session: Path) -> list[dict[str, object]]:
    """Return the hits in the log of a session that is being recorded."""
    with suppress(BadData):
        return [e for e in read_log(session)[0] if e["kind"] == "hit"]
    return []
