"""A recording in a process of its own, followed late, or not at all."""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.ni.sensors import Axis, Sensor, table_channels
from jointbench.acquisition.ni.stream import Block, StreamGap
from jointbench.acquisition.ni.stream_records import StreamSettings, Waiting
from jointbench.acquisition.recorder.news import NewsBox
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.session_file.live_read import LiveSpan, read_live
from jointbench.acquisition.session_file.live_write import channel_rows
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

RATE, BLOCK = 12_800.0, 640
SENSORS = (
    Sensor(
        "f",
        Quantity.FORCE,
        "1",
        (Axis("cDAQSim1Mod1/ai0", "+z", 2.25e-3),),
        "N",
        range=2e3,
    ),
)


@contextmanager
def recording(
    path: Path, *, speed: float, buffer: float = 20.0, samples: int | None = None
) -> Iterator[tuple[RecorderProcess, Callable[[], None]]]:
    """Record the hammer of a simulated chassis; wait for a second of samples."""
    setup = ChassisSetup(speed=speed)
    meta = {
        "sample_rate": RATE,
        "simulated": True,
        "channels": channel_rows(table_channels(SENSORS)),
    }

    def wait() -> None:
        while server.delivered < RATE:
            time.sleep(0.02)  # the device, a thread of this process, needs the time

    with SimulatedChassis(setup) as server:
        settings = StreamSettings(RATE, BLOCK, buffer=buffer)
        wanted = Setup(server.address, SENSORS, settings, samples)
        with RecorderProcess(wanted) as recorder:
            recorder.begin(path, meta)
            yield recorder, wait


def stored(path: Path) -> int:
    """Return how many samples a recording has that is not followed any more."""
    with open_guarded(path) as file:
        return read_live(file).samples


def test_a_program_that_follows_late_gets_every_sample_that_was_stored(
    tmp_path: Path,
) -> None:
    """Nothing is requested for a second of signal; then it comes block by block."""
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0) as (recorder, wait):
        wait()
        late, first = [], []
        for item in recorder.items():
            if isinstance(item, Block):
                late.append(item.samples)
                first.append(item.first)
            if recorder.samples >= RATE:
                break
        recorder.stop(interrupted=False)
    assert first == list(range(0, BLOCK * len(first), BLOCK))
    with open_guarded(path) as file:
        np.testing.assert_array_equal(
            np.hstack(late), file["samples"][:, : recorder.samples]
        )
        assert read_live(file).samples == recorder.counters.delivered
    assert recorder.counters.lost == 0


def test_a_device_without_a_clock_waits_for_the_program(tmp_path: Path) -> None:
    """Nothing is read until it is asked for, whatever the load of the computer."""
    path = tmp_path / "s.h5"
    with recording(path, speed=np.inf) as (recorder, _):
        items = (item for item in recorder.items() if isinstance(item, Block))
        for _ in range(3):
            next(items)
        recorder.stop(interrupted=False)
    assert stored(path) == recorder.counters.delivered == 3 * BLOCK


def account(path: Path) -> tuple[int, dict[str, int]]:
    """Return the samples that gaps state, and the entry of the account.

    Spans and gaps of each segment must follow each other without a sample between,
    apart from what was read and, because of a pause, not wanted any more.
    """
    with open_guarded(path) as file:
        content = read_live(file)
    gaps = [e for e in content.log if e["kind"] == "gap"]
    parts = [(s.segment, s.first, s.count) for s in content.spans]
    parts += [(g["segment"], g["first_sample"], g["samples"]) for g in gaps]
    (books,) = [e for e in content.log if e["kind"] == "continuity"]
    reached: dict[int, int] = {}
    for segment, first, count in sorted(parts):
        assert 0 <= first - reached.get(segment, 0) <= books["unwanted"]
        reached[segment] = first + count
    assert content.samples == books["stored_samples"]
    assert content.samples == (
        books["acquired"] - books["unread"] - books["unwanted"] - books["lost"]
    )
    return sum(g["samples"] for g in gaps), books


def hold_up(recorder: RecorderProcess, seconds: float) -> None:
    """Stop the recording process for a time [s], as a busy computer may."""
    os.kill(recorder.process_id, signal.SIGSTOP)
    time.sleep(seconds)
    os.kill(recorder.process_id, signal.SIGCONT)


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
def test_overwritten_samples_are_stated_in_the_file_without_a_reader(
    tmp_path: Path,
) -> None:
    """The process is stopped for longer than the buffer: each sample is accounted."""
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0, buffer=0.5) as (recorder, wait):
        wait()
        hold_up(recorder, 0.3)  # 2.4 s of signal
        for item in recorder.items():
            if isinstance(item, StreamGap) and item.samples > RATE:
                break
        recorder.stop(interrupted=False)
    stated, books = account(path)
    assert stated == books["lost"] == recorder.counters.lost > RATE
    assert stated == sum(gap.samples for gap in recorder.gaps)


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
@pytest.mark.parametrize("end", ["stop", "pause"])
def test_samples_overwritten_before_the_end_are_stated_to_the_program(
    tmp_path: Path, end: str
) -> None:
    """The program ends or pauses at once after the hold-up, and has read no news."""
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0, buffer=0.5) as (recorder, wait):
        wait()
        hold_up(recorder, 0.3)
        if end == "pause":
            recorder.pause()
        recorder.stop(interrupted=True)
    stated, books = account(path)
    assert stated == books["lost"] == recorder.counters.lost > RATE
    assert stated == sum(gap.samples for gap in recorder.gaps)
    assert books["unread"] < RATE  # the buffer, and what one read took from it


def test_a_recording_of_a_length_has_so_many_samples_and_another_run_follows(
    tmp_path: Path,
) -> None:
    """The last block is short; what the device made beyond is stated as unwanted."""
    path, wanted = tmp_path / "s.h5", 3 * BLOCK + 7
    with recording(path, speed=np.inf, samples=wanted) as (recorder, _):
        list(recorder.follow())
        assert recorder.complete
        recorder.change(replace(recorder.setup, samples=5))
        blocks = [i.samples for i in recorder.items() if isinstance(i, Block)]
        recorder.stop(interrupted=False)
    with open_guarded(path) as file:
        spans = read_live(file).spans
    assert spans == (LiveSpan(0, 0, 0, wanted), LiveSpan(1, 0, wanted, 5))
    assert np.hstack(blocks).shape == (1, 5)
    stated, books = account(path)
    assert (stated, books["unwanted"]) == (0, BLOCK - 7 + BLOCK - 5)


def test_a_recording_that_is_followed_is_not_opened_a_second_time(
    tmp_path: Path,
) -> None:
    """HDF5 would read wrong chunks; afterwards it is read as any file."""
    path = tmp_path / "s.h5"
    with recording(path, speed=np.inf) as (recorder, _):
        next(item for item in recorder.items() if isinstance(item, Block))
        with pytest.raises(UsageError, match="followed by this program"):
            stored(path)
        recorder.stop(interrupted=False)
    assert stored(path) == BLOCK


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
def test_samples_recorded_before_a_pause_are_not_passed_on_after_it(
    tmp_path: Path,
) -> None:
    """They are in the file; what is judged belongs to the time after the pause.

    What the device had made when the pause was requested is stored before it stops:
    the recording process is late here, and finds the request before any samples.
    """
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0) as (recorder, wait):
        wait()
        hold_up(recorder, 0.3)  # 2.4 s of signal
        recorder.pause()
        before = recorder.samples
        recorder.resume()
        block = next(b for b in recorder.items() if isinstance(b, Block))
        assert before >= 2.4 * RATE > BLOCK
        assert (block.segment, block.first) == (1, 0)
        assert recorder.samples == before + BLOCK


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
def test_a_recording_process_that_is_killed_is_one_line(tmp_path: Path) -> None:
    """What it stored is there, its lock is free, and no one hangs."""
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0) as (recorder, _):
        items = (item for item in recorder.items() if isinstance(item, Block))
        for _ in range(3):
            next(items)
        os.kill(recorder.process_id, signal.SIGKILL)
        with pytest.raises(InstrumentError, match="has died"):
            for _ in range(100):
                next(items)
    assert not is_held(path)
    assert stored(path) >= 3 * BLOCK


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
def test_a_recording_process_that_is_asked_to_end_interrupts_the_session(
    tmp_path: Path,
) -> None:
    """SIGTERM to it alone: the program sees an interruption, the books are closed."""
    path = tmp_path / "s.h5"
    with recording(path, speed=8.0) as (recorder, _):
        items = recorder.items()
        next(items)
        os.kill(recorder.process_id, signal.SIGTERM)
        for _ in items:
            pass
        assert recorder.interrupted
    with open_guarded(path) as file:
        (end,) = [e for e in read_live(file).log if e["kind"] == "end"]
    assert end["interrupted"] is True


def test_a_file_that_cannot_be_written_is_said_by_its_own_error(tmp_path: Path) -> None:
    """The error of the other process is the error here."""
    (tmp_path / "s.h5").write_bytes(b"precious")
    with (
        pytest.raises(UsageError, match="is there already"),
        recording(tmp_path / "s.h5", speed=8.0),
    ):
        raise AssertionError


def test_news_do_not_grow_between_two_requests() -> None:
    """A thousand blocks that follow each other are one item; a gap stays one."""
    box = NewsBox()
    for n in range(1000):
        box.add(LiveSpan(0, 10 * n, 10 * n, 10))
    gap = StreamGap("overrun", 0, 10_000, 7, 0.1, "words")
    box.add(gap)
    box.add(LiveSpan(0, 10_007, 10_000, 10))
    box.add(Waiting(3))
    box.add(Waiting(4))
    assert box.take() == (
        LiveSpan(0, 0, 0, 10_000),
        gap,
        LiveSpan(0, 10_007, 10_000, 10),
        Waiting(7),
    )
    assert not box


def test_a_program_without_a_guard_does_not_start_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The main module is not imported again by the recording process."""
    main = tmp_path / "main.py"
    main.write_text(f"open({str(tmp_path / 'again')!r}, 'x')", encoding="utf-8")
    monkeypatch.setattr(sys.modules["__main__"], "__file__", str(main), raising=False)
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None)
    with recording(tmp_path / "s.h5", speed=8.0), suppress(InstrumentError):
        pass
    assert not (tmp_path / "again").exists()
    assert sys.modules["__main__"].__file__ == str(main)
