"""The provenance of a result, and the folder with which it is run again."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import jointbench as jb
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.files.computing_environment import computing_environment
from jointbench.station.provenance.provenance_command import run_provenance
from jointbench.station.provenance.rerun_folder import write_rerun
from jointbench.station.provenance.result_provenance import result_provenance
from jointbench.station.results.results_file import write_results
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.stored_recipe import read_stored_recipe

RECIPE = 'name = "narrow"\n[modes]\nband = ["100 Hz", "500 Hz"]\n'


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result of an example session whose plan states a sensor, beside it."""
    folder = jb.example("archive", tmp_path_factory.mktemp("made"))
    session = read_session(folder / "2025-01" / "20Nm.h5")
    sensor = step(
        "sensor",
        name="force",
        quantity="force",
        serial="41230",
        certificate="D-K-1",
        calibrated="2026-03-02",
        due="2027-03-02",
        sensitivity_sd=0.005,
    )
    path = folder / "s.h5"
    write_session(replace(session, provenance=(*session.provenance, sensor)), path)
    recipe = folder / "recipe.toml"
    recipe.write_text(RECIPE)
    return jb.process(path, recipe).stored.path


def test_a_result_states_build_versions_and_sensors(result: Path) -> None:
    """Nothing that names the computer, its user or a folder."""
    found = result_provenance(result)
    assert found.environment == dict(computing_environment())
    assert len(found.environment["build_sha256"]) == 64
    assert found.environment["numpy"] == np.__version__
    (sensor,) = found.sensors
    assert sensor["certificate"] == "D-K-1"
    assert sensor["sensitivity_sd"] == 0.005
    text = json.dumps(found.as_json())
    assert str(result.parent) not in text
    assert str(Path.home()) not in text


def test_the_contributions_add_up_to_each_standard_deviation(result: Path) -> None:
    """Variances of scatter and model error add up; so do their shares."""
    found = result_provenance(result)
    for one in found.result.quantities:
        rows = [r for r in found.budget if r.value == one.value and r.unit == one.unit]
        if np.isfinite(one.sd) and rows:
            assert sum(r.sd**2 for r in rows) == pytest.approx(one.sd**2)
            assert sum(r.share for r in rows) == pytest.approx(1.0)
    contributions = {row.contribution for row in found.budget}
    assert len(contributions) == 2


def test_a_result_is_run_again_from_its_folder(result: Path, tmp_path: Path) -> None:
    """The same key, and the same numbers to the last bit."""
    write_rerun(result_provenance(result), tmp_path / "again", overwrite=False)
    folder = tmp_path / "again"
    again = jb.process(folder / "s.h5", folder / "recipe.json").stored
    first = read_result(result)
    assert again.key == first.key
    assert repr(again.quantities) == repr(first.quantities)
    assert "numpy==" in (folder / "requirements.txt").read_text()
    rows = list(csv.DictReader((folder / "uncertainty.csv").read_text().splitlines()))
    assert rows[0]["unit"] == "Hz"


def test_what_cannot_be_run_again_is_said(
    result: Path, tmp_path: Path, make_results: Callable[[Path], Path]
) -> None:
    """A session that changed or is away; a result of `modal`; a folder in use."""
    alone = tmp_path / result.name
    alone.write_bytes(result.read_bytes())
    found = result_provenance(alone)
    assert found.session is None
    with pytest.raises(UsageError, match=r"'s\.h5' does not lie beside"):
        write_rerun(found, tmp_path / "again", overwrite=False)
    with pytest.raises(UsageError, match="holds no recipe"):
        own = result_provenance(make_results(tmp_path))
        write_rerun(own, tmp_path / "again", overwrite=False)
    with pytest.raises(UsageError, match="is not empty"):
        write_rerun(result_provenance(result), tmp_path, overwrite=False)


@pytest.fixture
def make_results() -> Callable[[Path], Path]:
    """Return a function that writes the results of `modal`, without a recipe."""

    def make(folder: Path) -> Path:
        files = sorted(jb.example("hits", folder / "hits").glob("*.csv"))
        write_results(folder / "m.results.h5", jb.modes(files[:1]).chain, files[:1])
        return folder / "m.results.h5"

    return make


def test_a_stored_recipe_that_is_none_is_refused(tmp_path: Path) -> None:
    """One line with the way out."""
    path = tmp_path / "recipe.json"
    for text in ("[]", "{}", '{"schema": "x"}', "no json"):
        path.write_text(text)
        with pytest.raises(BadData):
            read_stored_recipe(path)


def test_the_command_shows_all_of_it(
    result: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Facts, sensors and budget on the terminal; the folder and JSON on request."""
    target = tmp_path / "p.json"
    run_provenance(
        result, folder=tmp_path / "x", overwrite=False, json_target=str(target)
    )
    shown = capsys.readouterr().out
    for words in ("build_sha256", "D-K-1", "scatter of the hits", "not included"):
        assert words in shown
    assert json.loads(target.read_text())["schema"] == "jointbench-provenance/1"
