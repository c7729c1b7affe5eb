"""Archives: pool, ledger, quarantine, resuming; tables, trends, comparisons."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.errors import BadData, UsageError
from jointbench.station.archive_files import result_files, session_files
from jointbench.station.archive_table import (
    read_results,
    table_rows,
    ways_of,
    write_table,
)
from jointbench.station.cluster import ClusterSettings, require_safe
from jointbench.station.compare_results import compare_results, match_modes
from jointbench.station.ledger import Ledger, escaped, open_ledger, read_ledger
from jointbench.station.outputs import make_folder, whole_file
from jointbench.station.process_file import Outcome, State, Task, process_task
from jointbench.station.quantities import Quantity
from jointbench.station.recipe import Recipe, WindowsPart, read_recipe
from jointbench.station.reprocess import Places, make_tasks, pool_backend, reprocess
from jointbench.station.reprocess_progress import progress_line, time_words
from jointbench.station.results_read import is_results, without_copies
from jointbench.station.trends import Trend, TrendPoint, fit_with_scatter, trends_of
from jointbench.station.worker_pool import PoolSettings

PLAIN = Recipe(name="plain")


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
    for number in range(6):
        make_session(f"in/{number}.h5", seed=number + 1)
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
    for _ in range(3000):
        if process.poll() is not None or list(tmp_path.glob("out/*.results.h5")):
            break
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    there = len(list(tmp_path.glob("out/*.results.h5")))
    assert 1 <= there < 6
    here = Places(tmp_path / "out", ledger, None, 0)
    files = session_files([str(tmp_path / "in")])
    known = read_recipe(recipe)
    again = reprocess(make_tasks(files, known, here), known, here, serial)
    assert again.counts[State.SKIPPED] >= there
    assert len(list(tmp_path.glob("out/*.results.h5"))) == 6
    lines = [x for x in read_ledger(ledger) if x.get("kind") == "file"]
    finished = [x["file"] for x in lines if x["state"] == "done"]
    assert len(set(finished)) == len(finished)
    assert not list(tmp_path.rglob("*.part"))


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent otherwise there")
def test_ctrl_c_finishes_the_files_in_hand_and_tells_of_each(
    make_session, tmp_path: Path
) -> None:
    """Every result that is there has its line in the ledger; exit code 130."""
    for number in range(5):
        make_session(f"in/{number}.h5", seed=number + 1)
    command = [
        *(sys.executable, "-c", "from jointbench.station.main import run; run()"),
        *("reprocess", str(tmp_path / "in"), "--jobs", "1"),
        *("--results", str(tmp_path / "out")),
    ]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, **quiet)  # type: ignore[call-overload]
    for _ in range(3000):
        if process.poll() is not None or list(tmp_path.glob("out/*.results.h5")):
            break
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    there = len(list(tmp_path.glob("out/*.results.h5")))
    lines = read_ledger(tmp_path / "out" / "default.ledger.jsonl")
    assert 1 <= there < 5
    assert sum(line["kind"] == "file" for line in lines) == there
    assert lines[-1]["interrupted"] is True


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
        session_files([str(tmp_path / "none" / "*.h5")])


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
    """A second run over the same ledger is refused while the first goes on."""
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


def test_the_line_of_progress_tells_rate_and_time_left() -> None:
    """50 of 200 files in 100 s: 2 s a file, 5 minutes left."""
    counts = {State.DONE: 40, State.SKIPPED: 9, State.FAILED: 1}
    line = progress_line(counts, 200, 100.0)
    assert line == ("50/200 files: 40 done, 9 skipped, 1 failed; 2 s/file, 5 min left")
    assert time_words(3725) == "1 h 2 min"


@pytest.mark.parametrize(
    "address", ["tcp://10.0.0.1:8786", "tcp://example.org:1", "tls://h:1", "h:1"]
)
def test_a_scheduler_beyond_this_machine_needs_tls(address: str) -> None:
    """Refused before anything is sent."""
    with pytest.raises(UsageError):
        require_safe(ClusterSettings(address))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "tcp://localhost:1"])
def test_a_scheduler_on_this_machine_is_fine(address: str) -> None:
    """Loopback needs no certificate."""
    require_safe(ClusterSettings(address))


def two_recipes(make_session, tmp_path: Path):
    """Return the results of two sessions under two recipes."""
    sets = []
    for recipe in (PLAIN, Recipe(name="short", windows=WindowsPart(lead="none"))):
        for number in range(2):
            if recipe is PLAIN:
                make_session(f"in/{number}.h5", seed=number + 1)
            task = Task(
                tmp_path / "in" / f"{number}.h5",
                tmp_path / f"{number}.{recipe.name}.results.h5",
            )
            process_task(task, recipe)
        sets.append(read_results(sorted(tmp_path.glob(f"*.{recipe.name}.results.h5"))))
    return [found for found, _ in sets]


def test_a_comparison_says_what_differs_and_pairs_by_content(
    make_session, tmp_path: Path
) -> None:
    """Two sessions, one setting that changed, the stages that hang on it."""
    before, after = two_recipes(make_session, tmp_path)
    found = compare_results(before, after)
    assert found.pairs == 2
    assert found.causes["windows.lead: chosen by the data -> 0.0"] == 2
    assert {d.since for d in found.differences if d.moved} == {"frf"}
    assert set(found.stages) == {"frf", "modes", "fill"}
    assert compare_results(before, before).moved == ()
    with pytest.raises(BadData, match="no session is in both"):
        compare_results(before[:1], after[1:])


def test_a_session_under_two_names_counts_once(make_session, tmp_path: Path) -> None:
    """Its copy is left out of trends, and no obstacle to a comparison."""
    path = make_session("in/a.h5")
    (tmp_path / "in" / "copy.h5").write_bytes(path.read_bytes())
    run(tmp_path)
    results, _ = read_results(sorted(tmp_path.glob("out/*.results.h5")))
    kept, copies = without_copies(results)
    assert [r.path.name for r in kept] == ["a.plain.results.h5"]
    assert [r.path.name for r in copies] == ["copy.plain.results.h5"]
    assert compare_results(results, results[:1]).pairs == 1
    other = [replace(results[0], key="another recipe's"), results[1]]
    with pytest.raises(BadData, match="same file"):
        compare_results(other, results)


def test_trends_of_two_recipes_are_kept_apart(make_session, tmp_path: Path) -> None:
    """One value under each recipe is no trend, and no second measurement."""
    before, after = two_recipes(make_session, tmp_path)
    rows = table_rows([*before, *after])
    assert set(ways_of(rows).values()) == {"plain: ", "short: "}
    assert set(ways_of(table_rows(before)).values()) == {""}
    edited = [replace(row, recipe="plain") for row in rows]
    assert all(len(way.split()) == 2 for way in ways_of(edited).values())


def test_a_change_without_a_deviation_is_told_apart(
    make_session, tmp_path: Path
) -> None:
    """What has no standard deviation cannot move beyond it, but is not passed over."""
    one = two_recipes(make_session, tmp_path)[0][0]
    bare = [Quantity("contact", "ke", "stiffness", "N/m", v) for v in (1.0, 2.0)]
    first, second = (replace(one, quantities=(q,)) for q in bare)
    found = compare_results([first], [second])
    assert found.moved == ()
    assert [d.after for d in found.unjudged] == [2.0]


def test_a_result_of_any_name_is_taken_where_it_is_named(
    make_session, tmp_path: Path
) -> None:
    """`process --out r.h5` makes one that a pattern would not find."""
    path = make_session("in/a.h5")
    result = tmp_path / "r.h5"
    process_task(Task(path, result), PLAIN)
    assert result_files([str(result)]) == (result,)
    assert is_results(result)
    assert not is_results(path)
    with pytest.raises(UsageError, match="names no results"):
        result_files([str(tmp_path / "*.h5")])


def test_modes_are_paired_by_frequency_not_by_number() -> None:
    """A mode that came in below shifts the numbers, not the pairs."""
    assert match_modes([100.0, 300.0], [50.0, 101.0, 299.0]) == {0: 1, 1: 2}
    assert match_modes([100.0], [120.0]) == {}


def test_one_table_opens_in_pandas_and_xarray(make_session, tmp_path: Path) -> None:
    """CSV, netCDF, Parquet and MAT hold the same rows."""
    pandas = pytest.importorskip("pandas", reason="pandas opens the table")
    xarray = pytest.importorskip("xarray", reason="xarray opens the table")
    pytest.importorskip("pyarrow", reason="Parquet is an extra")
    rows = table_rows(two_recipes(make_session, tmp_path)[0])
    for name in ("t.csv", "t.nc", "t.parquet", "t.mat"):
        write_table(tmp_path / name, rows)
    plain = scipy.io.loadmat(tmp_path / "t.mat")
    assert plain["value"].ravel() == pytest.approx([r.value for r in rows], nan_ok=True)
    assert [name.strip() for name in plain["name"]] == [row.name for row in rows]
    frames = [
        pandas.read_csv(tmp_path / "t.csv"),
        xarray.open_dataset(tmp_path / "t.nc", engine="h5netcdf").to_dataframe(),
        pandas.read_parquet(tmp_path / "t.parquet"),
    ]
    for frame in frames:
        assert len(frame) == len(rows)
        assert np.allclose(frame["torque"], 20.0)
        wanted = [row.value for row in rows]
        assert np.array_equal(frame["value"].to_numpy(float), wanted, equal_nan=True)


def test_a_trend_finds_the_slope_it_was_given() -> None:
    """100 + 0.2 T with a scatter of 0.01: the slope within three of its sd."""
    rng = np.random.default_rng(3)
    points = [
        TrendPoint(
            "modes 1 f", "Hz", float(t), 100 + 0.2 * t + rng.normal(0, 0.01), 1e-3
        )
        for t in np.tile([20.0, 40.0, 60.0, 80.0], 6)
    ]
    trend = trends_of(points)[0]
    assert abs(trend.slope - 0.2) < 3 * trend.slope_sd < 3e-3
    assert trend.scatter == pytest.approx(0.01, rel=0.5)
    assert trend.significance > 100


def test_specimens_that_agree_are_not_told_apart() -> None:
    """Equal means within their sd: no change seen."""
    points = [
        TrendPoint("f", "Hz", name, 100.0 + d, 0.1)
        for name in ("A", "B")
        for d in (-0.05, 0.05)
    ]
    trend = trends_of(points)[0]
    assert trend.significance < 1
    assert [g[0] for g in trend.groups] == ["A", "B"]


def test_the_scatter_makes_chi_squared_what_it_should_be() -> None:
    """Values +-1 about a mean, exact by themselves: scatter sqrt(n / (n - 1))."""
    value = np.array([1.0, -1.0, 1.0, -1.0])
    found, covariance, scatter = fit_with_scatter(np.ones((4, 1)), value, np.zeros(4))
    assert found[0] == pytest.approx(0.0, abs=1e-12)
    assert scatter == pytest.approx(math.sqrt(4 / 3), rel=1e-9)
    assert covariance[0, 0] == pytest.approx(1 / 3, rel=1e-9)


def test_a_trend_over_nothing_known_is_refused() -> None:
    """The message lists what there is."""
    with pytest.raises(UsageError, match="specimen"):
        Trend.point(None, "colour")  # type: ignore[arg-type]


def test_the_ledger_says_what_became_of_each_file(make_session, tmp_path: Path) -> None:
    """One JSON line a file between the lines of the run."""
    make_session("in/a.h5")
    run(tmp_path)
    text = (tmp_path / "plain.ledger.jsonl").read_text(encoding="utf-8")
    kinds = [json.loads(line)["kind"] for line in text.splitlines()]
    assert kinds == ["run", "file", "end"]
