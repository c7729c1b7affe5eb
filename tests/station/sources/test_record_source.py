"""`record` keeps what was recorded as `measure` does: kills, stops, earlier files."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, InstrumentError, UsageError
from jointbench.acquisition.file_access.file_lock import hold_lock
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.commands.record_command import run_record
from jointbench.station.commands.verify_command import run_recover, run_verify
from jointbench.station.sources.open_source import RunSequence, open_runs
from jointbench.station.sources.record_live import record_live
from jointbench.station.sources.record_source import record_runs
from jointbench.station.sources.recorded_session import record_session_file

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
LONG = "sim:two-body?seed=1&hits=120"
SHORT = "sim:two-body?seed=1&hits=2&interval=0.7&sample_rate=6400"
CAMPAIGN = "sim:two-body-campaign?seed=2&grid=small"
RATE = 2000.0
START = """
import sys
sys.path[:0] = {path!r}
from jointbench.station.main import run
sys.argv = ["jointbench", "record", *{arguments!r}]
run()
"""


def start(*arguments: str) -> "subprocess.Popen[str]":
    """Start the command in a process of its own."""
    code = START.format(path=sys.path, arguments=list(arguments))
    return subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def stored(path: Path) -> int:
    """Return the samples that are in a file, finished or not."""
    try:
        session = read_session(path)
    except BadData:
        return 0
    return sum(recording.samples.shape[1] for recording in session.recordings)


def wait_for(path: Path, samples: int) -> int:
    """Wait until so many samples are in a file, and return how many there are."""
    until = time.monotonic() + 300.0
    while (count := stored(path)) < samples and time.monotonic() < until:
        time.sleep(0.05)
    return count


@dataclass(frozen=True)
class Steps:
    """A run of blocks of constant samples: the run's number, then the block's."""

    number: int
    blocks_made: int = 3
    stop_after: int | None = None
    stopped_by: signal.Signals = signal.SIGTERM
    channel: str = "force"

    simulated = True
    sample_rate = RATE
    preload = 1000.0

    @property
    def name(self) -> str:
        """Of the run."""
        return f"run {self.number}"

    @property
    def start_time(self) -> float:
        """Ten seconds apart, whatever lies between."""
        return 10.0 * self.number

    @property
    def channels(self) -> tuple[Channel, ...]:
        """A hammer at the point of the run, and a response."""
        return (
            Channel(self.channel, Quantity.FORCE, f"{self.number}", unit="N"),
            Channel("a", Quantity.ACCELERATION, "1", unit="g"),
        )

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the blocks; in front of one of them somebody asks to stop."""
        for block in range(self.blocks_made):
            if block == self.stop_after:
                signal.raise_signal(self.stopped_by)
            yield np.full((2, 100), self.number + block / 10)


def recorded(*runs: Steps) -> RunSequence:
    """Return a sequence of a few runs."""
    return RunSequence("steps", True, runs)


def test_what_is_recorded_live_is_what_runs_recorded_in_memory_is(
    tmp_path: Path,
) -> None:
    """Samples in single precision; names, times, preloads, points and hits alike."""
    record_session_file(CAMPAIGN, tmp_path / "s.h5")
    live, whole = read_session(tmp_path / "s.h5"), record_runs(open_runs(CAMPAIGN))
    assert live.source == whole.source
    assert live.joint == whole.joint
    assert len(live.recordings) == len(whole.recordings)
    for one, other in zip(live.recordings, whole.recordings, strict=True):
        assert (one.name, one.preload) == (other.name, other.preload)
        assert one.channels == other.channels
        assert one.start_time == pytest.approx(other.start_time)
        single = other.samples.astype(np.float32)
        np.testing.assert_array_equal(one.samples, single)
        assert [h.verdict for h in one.hits] == [h.verdict for h in other.hits]
        assert [h.start for h in one.hits] == [h.start for h in other.hits]


@POSIX
def test_a_recording_that_is_killed_can_be_recovered_with_its_hits(
    tmp_path: Path,
) -> None:
    """``kill -9`` in the middle: every block that was there, to the last bit."""
    path = tmp_path / "s.h5"
    with start(LONG, "--out", str(path)) as process:
        seen = wait_for(path, 90_000)
        process.kill()
        process.communicate(timeout=300)
    assert not run_verify(path, json_target=None)
    recovered = read_session(
        run_recover(path, out=None, overwrite=False, json_target=None)
    )
    (recording,) = recovered.recordings
    assert recording.samples.shape[1] >= seen >= 90_000
    first = next(iter(open_runs(LONG).runs[0].blocks()))
    size = first.shape[1]
    np.testing.assert_array_equal(
        recording.samples[:, :size], first.astype(np.float32).astype(float)
    )
    assert len(recording.hits) >= 2
    assert recording.preload is not None


@POSIX
def test_a_recording_that_is_stopped_is_finished(tmp_path: Path) -> None:
    """Exit code 5 as of `measure`; hits are judged, no lock is left.

    By a signal from outside; other signals are raised in the process itself, see
    `test_a_stop_in_the_second_run_keeps_the_block_in_hand`.
    """
    path, said = tmp_path / "s.h5", tmp_path / "s.json"
    with start(LONG, "--out", str(path), "--json", str(said)) as process:
        wait_for(path, 40_000)
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=300)
    assert process.returncode == 5
    assert run_verify(path, json_target=None)
    assert read_session(path).recordings[0].hits
    assert json.loads(said.read_text())["interrupted"] is True
    assert {p.name for p in tmp_path.iterdir()} == {"s.h5", "s.json"}


def test_runs_keep_their_own_times_and_points(tmp_path: Path) -> None:
    """Blocks of one run are joined, those of two never."""
    assert record_live(recorded(Steps(1), Steps(2)), tmp_path / "s.h5")
    one, two = read_session(tmp_path / "s.h5").recordings
    assert (one.start_time, two.start_time) == (10.0, 20.0)
    assert (one.channels[0].point, two.channels[0].point) == ("1", "2")
    assert one.samples.shape == two.samples.shape == (2, 300)
    assert two.samples[0, -1] == pytest.approx(2.2)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_stop_in_the_second_run_keeps_the_block_in_hand(
    tmp_path: Path, name: str
) -> None:
    """One whole run and one block of the next."""
    if not hasattr(signal, name):
        pytest.skip(f"no {name} on this system")
    stop = Steps(2, stop_after=0, stopped_by=signal.Signals[name])
    runs = Steps(1), stop, Steps(3)
    assert not record_live(recorded(*runs), tmp_path / "s.h5")
    session = read_session(tmp_path / "s.h5")
    assert [r.samples.shape[1] for r in session.recordings] == [300, 100]
    assert ends(session) == [True]


def ends(session: Session) -> list[object]:
    """Return whether a session was interrupted, as its log says."""
    return [
        dict(s.detail)["interrupted"] for s in session.provenance if s.name == "end"
    ]


def test_a_run_that_delivers_nothing_leaves_the_runs_before_it(tmp_path: Path) -> None:
    """An error of the instrument, and a finished file."""
    runs = Steps(1), Steps(2, blocks_made=0)
    with pytest.raises(InstrumentError, match="no sample"):
        record_live(recorded(*runs), tmp_path / "s.h5")
    assert run_verify(tmp_path / "s.h5", json_target=None)
    assert stored(tmp_path / "s.h5") == 300


def test_a_run_with_other_channels_is_refused(tmp_path: Path) -> None:
    """One file has the channels of its first run."""
    runs = Steps(1), Steps(2, channel="hammer")
    with pytest.raises(InstrumentError, match="session of its own"):
        record_live(recorded(*runs), tmp_path / "s.h5")


def test_an_earlier_session_is_replaced_by_a_whole_one_alone(tmp_path: Path) -> None:
    """A source that makes no sense costs nothing; one that is recorded takes over."""
    path = tmp_path / "s.h5"
    run_record(SHORT, path, overwrite=False, json_target=None)
    before = path.read_bytes()
    with pytest.raises(UsageError):
        run_record("sim:no-such-bench", path, overwrite=True, json_target=None)
    with hold_lock(path), pytest.raises(UsageError, match="recorded right now"):
        run_record(SHORT, path, overwrite=True, json_target=None)
    assert path.read_bytes() == before
    run_record(
        SHORT.replace("seed=1", "seed=2"), path, overwrite=True, json_target=None
    )
    assert "seed=2" in read_session(path).source
    assert [p.name for p in tmp_path.iterdir()] == ["s.h5"]


def test_an_own_model_is_not_replaced(tmp_path: Path) -> None:
    """It is refused before anything is recorded."""
    mine = tmp_path / "s.toml"
    mine.write_text("# my plan\n", encoding="utf-8")
    with pytest.raises(UsageError, match="no bench model"):
        run_record(CAMPAIGN, tmp_path / "s.h5", overwrite=True, json_target=None)
    assert mine.read_text(encoding="utf-8") == "# my plan\n"
    assert not (tmp_path / "s.h5").exists()
