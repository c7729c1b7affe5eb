"""A recorded session under a recipe: results, kept stages, verdicts that changed."""

import io
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.records.recordings import Channel, Hit, Recording, Verdict
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.station.archive import process_file
from jointbench.station.archive.compare_results import compare_results
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.commands.process_command import run_process
from jointbench.station.pipeline.chain import run_chain
from jointbench.station.pipeline.record_codec import decode_record, encode_record
from jointbench.station.pipeline.stage_store import StageStore, prune_stages, stage_key
from jointbench.station.results.processed_file import processed_path
from jointbench.station.results.result_tables import result_texts
from jointbench.station.results.results_read import StoredResult, read_result
from jointbench.station.schemas.recipe import Recipe, read_recipe
from jointbench.station.schemas.recipe_modal_parts import HitsPart, WindowsPart
from jointbench.station.sources.open_source import open_runs
from jointbench.station.sources.record_source import record_runs

BENCH = """\
[bodies.base]
mass = "9 kg"
channel = "a0"
[bodies.top]
mass = "4.6 kg"
channel = "a1"
[links.support]
between = ["ground", "base"]
[links.joint]
between = ["base", "top"]
"""
PLAIN = Recipe(name="plain")
WIDE = Recipe(name="wide", windows=WindowsPart(force_width="30 ms"))


def done(path: Path, recipe: Recipe = PLAIN, *, again: bool = False):
    """Process a session with its stages kept beside it."""
    target = processed_path(path, recipe)
    task = Task(path, target, path.parent / "stages", again=again)
    return process_task(task, recipe)


def test_the_result_is_that_of_the_chain(make_session) -> None:
    """Modes in the results file are those that `run_chain` finds, to the last bit."""
    path = make_session("s.h5")
    outcome = done(path)
    assert outcome.state is State.DONE, outcome.reason
    model = run_chain(read_session(path).recordings).result.model
    stored = read_result(outcome.result)
    found = [q.value for q in stored.quantities if q.name == "natural_frequency"]
    assert found == model.natural_frequency.tolist()
    assert stored.torque == 20.0
    assert stored.facts["specimen"] == "P1"


def test_raw_is_never_altered(make_session) -> None:
    """The session's digest is the same before and after."""
    path = make_session("s.h5")
    before = file_digest(path)
    done(path)
    assert file_digest(path) == before


def test_a_result_that_is_there_is_skipped(make_session) -> None:
    """The key of input, recipe and version is all that counts."""
    path = make_session("s.h5")
    done(path)
    assert done(path).state is State.SKIPPED
    assert done(path, again=True).state is State.DONE


def test_a_changed_input_is_done_again(make_session) -> None:
    """Another content under the same name has another key."""
    path = make_session("s.h5")
    done(path)
    path.unlink()
    make_session("s.h5", seed=2)
    assert done(path).state is State.DONE


@pytest.mark.parametrize("step", ["open_session", "process_session"])
def test_a_file_that_changes_while_it_is_read_is_tried_again(
    make_session, monkeypatch, step: str
) -> None:
    """Its digest would be that of another content: no result, and no lasting fault."""
    path = make_session("s.h5")
    reading = getattr(process_file, step)

    def rewritten(*arguments: Any):
        found = reading(*arguments)
        os.utime(path, (1e9, 1e9))
        return found

    monkeypatch.setattr(process_file, step, rewritten)
    outcome = done(path)
    assert (outcome.state, outcome.lasting) == (State.FAILED, False)
    assert "changed while it was read" in outcome.reason
    assert not outcome.result.exists()


def test_a_changed_window_runs_what_depends_on_it_and_nothing_else(
    make_session,
) -> None:
    """FRF, modes and fill are run; hits and Kalman stage are taken as kept."""
    path = make_session("s.h5")
    first = done(path)
    assert first.computed == (
        "hits",
        "kalman of stream",
        "frf",
        "modes",
        "fill",
        "amplitude",
    )
    second = done(path, WIDE)
    assert second.computed == ("frf", "modes", "fill", "amplitude")
    assert second.reused == ("hits", "kalman of stream")


def test_a_changed_band_leaves_the_frf_alone(make_session) -> None:
    """Only modes, and what fills losses by them, are run."""
    path = make_session("s.h5")
    done(path)
    banded = Recipe(name="banded", modes={"band": ("100 Hz", "600 Hz")})
    assert done(path, banded).computed == ("modes", "fill", "amplitude")


def test_kept_stages_give_the_same_result_as_fresh_ones(make_session) -> None:
    """A result out of kept stages equals one without."""
    path = make_session("s.h5")
    done(path)
    kept = read_result(done(path, WIDE).result).quantities
    alone = Task(path, path.with_name("alone.results.h5"))
    process_task(alone, WIDE)
    assert repr(read_result(alone.result).quantities) == repr(kept)


def test_a_damaged_stage_is_run_again(make_session, tmp_path: Path) -> None:
    """Cut every kept stage short: all are run, and the result is the same."""
    path = make_session("s.h5")
    before = repr(read_result(done(path).result).quantities)
    for stage in (tmp_path / "stages").rglob("*.stage"):
        stage.write_bytes(stage.read_bytes()[:-30])
    path.with_suffix(".plain.results.h5").unlink()
    outcome = done(path)
    assert outcome.reused == ()
    assert repr(read_result(outcome.result).quantities) == before


def test_verdicts_that_changed_are_listed(make_session) -> None:
    """A bounce of 20 % is double by default and accepted under 30 %."""
    path = make_session("s.h5", hits=3, bounce=0.2)
    loose = Recipe(name="loose", hits=HitsPart(double_ratio="30 %"))
    stored = read_result(done(path, loose).result)
    assert [(c.before, c.after) for c in stored.changes] == [("double", "ok")]
    assert stored.changes[0].time == pytest.approx(0.1, abs=2e-3)


def test_what_the_operator_refused_stays_refused(make_session) -> None:
    """No criterion can see what the operator saw."""
    path = make_session("s.h5", hits=3)
    session = read_session(path)
    recording = session.recordings[0]
    vetoed = replace(recording.hits[1], verdict=Verdict.OPERATOR, point="7")
    hits: tuple[Hit, ...] = (recording.hits[0], vetoed, recording.hits[2])
    changed = replace(session, recordings=(replace(recording, hits=hits),))
    write_session(changed, path, overwrite=True)
    assert read_result(done(path).result).changes == ()
    free = Recipe(name="free", hits=HitsPart(keep_operator=False))
    stored = read_result(done(path, free).result)
    assert [(c.before, c.after) for c in stored.changes] == [("operator", "ok")]


def test_a_session_without_hits_is_refused_with_the_reason(make_session) -> None:
    """Noise alone is no result, but a lasting failure."""
    path = make_session("s.h5")
    session = read_session(path)
    rng = np.random.default_rng(0)
    recording = session.recordings[0]
    quiet = rng.normal(0.0, 1e-3, recording.samples.shape)
    still = replace(recording, samples=quiet, hits=())
    write_session(replace(session, recordings=(still,)), path, overwrite=True)
    outcome = done(path)
    assert (outcome.state, outcome.lasting) == (State.FAILED, True)
    assert "stand out of the noise" in outcome.reason or "no force" in outcome.reason
    assert not outcome.result.exists()


def test_the_command_refuses_bad_data_as_bad_data(tmp_path: Path) -> None:
    """A text under the name of a session: exit code 3 by its class."""
    path = tmp_path / "s.h5"
    path.write_text("no session", encoding="utf-8")
    with pytest.raises(BadData, match="no HDF5"):
        run_process(
            path, recipe=None, out=None, stages=None, again=False, json_target=None
        )


def test_records_survive_being_kept() -> None:
    """A record encoded and decoded encodes to the same bytes."""
    rng = np.random.default_rng(1)
    frf = Frf(
        np.arange(1.0, 9.0),
        rng.normal(size=(1, 1, 8)) + 1j * rng.normal(size=(1, 1, 8)),
        kind=FrfKind.ACCELERANCE,
    )
    data = encode_record(frf)
    assert encode_record(decode_record(data, Frf)) == data


def test_a_kept_stage_cannot_name_a_record_of_its_choice() -> None:
    """A file that says Recording where an Frf is wanted is refused."""
    recording = Recording("r", np.zeros((0, 4)), 1.0, ())
    with pytest.raises(FormatError):
        decode_record(encode_record(recording), Frf)


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        ("text", float),
        ((1.0, "a"), tuple[float, ...]),
        ({"a": 1.0}, tuple[float, ...]),
        (Channel("force", "newton"), Channel),  # type: ignore[arg-type]
    ],
)
def test_a_kept_stage_holds_what_it_should(value: object, kind: type) -> None:
    """Another type, at the top or in a field, is refused before it is used."""
    with pytest.raises(FormatError):
        decode_record(encode_record(value), kind)


def test_a_kept_stage_that_would_unpack_to_more_is_refused() -> None:
    """Zeros that take a thousandth of their place: nothing of the station is packed."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, record=np.zeros(10_000, np.uint8))
    with pytest.raises(FormatError, match="packed"):
        decode_record(buffer.getvalue(), Frf)


def test_a_stage_under_the_name_of_another_is_run_again(tmp_path: Path) -> None:
    """A whole stage copied over another of its kind is found out by its key."""
    keys = [stage_key("s", number) for number in range(2)]
    for value, key in enumerate(keys):
        StageStore(tmp_path).run("s", key, float, lambda value=value: float(value))
    first, second = (next(tmp_path.rglob(f"{key}.stage")) for key in keys)
    second.write_bytes(first.read_bytes())
    store = StageStore(tmp_path)
    assert store.run("s", keys[1], float, lambda: 1.0) == 1.0
    assert store.computed == ["s"]
    assert store.run("s", keys[0], float, lambda: 9.0) == 0.0


def test_half_written_stages_of_killed_workers_go(tmp_path: Path) -> None:
    """An old one is dropped with the rest; a fresh one may be in work."""
    key = stage_key("s", 1)
    old, fresh = (tmp_path / key[:2] / f"{key}.stage.{n}.part" for n in (1, 2))
    old.parent.mkdir()
    for path in (old, fresh):
        path.write_bytes(b"half")
    os.utime(old, (1e9, 1e9))
    prune_stages(tmp_path, 10**9)
    assert not old.exists()
    assert fresh.exists()


def test_stages_that_were_not_used_for_longest_are_dropped_first(
    tmp_path: Path,
) -> None:
    """Three stages of equal size, room for two: the oldest goes."""
    store = StageStore(tmp_path)
    keys = [stage_key("s", number) for number in range(3)]
    for age, key in zip((100, 300, 200), keys, strict=True):
        store.run("s", key, tuple[float, ...], lambda: (1.0, 2.0))
        path = next(tmp_path.rglob(f"{key}.stage"))
        os.utime(path, (1e9 - age, 1e9 - age))
    size = next(tmp_path.rglob("*.stage")).stat().st_size
    assert prune_stages(tmp_path, 2 * size) == 1
    assert not list(tmp_path.rglob(f"{keys[1]}.stage"))


def test_links_are_identified_at_every_preload(tmp_path: Path) -> None:
    """Two preloads in one session: a row each, and a page that holds both."""
    recordings = []
    for number, preload in enumerate((20_000, 30_000)):
        url = f"sim:two-body?seed={number + 1}&hits=3&interval=0.7&preload={preload}"
        recorded = record_runs(open_runs(url))
        recordings.append(replace(recorded.recordings[0], name=f"run-{number}"))
    path = tmp_path / "s.h5"
    write_session(replace(recorded, recordings=tuple(recordings), joint=None), path)
    (tmp_path / "bench.toml").write_text(BENCH, encoding="utf-8")
    recipe_file = tmp_path / "r.toml"
    recipe_file.write_text(
        '[identification]\nmodel = "bench.toml"\n'
        '[contact]\nmodulus = "29 GPa"\nhardness = "1 GPa"\n',
        encoding="utf-8",
    )
    outcome = done(path, read_recipe(recipe_file))
    assert outcome.state is State.DONE, outcome.reason
    stored = read_result(outcome.result)
    found = {
        (q.preload, q.item): q.value
        for q in stored.quantities
        if q.part == "joint" and q.name == "stiffness"
    }
    assert set(found) == {
        (p, link) for p in (20_000.0, 30_000.0) for link in ("support", "joint")
    }
    # The simulated joint stiffens with its preload, the support does not.
    assert found[30_000.0, "joint"] > 1.1 * found[20_000.0, "joint"]
    assert found[30_000.0, "support"] == pytest.approx(
        found[20_000.0, "support"], rel=0.02
    )
    assert any("No contact prediction: no surface" in one for one in stored.remarks)
    pages = json.loads(result_texts(outcome.result)["joint"])["preloads"]
    assert [page["preload_n"] for page in pages] == [20_000.0, 30_000.0]
    assert same_again(outcome.result, stored)


def same_again(path: Path, stored: StoredResult) -> bool:
    """Return whether a comparison of a result with itself finds nothing."""
    found = compare_results([stored], [read_result(path)])
    return not (found.moved or found.unjudged or found.causes)
