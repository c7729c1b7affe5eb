"""The index of results: what is as noted is not opened; anything else is."""

import json
from pathlib import Path

import h5py
import pytest

import jointbench as jb
from jointbench.station.archive import results_index
from jointbench.station.archive.results_index import INDEX_NAME, read_indexed
from jointbench.station.results.results_read import read_result


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A processed session."""
    folder = jb.example("archive", tmp_path_factory.mktemp("indexed"))
    return jb.process(folder / "2025-01" / "20Nm.h5").stored.path


def test_a_result_is_noted_when_it_is_written(
    made: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The table is made without opening the file, with the same numbers."""
    whole = read_result(made)

    def opened(path: Path) -> None:
        raise AssertionError(f"{path} was opened")

    monkeypatch.setattr(results_index, "read_result", opened)
    (found,), refused = read_indexed([made])
    assert not refused
    assert repr(found.quantities) == repr(whole.quantities)
    assert found.facts == whole.facts
    assert (found.key, found.recipe) == (whole.key, whole.recipe)


def test_a_result_that_changed_is_read_again(made: Path, tmp_path: Path) -> None:
    """A copy is another file; a changed number does not match its digest."""
    copy = tmp_path / made.name
    copy.write_bytes(made.read_bytes())
    (tmp_path / INDEX_NAME).write_bytes((made.parent / INDEX_NAME).read_bytes())
    assert read_indexed([copy])[0]
    with h5py.File(copy, "r+") as file:
        file["quantities/value"][0] = 99.0
    found, ((path, reason),) = read_indexed([copy])
    assert not found
    assert path == copy
    assert "corrupted" in reason


def test_a_damaged_index_costs_time_and_nothing_else(
    made: Path, tmp_path: Path
) -> None:
    """Lines that were cut short or changed are passed over, and noted again."""
    copy, index = tmp_path / made.name, tmp_path / INDEX_NAME
    copy.write_bytes(made.read_bytes())
    read_indexed([copy])
    line = json.loads(index.read_text().strip())
    line["quantities"][0][4] = 99.0
    index.write_text(json.dumps(line) + "\n[]\n{}\n" + index.read_text()[:40])
    (found,), _ = read_indexed([copy])
    assert repr(found.quantities) == repr(read_result(copy).quantities)
