"""Files and words that a command cannot use are refused with the way out."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.commands.import_command import ImportRequest, run_import
from jointbench.station.files.archive_patterns import (
    archive_files,
    result_files,
    session_files,
)
from jointbench.station.files.toml_file import read_toml
from jointbench.station.files.typed_values import parse_point
from jointbench.station.gap.surface_gap import examine_surface
from jointbench.station.schemas.recipe import Recipe


def test_a_copy_of_a_file_is_not_imported_as_a_second_hit(tmp_path: Path) -> None:
    """Under its own name or another; nothing is written."""
    one, other = tmp_path / "a.csv", tmp_path / "b.csv"
    for path in (one, other):
        path.write_text("Time [s],Force [N]\n0,1\n1,2\n", encoding="ascii")
    for files in ([one, other], [one, one]):
        with pytest.raises(UsageError, match="same data"):
            run_import(files, tmp_path / "s.h5", ImportRequest())
    assert not (tmp_path / "s.h5").exists()


@pytest.mark.parametrize("name", ["", " "])
def test_an_empty_point_is_refused(name: str) -> None:
    """A hit at no point looks like one whose point is not known."""
    with pytest.raises(UsageError, match="give the name of the hit point"):
        parse_point(name)


@pytest.mark.parametrize("name", ["gone", "gone/*.h5", "gone/**/*.h5"])
def test_a_missing_folder_of_an_archive_is_named(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The path is wrong, not the kind of file in it."""
    monkeypatch.chdir(tmp_path)
    for files_of in (result_files, session_files, lambda p: archive_files(p, ())):
        with pytest.raises(UsageError, match=r"there is no .*gone'; check the path"):
            files_of([name])


def test_a_file_that_is_no_toml_is_refused_with_place_and_remedy(
    tmp_path: Path,
) -> None:
    """A table in the place of a model, and one that is not UTF-8."""
    path = tmp_path / "hits.csv"
    for data, place in ((b"1;2;3\n", "line 1"), (b"Weg [\xb5m]\n", "byte 6")):
        path.write_bytes(data)
        with pytest.raises(BadData, match=f"not a TOML file .*{place}.*in its place"):
            read_toml(path, Recipe)


def test_missing_heights_of_a_surface_are_stated_beside_its_verdict(
    tmp_path: Path,
) -> None:
    """What is interpolated or left out is not passed over in silence."""
    heights = np.random.default_rng(3).normal(size=256).cumsum() * 0.1
    heights[100] = np.nan
    path = tmp_path / "part.csv"
    rows = [f"{0.5 * k},{z:.5f}" for k, z in enumerate(heights)]
    path.write_text("\n".join(["x [um],z [um]", *rows, ""]), encoding="ascii")
    remarks = examine_surface([path], without=frozenset(), progress=print)[1]
    assert remarks[-1].startswith("part: 1 of 256 heights are missing")
