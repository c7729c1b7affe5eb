"""One pipeline: every use of a session runs the same stages, kept by any store."""

from dataclasses import replace
from pathlib import Path

import pytest

from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.files.toml_file import read_toml
from jointbench.station.pipeline.chain import ChainSettings, run_chain
from jointbench.station.pipeline.process_session import process_session
from jointbench.station.pipeline.recipe_settings import chain_settings
from jointbench.station.pipeline.stage_store import (
    MemoryStore,
    NoStore,
    StageRun,
    StageStore,
)
from jointbench.station.report.session_analysis import SessionAnalysis, analyse_session
from jointbench.station.report.session_report import run_report
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.recipe import ContactPart, IdentificationPart, Recipe
from jointbench.station.schemas.recipe_modal_parts import HitsPart, KalmanPart

MODAL_STAGES = ["hits", "kalman of stream", "frf", "modes", "fill", "amplitude"]
JOINT_STAGES = ["structure of face", "surface face", "contact", "joint"]
BENCH = """\
[bodies.base]
mass = "9 kg"
[bodies.top]
mass = "4.6 kg"
channel = "a1"
[links.support]
between = ["ground", "base"]
[links.joint]
between = ["base", "top"]
[contact]
link = "joint"
preload = "20 kN"
modulus = "29 GPa"
hardness = "1 GPa"
"""


@pytest.fixture
def session_file(make_session) -> Path:
    """A session of two hits and one surface, its results not yet found."""
    path = make_session("s.h5")
    face = rough_profile(2000, dimension=1.5, roughness=1e-10, spacing=5e-7, seed=3)
    whole = replace(read_session(path), surfaces=(replace(face, name="face"),))
    write_session(whole, path, overwrite=True)
    return path


@pytest.fixture
def bench(tmp_path: Path) -> BenchModel:
    """Two masses with a contact between them."""
    path = tmp_path / "bench.toml"
    path.write_text(BENCH, encoding="utf-8")
    return read_toml(path, BenchModel)


def recipe_of(bench: BenchModel) -> Recipe:
    """The recipe that asks for what a report with this model shows."""
    assert bench.contact is not None
    given = bench.contact.model_dump(exclude={"link"})
    return Recipe(
        contact=ContactPart.model_construct(**given),
        identification=IdentificationPart(model="bench.toml"),
    ).model_copy(update={"models": {"bench.toml": bench}})


def all_uses(path: Path, stages: list[StageStore], folder: Path) -> None:
    """Run `modal`, `report` and `process` on one session, each with a store."""
    digest = file_digest(path)
    modal, report, process = (StageRun(one, digest) for one in stages)
    run_modal([path], out=folder / "modes.h5", json_target=None, run=modal)
    page, other = folder / "page.html", folder / "report"
    other.mkdir()
    apart = other / path.name
    apart.write_bytes(path.read_bytes())  # beside it lie no results to take
    run_report(apart, out=page, model=None, json_target=None, run=report)
    process_session(read_session(path), digest, Recipe(), process.stages)


def test_commands_and_recipes_run_the_same_stages(session_file, tmp_path) -> None:
    """`modal`, `report` and `process` of one session, each with a store of its own."""
    stores: list[StageStore] = [NoStore(), NoStore(), StageStore()]
    all_uses(session_file, stores, tmp_path)
    modal, report, process = (sorted(one.computed) for one in stores)
    assert modal == sorted(MODAL_STAGES)
    assert report == process == sorted(MODAL_STAGES + JOINT_STAGES[:2])


def test_a_store_that_is_shared_runs_each_stage_once(session_file, tmp_path) -> None:
    """What `modal` has run is there for `report`, and all of it for `process`."""
    shared = MemoryStore()
    all_uses(session_file, [shared] * 3, tmp_path)
    hits_of_recipe = ["hits"]  # a recipe judges them again, and finds the same
    wanted = MODAL_STAGES + JOINT_STAGES[:2] + hits_of_recipe
    assert sorted(shared.computed) == sorted(wanted)


def test_the_joint_is_one_pipeline_too(session_file, bench, tmp_path) -> None:
    """Surfaces, contact and links of a report are those of a recipe."""
    session, digest = read_session(session_file), file_digest(session_file)
    shared = MemoryStore()
    analysis = analyse_session(session, bench, run=StageRun(shared, digest))
    run = list(shared.computed)
    assert set(run) == {*MODAL_STAGES, *JOINT_STAGES}
    found = process_session(session, digest, recipe_of(bench), shared)
    assert shared.computed == [*run, "hits"]
    assert analysis.contact is not None
    assert found.contact is not None
    kept = found.contact["models"][0]["normal_stiffness"]
    assert kept == analysis.contact.at.state.normal_stiffness


def test_every_store_gives_the_same_numbers(session_file, bench, tmp_path) -> None:
    """None, memory and file, fresh and as kept, known by name or not, to the bit."""
    session = read_session(session_file)
    plain = numbers(analyse_session(session, bench))
    for digest in ("", file_digest(session_file)):
        memory = MemoryStore()
        folder = tmp_path / f"stages{digest}"
        for store, fresh in (
            (memory, True),
            (memory, False),
            (StageStore(folder), True),
            (StageStore(folder), False),
        ):
            before = len(store.computed)
            found = analyse_session(session, bench, run=StageRun(store, digest))
            assert numbers(found) == plain
            assert (len(store.computed) > before) == fresh


def numbers(analysis: SessionAnalysis) -> tuple[object, ...]:
    """Return what can be compared of an analysis."""
    assert analysis.modal is not None
    assert analysis.joint is not None
    assert analysis.contact is not None
    model = analysis.modal.result.model
    return (
        model.natural_frequency.tolist(),
        model.damping_ratio.tolist(),
        model.provenance,
        analysis.surfaces[0].fit.dimension,
        analysis.contact.curve,
        analysis.joint.parameters,
        analysis.remarks,
    )


def test_without_a_store_nothing_is_digested(session_file) -> None:
    """No key is made, as no stage will be requested again."""
    run = StageRun(NoStore())
    run_chain(read_session(session_file).recordings, run=run)
    assert set(run.stages.keys) == set(MODAL_STAGES)
    assert set(run.stages.keys.values()) == {""}


def test_recordings_are_known_by_content_where_no_file_is_named(session_file) -> None:
    """Two sessions with recordings of the same name share nothing."""
    session = read_session(session_file)
    shared = MemoryStore()
    run_chain(session.recordings, run=StageRun(shared))
    other = louder(session)
    fresh = run_chain(other.recordings).frf.response
    assert (
        run_chain(other.recordings, run=StageRun(shared)).frf.response == fresh
    ).all()
    assert not shared.reused


def test_limits_that_change_no_verdict_leave_the_rest_as_kept(session_file) -> None:
    """Hits are judged again; the FRF depends on the verdicts."""
    session, digest = read_session(session_file), file_digest(session_file)
    shared = MemoryStore()
    process_session(session, digest, Recipe(), shared)
    before = len(shared.computed)
    other = Recipe(hits=HitsPart(double_ratio="6 %"))
    found = process_session(session, digest, other, shared)
    assert not found.changes
    assert shared.computed[before:] == ["hits"]


def louder(session: Session) -> Session:
    """The same session, its responses doubled."""
    recording = session.recordings[0]
    samples = recording.samples.copy()
    samples[1] *= 2.0
    return replace(session, recordings=(replace(recording, samples=samples),))


def test_defaults_of_recipes_and_commands_are_the_same_settings() -> None:
    """An empty recipe asks for what no option asks for."""
    assert chain_settings(Recipe()) == ChainSettings()
    off = Recipe(kalman=KalmanPart(use=False))
    assert chain_settings(off) == replace(ChainSettings(), kalman=None)
