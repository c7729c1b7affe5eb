"""Digests of content: accidents to results are found, refused and made again."""

import json
import os
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, CorruptedFile
from jointbench.acquisition.file_access.content_digest import (
    DIGEST,
    Seal,
    content_digest,
)
from jointbench.station.archive.archive_table import (
    read_results,
    table_rows,
    write_table,
)
from jointbench.station.archive.ledger import open_ledger, read_ledger
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.archive.reprocess import Places, make_tasks, reprocess
from jointbench.station.commands.archive_command import run_archive
from jointbench.station.commands.compare_command import run_compare
from jointbench.station.commands.export_command import run_export
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.commands.process_command import run_process
from jointbench.station.commands.verify_archive import check_file, verify_all
from jointbench.station.report.session_report import run_report
from jointbench.station.results.results_file import results_path
from jointbench.station.schemas.recipe import Recipe

KEPT = Path(__file__).parents[2] / "fixtures"
PLAIN = Recipe(name="plain")
FREQUENCY = "modal/0/modes/natural_frequency"


def overwrite(path: Path, name: str = FREQUENCY, value: float = 999.0) -> None:
    """Change one number in place, as an editor of HDF5 files would."""
    with h5py.File(path, "r+") as file:
        file[name][0] = value


def made(session: Path) -> Path:
    """Return the result of a session under the plain recipe."""
    path = session.with_suffix(".plain.results.h5")
    outcome = process_task(Task(session, path), PLAIN)
    assert outcome.state is not State.FAILED, outcome.reason
    return path


def unsign(path: Path) -> None:
    """Make of a result one as it was written before there were digests."""
    with h5py.File(path, "r+") as file:
        del file.attrs[DIGEST]


def run(folder: Path, *, backend=None):
    """Reprocess all sessions of a folder, results and ledger below it."""
    places = Places(None, folder / "plain.ledger.jsonl", None, 0)
    tasks = make_tasks(sorted(folder.glob("?.h5")), PLAIN, places)

    def serial(tasks, recipe):
        return (process_task(task, recipe) for task in tasks)

    return reprocess(tasks, PLAIN, places, backend or serial)


def test_a_frequency_that_was_overwritten_is_not_done_and_is_made_anew(
    make_session,
) -> None:
    """The key is still that of the session: its content is what counts."""
    session = make_session("s.h5")
    path = made(session)
    with h5py.File(path, "r") as file:
        before = float(file[FREQUENCY][0])
    overwrite(path)
    outcome = process_task(Task(session, path), PLAIN)
    assert outcome.state is State.DONE
    assert "corrupted" in outcome.corrupted
    with h5py.File(path, "r") as file:
        assert file[FREQUENCY][0] == before
    assert process_task(Task(session, path), PLAIN).state is State.SKIPPED


@pytest.mark.parametrize("name", ["quantities/value", "modal/0/frf/frf_re"])
def test_whatever_number_changes_is_found(make_session, name: str) -> None:
    """Small datasets have no checksum of HDF5, large ones have one that was redone."""
    path = made(make_session("s.h5"))
    with h5py.File(path, "r+") as file:
        dataset = file[name]
        dataset[(0,) * dataset.ndim] = 1.25
    assert check_file(path).state is Seal.CORRUPTED


def test_an_attribute_or_a_dataset_that_comes_or_goes_is_found(make_session) -> None:
    """Averages that were edited, and a group that was deleted."""
    path = made(make_session("s.h5"))
    kept = path.read_bytes()
    with h5py.File(path, "r+") as file:
        file["modal/0/frf"].attrs["averages"] = np.int64(50)
    assert check_file(path).state is Seal.CORRUPTED
    path.write_bytes(kept)
    assert check_file(path).state is Seal.WHOLE
    with h5py.File(path, "r+") as file:
        del file["stages"]
    assert check_file(path).state is Seal.CORRUPTED


def test_values_that_are_stored_otherwise_have_the_same_digest(make_session) -> None:
    """The digest is of the content, not of the bytes: unpacking an array keeps it."""
    path = made(make_session("s.h5"))
    size = path.stat().st_size
    with h5py.File(path, "r+") as file:
        packed = file["modal/0/frf/frf_re"]
        values, scales = packed[...], [axis[0] for axis in packed.dims]
        texts = {
            name: (packed.attrs[name], packed.attrs.get_id(name).dtype)
            for name in ("units", "long_name")
        }
        del file["modal/0/frf/frf_re"]
        plain = file["modal/0/frf"].create_dataset("frf_re", data=values)
        for axis, scale in zip(plain.dims, scales, strict=True):
            axis.attach_scale(scale)
        for name, (value, kind) in texts.items():
            plain.attrs.create(name, value, dtype=kind)
        assert content_digest(file) == file.attrs[DIGEST].decode()
    assert path.stat().st_size != size


def test_process_says_what_it_made_anew(make_session, tmp_path: Path, capsys) -> None:
    """On the screen and in the JSON."""
    session = make_session("s.h5")
    where = {"recipe": None, "out": None, "stages": None, "again": False}
    target = run_process(session, **where, json_target=None).path
    overwrite(target)
    capsys.readouterr()
    run_process(session, **where, json_target=str(tmp_path / "p.json"))
    assert "computed again" in " ".join(capsys.readouterr().out.split())
    page = json.loads((tmp_path / "p.json").read_text(encoding="utf-8"))
    assert "corrupted" in page["ledger"][0]["rotten"]


def test_reprocess_makes_a_corrupted_result_again_and_reports_it(
    make_session, tmp_path: Path
) -> None:
    """One of two: the other is left as it is."""
    for name in ("a.h5", "b.h5"):
        make_session(name, seed=ord(name[0]))
    assert run(tmp_path).counts[State.DONE] == 2
    overwrite(tmp_path / "a.plain.results.h5")
    again = run(tmp_path)
    assert (again.counts[State.DONE], again.counts[State.SKIPPED]) == (1, 1)
    assert [one.path.name for one in again.corrupted] == ["a.h5"]
    lines = [x for x in read_ledger(tmp_path / "plain.ledger.jsonl") if x.get("rotten")]
    assert len(lines) == 1


def test_a_result_that_is_cut_short_is_made_anew_and_said(make_session) -> None:
    """It has no digest to compare with, and is damaged all the same."""
    session = make_session("s.h5")
    path = made(session)
    path.write_bytes(path.read_bytes()[:-2000])
    outcome = process_task(Task(session, path), PLAIN)
    assert (outcome.state, bool(outcome.corrupted)) == (State.DONE, True)


def test_nothing_to_do_opens_neither_sessions_nor_results(
    make_session, tmp_path: Path
) -> None:
    """Size, time and ledger settle it; the backend is not even started."""
    make_session("a.h5")
    (tmp_path / "b.h5").write_text("no session", encoding="utf-8")
    first = run(tmp_path)
    assert (first.counts[State.DONE], first.counts[State.FAILED]) == (1, 1)

    def no_one(tasks, recipe):
        raise AssertionError("nothing is to be done")

    again = run(tmp_path, backend=no_one)
    assert (again.counts[State.SKIPPED], again.counts[State.FAILED]) == (1, 1)
    assert again.failed[0].reason == first.failed[0].reason


@pytest.mark.parametrize("name", ["a.h5", "a.plain.results.h5"])
def test_where_a_time_moved_the_digests_decide(
    make_session, tmp_path: Path, name: str
) -> None:
    """A file that was touched is read, found the same, and not done again."""
    make_session("a.h5")
    run(tmp_path)
    os.utime(tmp_path / name, (1e9, 1e9))
    looked: list[Path] = []

    def looking(tasks, recipe):
        looked.extend(task.path for task in tasks)
        return (process_task(task, recipe) for task in tasks)

    assert run(tmp_path, backend=looking).counts[State.SKIPPED] == 1
    assert len(looked) == 1
    assert run(tmp_path, backend=looking).counts[State.SKIPPED] == 1
    assert len(looked) == 1


def test_results_from_before_digests_are_unsigned_and_not_corrupted(
    make_session,
) -> None:
    """Skipped, exported and shown as before, whatever became of them."""
    session = make_session("s.h5")
    path = made(session)
    unsign(path)
    assert check_file(path).state is Seal.UNSIGNED
    outcome = process_task(Task(session, path), PLAIN)
    assert (outcome.state, outcome.corrupted) == (State.SKIPPED, "")
    assert run_export(path, kind="csv", folder=None, json_target=None)


@pytest.mark.parametrize("name", ["modal-1.results.h5", "processed-2.results.h5"])
def test_results_that_are_kept_from_2026_are_unsigned(name: str) -> None:
    """They are read, and no fault is found with them."""
    found = check_file(KEPT / name)
    assert (found.state, found.problems) == (Seal.UNSIGNED, ())


@pytest.mark.parametrize("kind", ["csv", "mat", "uff"])
def test_export_refuses_a_corrupted_result(make_session, kind: str) -> None:
    """No number of it leaves."""
    path = made(make_session("s.h5"))
    overwrite(path)
    with pytest.raises(CorruptedFile, match="make it again"):
        run_export(path, kind=kind, folder=None, json_target=None)
    assert not list(path.parent.glob(f"s.plain.results*.{kind}"))


def test_archive_and_compare_refuse_corrupted_results(
    make_session, tmp_path: Path
) -> None:
    """By themselves as bad data; among others they are named and left out."""
    paths = [made(make_session(f"{n}.h5", seed=n)) for n in (1, 2)]
    overwrite(paths[0])
    with pytest.raises(BadData, match="corrupted"):
        run_archive([str(paths[0])], out=None, trend="torque", json_target=None)
    with pytest.raises(BadData, match="corrupted"):
        run_compare(str(paths[0]), str(paths[0]), json_target=None)
    both = str(tmp_path / "*.results.h5")
    assert run_archive([both], out=None, trend="torque", json_target=None) == 1
    assert run_compare(both, both, json_target=None)[1] == 2


def test_report_refuses_a_corrupted_result(make_session) -> None:
    """The modes beside the session are not what the run wrote."""
    session = make_session("s.h5")
    run_modal([session])
    overwrite(results_path(session), "modes/natural_frequency")
    with pytest.raises(CorruptedFile):
        run_report(session, out=None, model=None, json_target=None)


def test_verify_takes_an_archive_and_counts_each_state(
    make_session, tmp_path: Path
) -> None:
    """Sessions, results of both layouts, a table and a ledger, by folder."""
    for name in ("a.h5", "b.h5", "c.h5"):
        make_session(name, seed=ord(name[0]))
    run(tmp_path)
    run_modal([tmp_path / "a.h5"])
    found = read_results([tmp_path / "a.plain.results.h5"])[0]
    write_table(tmp_path / "all.nc", table_rows(found))
    assert verify_all([str(tmp_path)], json_target=None)
    overwrite(tmp_path / "a.results.h5", "modes/damping_ratio")
    unsign(tmp_path / "b.plain.results.h5")
    overwrite(tmp_path / "all.nc", "value", 7.0)
    (tmp_path / "c.h5").write_bytes((tmp_path / "c.h5").read_bytes()[:-500])
    target = tmp_path / "v.json"
    assert not verify_all([str(tmp_path)], json_target=str(target))
    page = json.loads(target.read_text(encoding="utf-8"))
    states = {Path(row["file"]).name: row["state"] for row in page["files"]}
    assert states == {
        "a.h5": "whole",
        "b.h5": "whole",
        "c.h5": "damaged",
        "a.plain.results.h5": "whole",
        "b.plain.results.h5": "unsigned",
        "c.plain.results.h5": "whole",
        "a.results.h5": "rotten",
        "all.nc": "rotten",
        "plain.ledger.jsonl": "whole",
    }
    assert len(page["problems"]) == 3


def test_a_line_of_the_ledger_that_was_changed_is_passed_over(tmp_path: Path) -> None:
    """A refusal without a writer refuses nothing; verify reports it."""
    path = tmp_path / "x.ledger.jsonl"
    with open_ledger(path, {}) as ledger:
        ledger.write(
            {"kind": "file", "file": "a.h5", "state": "failed", "key": "k"}
            | {"lasting": True, "reason": "empty"}
        )
    path.write_text(path.read_text(encoding="utf-8").replace("a.h5", "b.h5"), "utf-8")
    with open_ledger(path, {}) as ledger:
        assert ledger.refused == {}
    assert check_file(path).state is Seal.CORRUPTED


def test_verify_reads_a_campaign_and_finds_a_cut_one_damaged(tmp_path: Path) -> None:
    """A campaign carries no digest; reading it shows whether it is complete."""
    campaign = KEPT / "frozen-0.1.0" / "campaign.h5"
    assert (check_file(campaign).kind, check_file(campaign).state) == (
        "campaign",
        Seal.UNSIGNED,
    )
    cut = tmp_path / "cut.h5"
    cut.write_bytes(campaign.read_bytes()[:-20_000])
    assert check_file(cut).state == "damaged"
    empty = tmp_path / "empty.h5"
    empty.write_bytes(campaign.read_bytes())
    with h5py.File(empty, "r+") as file:
        del file["records"]
    assert (check_file(empty).kind, check_file(empty).state) == ("campaign", "damaged")
