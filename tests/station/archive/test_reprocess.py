"""Archives: pool, ledger, quarantine, resuming."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.archive.archive_table import (
    read_results,
    table_rows,
)
from jointbench.station.archive.cluster import ClusterSettings, require_safe
from jointbench.station.archive.ledger import Ledger, open_ledger, read_ledger
from jointbench.station.archive.process_file import Outcome, State, process_task
from jointbench.station.archive.reprocess import (
    Places,
    make_tasks,
    pool_backend,
    reprocess,
)
from jointbench.station.archive.reprocess_progress import progress_line, time_words
from jointbench.station.archive.worker_pool import PoolSettings
from jointbench.station.files.archive_patterns import archive_folder, session_files
from jointbench.station.files.output_paths import make_folder, whole_file
from jointbench.station.files.spreadsheet_text import escaped
from jointbench.station.schemas.recipe import Recipe, read_recipe

PLAIN = Recipe(name="plain")
MANY = 60
"""Files of an archive that no run finishes while a busy machine delays its end."""


def serial(tasks, recipe):
    """Run tasks one after another, here."""
    return (process_task(task, recipe) for task in tasks)


def places(folder: Path) -> Places:
    """Return places below a folder."""
    return Places(folder / "out", folder / "plain.ledger.jsonl", None, 0)


def run(folder: Path, backend=serial, recipe: Recipe = PLAIN):
    """Reprocess all sessions below a folder."""
    here = places(folder)
    files = session_files([str(folder / "in")])
    return reprocess(make_tasks(files, recipe, here), recipe, here, backend)


def copies_of(first: Path, count: int) -> None:
    """Make other sessions of one, with other bytes after its end."""
    for number in range(1, count):
        data = first.read_bytes() + str(number).encode()
        first.with_name(f"{number}.h5").write_bytes(data)


def stems(paths: Iterable[Path]) -> set[str]:
    """Return the names of sessions that files belong to."""
    return {path.name.split(".")[0] for path in paths}


def leave_begun_and_two_more(folder: Path) -> set[str]:
    """Remove the other sessions without a result; return the names of those left."""
    begun = stems(folder.glob("out/*"))
    rest = [p for p in sorted(folder.glob("in/*.h5")) if p.stem not in begun]
    for path in rest[2:]:
        path.unlink()
    return stems(folder.glob("in/*.h5"))


def test_an_archive_is_done_once_and_its_bad_files_are_quarantined(
    make_session, tmp_path: Path
) -> None:
    """Two good, one of text: the second pass skips two and remembers the third."""
    make_session("in/a.h5")
    make_session("in/deep/b.h5", seed=2)
    (tmp_path / "in" / "c.h5").write_text("no session", encoding="utf-8")
    first = run(tmp_path)
    assert first.counts == {State.DONE: 2, State.SKIPPED: 0, State.FAILED: 1}
    second = run(tmp_path)
    assert second.counts == {State.DONE: 0, State.SKIPPED: 2, State.FAILED: 1}
    listed = (tmp_path / "plain.ledger.quarantine.csv").read_text(encoding="utf-8")
    assert "c.h5" in listed
    assert "no HDF5" in listed


def test_the_pool_gives_what_one_process_gives(make_session, tmp_path: Path) -> None:
    """Workers that retire after a file: the same quantities."""
    for number in range(2):
        make_session(f"in/{number}.h5", seed=number + 1)
    files = session_files([str(tmp_path / "in")])
    tasks = make_tasks(files, PLAIN, places(tmp_path))
    settings = PoolSettings(jobs=1, recycle=1)
    summary = run(tmp_path, pool_backend(settings))
    assert summary.counts[State.DONE] == 2
    pooled = [table_rows(read_results([t.result])[0]) for t in tasks]
    for task in tasks:
        task.result.unlink()
    run(tmp_path)
    alone = [table_rows(read_results([t.result])[0]) for t in tasks]
    names = [[(r.part, r.item, r.name, r.word) for r in rows] for rows in alone]
    assert [[(r.part, r.item, r.name, r.word) for r in x] for x in pooled] == names
    # A worker has one thread, this process as many as it likes: sums round otherwise.
    for one, other in zip(pooled, alone, strict=True):
        values = [[row.value for row in rows] for rows in (one, other)]
        assert np.allclose(*values, rtol=1e-9, equal_nan=True)


def test_a_killed_run_goes_on_where_it_was(make_session, tmp_path: Path) -> None:
    """SIGKILL after the first result: called again, all are there, none done twice."""
    copies_of(make_session("in/0.h5"), MANY)
    recipe = tmp_path / "plain.toml"
    recipe.write_text("", encoding="utf-8")
    ledger = tmp_path / "ledger.jsonl"
    command = [
        *(sys.executable, "-c", "from jointbench.station.main import run; run()"),
        *("reprocess", str(tmp_path / "in"), "--recipe", str(recipe), "--jobs", "1"),
        *("--results", str(tmp_path / "out"), "--ledger", str(ledger)),
    ]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, **quiet)  # type: ignore[call-overload]
    for _ in range(15_000):
        if process.poll() is not None or list(tmp_path.glob("out/*.results.h5")):
            break
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    there = len(list(tmp_path.glob("out/*.results.h5")))
    assert 1 <= there < MANY
    left = leave_begun_and_two_more(tmp_path)
    here = Places(tmp_path / "out", ledger, None, 0)
    files = session_files([str(tmp_path / "in")])
    known = read_recipe(recipe)
    again = reprocess(make_tasks(files, known, here), known, here, serial)
    assert again.counts[State.SKIPPED] >= there
    assert stems(tmp_path.glob("out/*.results.h5")) == left
    lines = [x for x in read_ledger(ledger) if x.get("kind") == "file"]
    finished = [x["file"] for x in lines if x["state"] == "done"]
    assert len(set(finished)) == len(finished)
    assert not list(tmp_path.rglob("*.part"))


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent otherwise there")
def test_ctrl_c_finishes_the_files_in_progress_and_reports_each(
    make_session, tmp_path: Path
) -> None:
    """Every result that is there has its line in the ledger; exit code 130."""
    copies_of(make_session("in/0.h5"), MANY)
    command = [
        *(sys.executable, "-c", "from jointbench.station.main import run; run()"),
        *("reprocess", str(tmp_path / "in"), "--jobs", "1"),
        *("--results", str(tmp_path / "out")),
    ]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, **quiet)  # type: ignore[call-overload]
    for _ in range(15_000):
        if process.poll() is not None or list(tmp_path.glob("out/*.results.h5")):
            break
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    assert process.wait(300) == 130
    there = len(list(tmp_path.glob("out/*.results.h5")))
    lines = read_ledger(tmp_path / "out" / "default.ledger.jsonl")
    assert 1 <= there < MANY
    assert sum(line["kind"] == "file" for line in lines) == there
    assert lines[-1]["interrupted"] is True


@pytest.mark.skipif(sys.platform == "win32", reason="kills are sent otherwise there")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_polite_kill_stops_the_run_in_order(
    make_session, tmp_path: Path, name: str
) -> None:
    """As Ctrl-C: what was done has its line, and the ledger records how it ended."""
    make_session("in/a.h5")

    def killed(tasks, recipe):
        yield from serial(tasks, recipe)
        signal.raise_signal(getattr(signal, name))
        yield from serial(tasks, recipe)

    summary = run(tmp_path, killed)
    assert summary.interrupted
    assert len(summary.outcomes) == 1


def test_a_full_disk_stops_the_run_and_blames_no_file(
    make_session, tmp_path: Path
) -> None:
    """A result that cannot be written is no fault of its session."""
    make_session("in/a.h5")

    def unwritable(tasks, recipe):
        for task in tasks:
            yield Outcome(
                task.path, task.result, State.FAILED, reason="no space", unwritable=True
            )

    summary = run(tmp_path, unwritable)
    assert summary.unwritable == "no space"
    assert summary.failed == []
    listed = (tmp_path / "plain.ledger.quarantine.csv").read_text(encoding="utf-8")
    assert listed.count("\n") == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
def test_a_ledger_on_a_full_disk_is_one_line(tmp_path: Path) -> None:
    """Said as what it is, and not again when the file is closed."""
    path = tmp_path / "l.jsonl"
    path.symlink_to("/dev/full")
    with path.open("ab", buffering=0) as file, pytest.raises(UsageError) as caught:
        Ledger(path, file=file).write({"kind": "run"})  # type: ignore[arg-type]
    assert "make room" in str(caught.value)


def test_what_cannot_be_written_is_a_usage_error_and_leaves_nothing(
    tmp_path: Path,
) -> None:
    """A file in the place of a folder takes no results, no table and no ledger."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    below = tmp_path / "file" / "below"
    with pytest.raises(UsageError, match="cannot be made"):
        make_folder(below)
    with (
        pytest.raises(UsageError, match="cannot be written"),
        whole_file(below) as part,
    ):
        part.write_text("", encoding="utf-8")
    with pytest.raises(UsageError, match="takes no files"), open_ledger(below, {}):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_results_are_no_sessions(make_session, tmp_path: Path) -> None:
    """A second pattern over the same folder does not meet the results."""
    make_session("in/a.h5")
    (tmp_path / "in" / "a.plain.results.h5").write_bytes(b"")
    assert [p.name for p in session_files([str(tmp_path / "in" / "*.h5")])] == ["a.h5"]
    with pytest.raises(UsageError, match="quote the pattern"):
        session_files([str(tmp_path / "in" / "*.hdf5")])


def test_a_folder_met_by_several_links_is_walked_once(
    make_session, tmp_path: Path
) -> None:
    """Two loops and a link to the file: one session, under its own name."""
    path = make_session("in/deep/a.h5")
    (tmp_path / "in" / "loop").symlink_to(tmp_path / "in")
    (tmp_path / "in" / "deep" / "up").symlink_to(tmp_path / "in")
    (tmp_path / "in" / "also.h5").symlink_to(path)
    assert session_files([str(tmp_path / "in")]) == (path,)
    assert session_files([str(tmp_path / "in" / "**" / "*.h5")]) == (path,)


def test_an_archive_that_grows_keeps_the_places_of_its_results(
    make_session, tmp_path: Path
) -> None:
    """A second specimen makes the common folder another, and the result's place not."""
    first = make_session("in/plate-1/a.h5")
    for pattern in (str(tmp_path / "in"), str(tmp_path / "in" / "**" / "*.h5")):
        root = archive_folder([pattern])
        assert root == tmp_path / "in"
        task = make_tasks([first], PLAIN, places(tmp_path), root=root)[0]
        assert task.result == tmp_path / "out" / "plate-1" / "a.plain.results.h5"
    assert archive_folder([str(first)]) == first.parent


def test_names_that_are_no_text_are_done_and_listed_all_the_same(
    make_session, tmp_path: Path
) -> None:
    """A line end, an escape and a byte that is no UTF-8: no file stops the others."""
    good = make_session("in/a.h5")
    names = [b"new\nline.h5", b"\x1b[31mred.h5", b"byte\xff.h5", b"=cut\xff.h5"]
    for name in names:
        path = Path(os.fsdecode(os.fsencode(tmp_path / "in") + b"/" + name))
        try:
            path.write_bytes(good.read_bytes() + name)
        except OSError:
            pytest.skip("this system has no such names")
    path.write_bytes(b"no session")
    summary = run(tmp_path)
    assert summary.counts == {State.DONE: 4, State.SKIPPED: 0, State.FAILED: 1}
    listed = (tmp_path / "plain.ledger.quarantine.csv").read_text(encoding="utf-8")
    assert "=cut\\udcff.h5" in listed
    assert "\x1b" not in listed
    assert run(tmp_path).counts[State.SKIPPED] == 4


def test_a_hostile_ledger_is_survived(tmp_path: Path) -> None:
    """Nesting without end, other types and a line that is no object are passed over."""
    path = tmp_path / "l.jsonl"
    with open_ledger(path, {}):
        pass
    with path.open("a", encoding="utf-8") as file:
        file.write("[" * 100_000 + "\n" + "3\n" + '{"kind": "file", "file": [1]}\n')
        file.write('{"kind":"file","file":{},"state":"failed","lasting":1,"key":[]}\n')
    with open_ledger(path, {}) as ledger:
        assert list(ledger.refused.values()) == [("[]", "")]


def test_a_ledger_outlives_a_line_that_was_cut(tmp_path: Path) -> None:
    """The cut line is passed over; the next run begins a line of its own."""
    path = tmp_path / "l.jsonl"
    with open_ledger(path, {}):
        pass
    with path.open("a", encoding="utf-8") as file:
        file.write('{"kind": "file", "fi')
    with open_ledger(path, {}):
        pass
    assert [line["kind"] for line in read_ledger(path)] == ["run", "run"]


def test_a_ledger_has_one_writer(tmp_path: Path) -> None:
    """A second run over the same ledger is refused while the first is running."""
    path = tmp_path / "l.jsonl"
    with (
        open_ledger(path, {}),
        pytest.raises(UsageError, match="another run"),
        open_ledger(path, {}),
    ):
        pass


def test_another_file_is_no_ledger(tmp_path: Path) -> None:
    """Nothing is appended to somebody's notes."""
    path = tmp_path / "notes.txt"
    path.write_text("my notes\n", encoding="utf-8")
    with pytest.raises(UsageError, match="no ledger"), open_ledger(path, {}):
        pass
    assert path.read_text(encoding="utf-8") == "my notes\n"


@pytest.mark.parametrize("cell", ["=1+1", "+1", "-1", "@x"])
def test_a_cell_is_no_formula(cell: str) -> None:
    """What a spreadsheet would run is escaped."""
    assert escaped(cell) == f"'{cell}"


def test_the_line_of_progress_shows_rate_and_time_left() -> None:
    """50 files worked on in 100 s: 2 s a file; those that were skipped took none."""
    counts = {State.DONE: 49, State.SKIPPED: 100, State.FAILED: 1}
    line = progress_line(counts, 300, 100.0)
    assert line == "150/300 files: 49 done, 100 skipped, 1 failed; 2 s/file, 5 min left"
    resumed = {State.DONE: 0, State.SKIPPED: 100, State.FAILED: 0}
    assert "100 files/s" in progress_line(resumed, 300, 1.0)
    assert time_words(3725) == "1 h 2 min"


@pytest.mark.parametrize(
    "address", ["tcp://10.0.0.1:8786", "tcp://example.org:1", "tls://h:1", "h:1"]
)
def test_a_scheduler_beyond_this_machine_needs_tls(address: str) -> None:
    """Refused before anything is sent."""
    with pytest.raises(UsageError):
        require_safe(ClusterSettings(address))


def test_a_certificate_that_is_not_there_is_no_silent_scheduler(tmp_path: Path) -> None:
    """Said as what it is, before any connection."""
    there = tmp_path / "ca.pem"
    there.write_text("", encoding="utf-8")
    gone = tmp_path / "gone.pem"
    with pytest.raises(UsageError, match=r"--tls-cert is .*gone\.pem"):
        require_safe(
            ClusterSettings(
                "tls://127.0.0.1:1",
                authority=there,
                certificate=gone,
                private_key=there,
            )
        )


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "tcp://localhost:1"])
def test_a_scheduler_on_this_machine_is_fine(address: str) -> None:
    """Loopback needs no certificate."""
    require_safe(ClusterSettings(address))


def test_the_ledger_says_what_became_of_each_file(make_session, tmp_path: Path) -> None:
    """One JSON line a file between the lines of the run."""
    make_session("in/a.h5")
    run(tmp_path)
    text = (tmp_path / "plain.ledger.jsonl").read_text(encoding="utf-8")
    kinds = [json.loads(line)["kind"] for line in text.splitlines()]
    assert kinds == ["run", "file", "end"]
