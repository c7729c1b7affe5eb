"""Contact laws of installed packages, through the real commands."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from package_commands import JOINT, LAW_TEXT, PACKAGE, add, content_of, run

from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.results.result_tables import result_texts
from jointbench.station.schemas.recipe import read_recipe


@pytest.mark.usefixtures("example")
def test_contact_predicts_by_the_model_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same stiffness as `ke_3d` without its two elastic-plastic regimes."""
    mine, theirs = tmp_path / "mine.json", tmp_path / "theirs.json"
    assert run(monkeypatch, *JOINT, "--model=two_regimes_3d", "--json", mine) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert f"two_regimes_3d: a model of package {PACKAGE}" in text
    terms = "--without=elastic_plastic_1,elastic_plastic_2"
    assert run(monkeypatch, *JOINT, "--model=ke_3d", terms, "--json", theirs) == 0
    (found,), (known,) = (content_of(p)["models"] for p in (mine, theirs))  # type: ignore[misc]
    assert found["package"] == PACKAGE
    assert known["package"] == "jointbench"
    for key in ("normal_stiffness", "tangential_stiffness", "real_area"):
        assert found[key] == pytest.approx(known[key], rel=1e-12)


@pytest.mark.usefixtures("example")
def test_a_model_without_a_printed_form_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line with the way out."""
    options = ("--model=two_regimes_3d", "--mode=as-printed")
    assert run(monkeypatch, *JOINT, *options) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert "'two_regimes_3d' has no form as printed" in error


def law_of(
    monkeypatch: pytest.MonkeyPatch, folder: Path, factor: float, version: str
) -> None:
    """Install a version of a package with a contact law; it replaces an earlier one."""
    folder.mkdir(parents=True)
    text = LAW_TEXT.format(name="own", factor=factor)
    add(monkeypatch, folder / "law", "contact_laws", ("own", "LAW"), text, version)


@pytest.fixture
def face_file(tmp_path: Path) -> Path:
    """A session of one surface."""
    face = rough_profile(2000, dimension=1.5, roughness=1e-10, spacing=5e-7, seed=3)
    session = Session(
        uuid="0000-1",
        created="2025-03-01T12:00:00+00:00",
        software="jointbench 0.1.0",
        simulated=True,
        surfaces=(replace(face, name="face"),),
    )
    write_session(session, tmp_path / "face.h5")
    return tmp_path / "face.h5"


def test_reprocessing_computes_anew_what_depends_on_a_law_that_changed(
    face_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither a rise of the version nor an edit of the module gives an old number."""
    written = tmp_path / "recipe.toml"
    written.write_text(
        '[contact]\nmodulus = "29 GPa"\nhardness = "1 GPa"\npreload = "20 kN"\n'
        'model = "own"\n',
        encoding="utf-8",
    )
    task = Task(face_file, tmp_path / "face.results.h5", tmp_path / "stages")
    found: dict[str, tuple[float, str, str]] = {}
    for name, factor, version in (
        ("first", 1.0, "1.0"),
        ("same", 1.0, "1.0"),
        ("raised", 1.0, "1.1"),
        ("edited", 2.0, "1.1"),
    ):
        law_of(monkeypatch, tmp_path / name, factor, version)
        outcome = process_task(task, read_recipe(written))
        assert outcome.state is (State.SKIPPED if name == "same" else State.DONE)
        if name in ("raised", "edited"):
            assert outcome.computed == ("contact",)
            assert outcome.reused == ("structure of face", "surface face")
        (model,) = json.loads(result_texts(task.result)["contact"])["models"]
        assert model["package"] == f"added-law {version}"
        found[name] = (model["normal_stiffness"], outcome.key, version)
    assert found["first"][:2] == found["same"][:2]
    assert found["raised"][0] == found["first"][0]
    assert abs(found["edited"][0] / found["first"][0] - 1.0) > 0.1
    assert len({key for _, key, _ in found.values()}) == 3
