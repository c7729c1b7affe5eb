"""Sessions and results written for other programs, and read back."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.samples.universal import read_universal
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.commands.export_command import run_export
from jointbench.station.files.input_files import read_foreign
from jointbench.station.results.result_tables import result_modes, shapes_of
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.recipe import Recipe

pyuff = pytest.importorskip("pyuff")


@pytest.fixture
def result(make_session, tmp_path: Path) -> Path:
    """Process a small session."""
    path = tmp_path / "r.h5"
    process_task(Task(make_session("s.h5"), path), Recipe(name="plain"))
    return path


def exported(path: Path, kind: str) -> dict[str, Path]:
    """Export into a folder of its own; return the files by what follows the stem."""
    folder = path.parent / kind
    written = run_export(path, kind=kind, folder=folder, json_target=None)
    return {one.name.removeprefix(f"{path.stem}."): one for one in written}


def rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file by their heads."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(
    ("kind", "name", "columns", "allowed"),
    [
        ("csv", "stream.csv", "time:s,force:N,acceleration:m/s^2", 0.0),
        ("mat", "mat", "time.time:s,force.force:N,acceleration.a1:m/s^2", 0.0),
        ("uff", "uff", None, 1e-11),
    ],
)
def test_samples_come_back(
    make_session, kind: str, name: str, columns: str | None, allowed: float
) -> None:
    """Bit for bit where the format holds doubles, to 12 digits in universal files."""
    path = make_session("s.h5")
    wanted = read_session(path).recordings[0]
    file = exported(path, kind)[name]
    (found,) = read_foreign(file, SampleOptions(columns))
    assert found.sample_rate == wanted.sample_rate
    assert np.allclose(found.samples, wanted.samples, rtol=allowed, atol=0.0)
    assert [c.quantity for c in found.channels] == [c.quantity for c in wanted.channels]


@pytest.mark.parametrize("kind", ["csv", "mat", "uff"])
def test_an_export_replaces_an_earlier_export_and_nothing_else(
    make_session, tmp_path: Path, kind: str
) -> None:
    """The file that a session was imported from may have the name of its export."""
    path = make_session("s.h5")
    (first,) = exported(path, kind).values()
    before = first.read_bytes()
    assert exported(path, kind)
    assert first.stat().st_size == len(before)
    if kind == "mat":
        scipy.io.savemat(first, {"force": np.arange(3)})
    else:
        first.write_bytes(b"my measurement\r\n")
    mine = first.read_bytes()
    with pytest.raises(UsageError, match="made by no export"):
        exported(path, kind)
    assert first.read_bytes() == mine


@pytest.mark.parametrize("kind", ["mat", "uff"])
def test_an_export_of_a_result_can_be_made_again(result: Path, kind: str) -> None:
    """It is known as ours."""
    assert exported(result, kind).keys() == exported(result, kind).keys()


def test_a_table_of_a_result_has_labels_in_its_heads_and_words_for_verdicts(
    result: Path,
) -> None:
    """One row a mode, with its shape; one row a line, frequency first."""
    files = exported(result, "csv")
    modes = rows(files["modal-0-modes.csv"])
    stored = [q for q in read_result(result).quantities if q.part == "modes"]
    assert [float(row["natural_frequency [Hz]"]) for row in modes] == [
        q.value for q in stored if q.name == "natural_frequency"
    ]
    assert {row["chosen_by"] for row in modes} == {"automatic"}
    assert [row["shape a1@1 re [1]"] for row in modes] == ["1.0"] * len(modes)
    lines = rows(files["modal-0-frf.csv"])
    assert next(iter(lines[0])) == "frequency [Hz]"
    assert "frf a1@1/1 re [m s-2 N-1]" in lines[0]
    assert {row["verdict"] for row in rows(files["hits.csv"])} == {"ok"}
    facts = {row["name"]: row["value"] for row in rows(files["facts.csv"])}
    assert (facts["torque"], facts["specimen"]) == ("20.0", "P1")
    assert json.loads(files["recipe.json"].read_text())["frf"] == {"estimator": "H1"}


def test_variables_of_a_result_keep_their_whole_names(result: Path) -> None:
    """Quantity and standard deviation differ by name; texts keep their rows."""
    content = scipy.io.loadmat(exported(result, "mat")["mat"])
    sd = content["modal_0_modes_natural_frequency_sd"]
    assert sd.size == content["modal_0_modes_natural_frequency"].size
    assert content["modal_0_modes_natural_frequency_sd_unit"] == ["Hz"]
    assert len(content["quantities_word"]) == content["quantities_value"].size


def test_frfs_and_shapes_of_a_result_go_into_a_universal_file(result: Path) -> None:
    """Read by another program: as many functions and modes, the same frequencies."""
    path = exported(result, "uff")["uff"]
    _, frf, modes = result_modes(result)[0]
    file = pyuff.UFF(str(path))
    noise = [frf.coherence, frf.variance]
    assert file.get_set_types().tolist() == [58, 58, 58, *[55] * modes.poles.size]
    read = file.read_sets(0)
    for number, values in enumerate(noise, 1):
        assert np.allclose(file.read_sets(number)["data"], values[0, 0], rtol=1e-11)
    assert np.allclose(read["data"], frf.response[0, 0], rtol=1e-11)
    eigenvalues = [file.read_sets(i + 3)["eig"] for i in range(modes.poles.size)]
    assert np.allclose(eigenvalues, modes.poles, rtol=1e-5)
    with pytest.raises(BadData, match="no time history"):
        read_universal(path, columns=None, point="1")


def test_a_universal_file_of_others_becomes_tables(result: Path) -> None:
    """FRFs on one axis, modes with their nodes: what was written is what is read."""
    path = exported(result, "uff")["uff"]
    _, frf, modes = result_modes(result)[0]
    files = exported(path, "csv")
    assert {"coherence-2.csv", "function_0-3.csv"} <= set(files)
    lines = rows(files["frf-1.csv"])
    axis = [float(line["frequency [Hz]"]) for line in lines]
    assert axis == pytest.approx(frf.frequency, rel=1e-5)
    real = [float(line["1/1 re [m/s^2]"]) for line in lines]
    assert real == pytest.approx(frf.response[0, 0].real, rel=1e-10, abs=1e-30)
    found = rows(files["modes.csv"])
    assert [float(row["natural_frequency [Hz]"]) for row in found] == pytest.approx(
        modes.natural_frequency, rel=1e-5
    )
    assert [float(row["shape z/1 re"]) for row in found] == [1.0] * len(found)
    with pytest.raises(UsageError, match="--to csv or --to mat"):
        run_export(path, kind="uff", folder=None, json_target=None)


def test_the_header_of_a_universal_file_becomes_a_table(make_session) -> None:
    """Data set 151, and both channels of the samples."""
    files = exported(exported(make_session("s.h5"), "uff")["uff"], "csv")
    assert {row["name"] for row in rows(files["header.csv"])} > {"model_name"}
    first = rows(files["time_response.csv"])[0]
    assert next(iter(first)) == "time [s]"
    assert len(first) == 3


def test_shapes_follow_from_residues_of_rank_one() -> None:
    """The outer product of a shape and a participation gives the shape back."""
    shape, participation = np.array([0.5j, 1.0, -0.25]), np.array([2.0, -3.0j])
    residues = np.multiply.outer(shape, participation)[None]
    assert np.allclose(shapes_of(residues), shape[None], rtol=1e-15)


def test_another_format_and_another_file_are_refused(
    make_session, tmp_path: Path
) -> None:
    """One states what exists, the other the kind of file."""
    path = make_session("s.h5")
    with pytest.raises(UsageError, match="csv, mat, netcdf, uff"):
        run_export(path, kind="xlsx", folder=None, json_target=None)
    other = tmp_path / "notes.results.h5"
    other.write_text("notes", encoding="utf-8")
    with pytest.raises(BadData, match="no HDF5"):
        run_export(other, kind="csv", folder=tmp_path / "new", json_target=None)
    assert not (tmp_path / "new").exists()
