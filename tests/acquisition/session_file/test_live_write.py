"""The file of a recording: what was flushed is there, and nothing else is."""

import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.finish import finish_live
from jointbench.acquisition.session_file.live_read import read_live
from jointbench.acquisition.session_file.live_write import LiveSession
from jointbench.acquisition.session_file.store import read_session, write_session

ROWS = [
    {
        "name": name,
        "quantity": quantity,
        "point": "1",
        "direction": "+z",
        "unit": unit,
        "sensitivity": 1e-3,
        "range": 1000.0,
    }
    for name, quantity, unit in (
        ("force", "force", "N"),
        ("a1", "acceleration", "m/s^2"),
    )
]
META = {"uuid": "u", "sample_rate": 1000.0, "simulated": True, "channels": ROWS}
HIT = {
    "kind": "hit",
    "number": 0,
    "start": 110,
    "trigger": 115,
    "stop": 190,
    "point": "2",
    "peak_force": 5.0,
    "verdict": "ok",
    "measure": 0.0,
    "reason": "clean",
}


def block(first: int, count: int = 100) -> np.ndarray:
    """Return samples that say their own index."""
    return np.vstack(
        (np.arange(first, first + count), -np.arange(first, first + count))
    )


def record(path: Path, *, end: bool = True) -> None:
    """Record two runs of 100 samples, the second with a hit and a gap after it."""
    with LiveSession(path, META, channels=2, block=100) as live:
        live.log({"kind": "run", "name": "one", "point": "1", "preload": 10.0})
        live.append(block(0), segment=0, first=0)
        live.log({"kind": "run", "name": "two", "point": "2", "preload": 20.0})
        live.append(block(100), segment=0, first=100)
        live.log(HIT)
        live.log({"kind": "gap", "what": "overrun", "samples": 50})
        live.append(block(250), segment=0, first=250)
        if end:
            live.log({"kind": "end"})


def test_a_run_becomes_a_recording_and_a_gap_ends_one(tmp_path: Path) -> None:
    """Three recordings: run one, run two, and what came after the gap."""
    record(tmp_path / "s.h5")
    session = read_session(tmp_path / "s.h5")
    assert [r.name for r in session.recordings] == ["one", "two", "two (2)"]
    assert [r.preload for r in session.recordings] == [10.0, 20.0, 20.0]
    np.testing.assert_array_equal(session.recordings[2].samples, block(250))


def test_a_hit_is_kept_where_it_fell_in_its_recording(tmp_path: Path) -> None:
    """Sample 115 of the stream is sample 15 of run two, struck at point 2."""
    record(tmp_path / "s.h5")
    (hit,) = read_session(tmp_path / "s.h5").recordings[1].hits
    assert (hit.trigger, hit.point) == (15, "2")


def test_the_latest_verdict_counts(tmp_path: Path) -> None:
    """What the operator says later replaces what the judge said."""
    path = tmp_path / "s.h5"
    with LiveSession(path, META, channels=2, block=100) as live:
        live.append(block(0, 200), segment=0, first=0)
        live.log(HIT)
        live.log({**HIT, "kind": "verdict", "verdict": "operator", "reason": "no"})
    (hit,) = read_session(path).recordings[0].hits
    assert hit.verdict is Verdict.OPERATOR


def test_a_finished_session_takes_the_place_of_its_recording(tmp_path: Path) -> None:
    """Written over the live file, it reads the same."""
    path = tmp_path / "s.h5"
    record(path)
    before = read_session(path)
    write_session(before, path, overwrite=True)
    after = read_session(path)
    with h5py.File(path, "r") as file:
        assert bytes(file.attrs["schema"]).startswith(b"jointbench-session/")
    np.testing.assert_array_equal(
        after.recordings[1].samples, before.recordings[1].samples
    )
    assert after.recordings[1].hits == before.recordings[1].hits


def test_a_block_with_a_wrong_checksum_is_left_out(tmp_path: Path) -> None:
    """One sample changed on the disk takes its block out, and is counted."""
    path = tmp_path / "s.h5"
    record(path)
    with h5py.File(path, "r+") as file:
        file["samples"][0, 150] = 7.0
    with open_guarded(path) as file:
        content = read_live(file)
    assert content.damaged == 1
    assert [span.stored for span in content.spans] == [0, 200]


def test_a_torn_line_of_the_log_is_left_out(tmp_path: Path) -> None:
    """The last line of a killed session may be half written."""
    path = tmp_path / "s.h5"
    record(path)
    with h5py.File(path, "r+") as file:
        file["log"].resize(file["log"].shape[0] - 5, axis=0)
    with open_guarded(path) as file:
        kinds = [entry["kind"] for entry in read_live(file).log]
    assert kinds == ["run", "run", "hit", "gap"]


KILLED = """
import os, signal, sys
sys.path[:0] = {path!r}
import numpy as np
from pathlib import Path
from jointbench.acquisition.session_file.live_write import LiveSession
live = LiveSession(Path({out!r}), {meta!r}, channels=2, block=100)
live.log({{"kind": "run", "name": "one"}})
for k in range(20):
    live.append(np.full((2, 100), float(k)), segment=0, first=100 * k)
while live._queue.qsize():
    pass
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is POSIX")
def test_a_killed_recording_opens_by_itself_and_misses_one_block_at_most(
    tmp_path: Path,
) -> None:
    """Twenty blocks passed, none waiting: nineteen or twenty are there."""
    out = tmp_path / "s.h5"
    code = KILLED.format(path=sys.path, out=str(out), meta=META)
    done = subprocess.run([sys.executable, "-c", code], check=False)
    assert done.returncode == -9
    session = read_session(out)
    samples = session.recordings[0].samples
    assert samples.shape[1] >= 1900
    np.testing.assert_array_equal(
        samples[0], np.repeat(np.arange(samples.shape[1] // 100), 100)
    )
    assert session.provenance[-1].name == "recovered"


LIMITED = """
import resource, signal, sys
sys.path[:0] = {path!r}
import numpy as np
from pathlib import Path
from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.session_file.live_write import LiveSession
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2_400_000, 2_400_000))
live = LiveSession(Path({out!r}), {meta!r}, channels=2, block=1000)
try:
    for k in range(2000):
        live.append(np.full((2, 1000), float(k)), segment=0, first=1000 * k)
    live.close()
except InstrumentError as error:
    print(error)
import os
os._exit(0)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of files are POSIX")
def test_a_full_disk_is_one_line_and_what_was_written_opens(tmp_path: Path) -> None:
    """A file that may not grow past 2.4 MB stands for the disk."""
    out = tmp_path / "s.h5"
    code = LIMITED.format(path=sys.path, out=str(out), meta=META)
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    assert "the disk refuses more" in done.stdout
    assert "what was written is safe" in done.stdout
    samples = read_session(out).recordings[0].samples
    assert samples.shape[1] > 10_000
    np.testing.assert_array_equal(
        samples[0], np.repeat(np.arange(samples.shape[1] // 1000), 1000)
    )


def test_a_second_writer_is_kept_out(tmp_path: Path) -> None:
    """While one records, another cannot begin, and recovering has to wait."""
    path = tmp_path / "s.h5"
    with LiveSession(path, META, channels=2, block=100):
        assert is_held(path)
        with pytest.raises(UsageError, match="is there already"):
            LiveSession(path, META, channels=2, block=100)
    assert not is_held(path)


def test_a_folder_that_is_not_there_is_a_usage_error(tmp_path: Path) -> None:
    """Nothing is left behind."""
    with pytest.raises(UsageError, match="cannot be written"):
        LiveSession(tmp_path / "no" / "s.h5", META, channels=2, block=100)


@pytest.mark.skipif(
    sys.platform == "win32" or os.geteuid() == 0, reason="root may write anywhere"
)
def test_a_folder_without_write_permission_is_a_usage_error(tmp_path: Path) -> None:
    """The message comes before a sample is taken."""
    tmp_path.chmod(0o500)
    with pytest.raises(UsageError, match="cannot be written"):
        LiveSession(tmp_path / "s.h5", META, channels=2, block=100)


def test_a_closed_session_takes_no_more(tmp_path: Path) -> None:
    """Closing twice is harmless."""
    live = LiveSession(tmp_path / "s.h5", META, channels=2, block=100)
    live.append(block(0), segment=0, first=0)
    live.close()
    live.close()
    assert read_session(tmp_path / "s.h5").recordings[0].samples.shape == (2, 100)


def test_an_error_of_the_disk_does_not_hide_another_one(tmp_path: Path) -> None:
    """An exception raised inside the context is the one that is seen."""
    with (
        pytest.raises(InstrumentError, match="own"),
        LiveSession(tmp_path / "s.h5", META, channels=2, block=100),
    ):
        raise InstrumentError("own")


def test_a_session_finished_in_place_is_what_its_recording_read_as(
    tmp_path: Path,
) -> None:
    """Samples, hits, channels, runs and provenance, bit for bit."""
    path = tmp_path / "s.h5"
    record(path)
    before = read_session(path)
    done = finish_live(path, path, overwrite=True)
    after = read_session(path)
    assert (done.samples, done.hits, done.damaged, done.ended) == (300, 1, 0, True)
    for field in fields(after):
        if field.name not in {"recordings", "joint"}:
            assert getattr(after, field.name) == getattr(before, field.name)
    for one, other in zip(after.recordings, before.recordings, strict=True):
        np.testing.assert_array_equal(one.samples, other.samples)
        for field in fields(one):
            if field.name != "samples":
                assert getattr(one, field.name) == getattr(other, field.name)
    with h5py.File(path, "r") as file:
        assert bytes(file.attrs["schema"]).startswith(b"jointbench-session/")


def test_a_session_finished_piece_by_piece_is_the_file_that_is_written_whole(
    tmp_path: Path,
) -> None:
    """Of several chunks, with a gap in between: layout and values are the same.

    The log of the recording is kept beside them, byte by byte.
    """
    path = tmp_path / "s.h5"
    with LiveSession(path, META, channels=2, block=1000) as live:
        live.log({"kind": "run", "name": "one", "point": "1"})
        for first in range(0, 150_000, 1000):
            live.append(block(first, 1000), segment=0, first=first)
        live.append(block(0, 1000), segment=1, first=0)
        live.log({"kind": "end"})
    write_session(read_session(path), tmp_path / "whole.h5")
    shares: list[float] = []
    finish_live(path, tmp_path / "pieces.h5", progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    with (
        h5py.File(tmp_path / "whole.h5") as whole,
        h5py.File(tmp_path / "pieces.h5") as pieces,
    ):
        names: list[str] = []
        whole.visit(names.append)
        found: list[str] = []
        pieces.visit(found.append)
        log = pieces["events/log"][...].tobytes()
        assert [n for n in found if n.partition("/")[0] != "events"] == names
        for name in names:
            if isinstance(whole[name], h5py.Dataset):
                assert pieces[name].dtype == whole[name].dtype
                assert pieces[name].chunks == whole[name].chunks
                np.testing.assert_array_equal(pieces[name][...], whole[name][...])
                assert set(pieces[name].attrs) == set(whole[name].attrs)
    with h5py.File(path, "r", swmr=True) as recording:
        assert log == recording["log"][...].tobytes()
    # The room that was reserved while it was written is given back.
    whole_size = (tmp_path / "whole.h5").stat().st_size
    assert (tmp_path / "pieces.h5").stat().st_size < 1.1 * whole_size


FINISH = """
import resource, sys
sys.path[:0] = {path!r}
from pathlib import Path
from jointbench.acquisition.session_file.store import write_session
from jointbench.acquisition.session_file.finish import finish_live
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
finish_live(Path({source!r}), Path({target!r}))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak of the memory")
def test_a_session_is_finished_in_memory_that_does_not_grow_with_it(
    tmp_path: Path,
) -> None:
    """32 MB of samples take no more than 24 MB; whole they would take 200 MB."""
    path, many = tmp_path / "s.h5", 65_536
    with LiveSession(path, META, channels=2, block=many) as live:
        for first in range(0, 64 * many, many):
            live.append(block(first, many), segment=0, first=first)
        live.log({"kind": "end"})
    code = FINISH.format(
        path=sys.path, source=str(path), target=str(tmp_path / "done.h5")
    )
    ran = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert int(ran.stdout) < 24 * 1024


@pytest.mark.skipif(sys.platform == "win32", reason="limits are POSIX")
def test_a_disk_without_room_for_the_finished_session_leaves_the_recording(
    tmp_path: Path,
) -> None:
    """One line, no part of a file, and the recording as it was."""
    path, many = tmp_path / "s.h5", 65_536
    rng = np.random.default_rng(1)
    with LiveSession(path, META, channels=2, block=many) as live:
        for first in range(0, 8 * many, many):
            live.append(rng.normal(size=(2, many)), segment=0, first=first)
    code = NO_ROOM.format(path=sys.path, source=str(path), target=str(path))
    ran = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert "cannot be written" in ran.stdout
    assert "File too large" in ran.stdout
    assert read_session(path).recordings[0].samples.shape == (2, 8 * many)
    assert not list(tmp_path.glob("*.part"))


NO_ROOM = """
import resource, signal, sys
sys.path[:0] = {path!r}
from pathlib import Path
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.session_file.finish import finish_live
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, 3_000_000))
try:
    finish_live(Path({source!r}), Path({target!r}), overwrite=True)
except UsageError as error:
    print(error)
"""
