"""Example data: every set is whole, is written out once, and is made by its script."""

from pathlib import Path

import numpy as np
import pytest
from make_examples import MAKERS, make_surfaces

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.examples.example_sets import EXAMPLES, FOLDER, write_example

MOST_BYTES = 2_000_000
"""Of all data sets together: they come with every installation."""


@pytest.mark.parametrize("name", [one.name for one in EXAMPLES])
def test_an_example_is_written_with_its_readme(name: str, tmp_path: Path) -> None:
    """Sessions can be opened; the folder is called after the example."""
    folder = write_example(name, tmp_path / name)
    assert (folder / "README.md").read_text(encoding="utf-8").startswith("# ")
    for path in folder.rglob("*.h5"):
        assert read_session(path).recordings


def test_the_examples_are_small_and_every_folder_is_one() -> None:
    """A folder that no set names would be shipped and never be written out."""
    folders = {path.name for path in FOLDER.iterdir() if path.is_dir()}
    assert folders - {"__pycache__"} == {one.name for one in EXAMPLES}
    data = [p for p in FOLDER.rglob("*") if p.is_file() and p.suffix != ".pyc"]
    assert sum(p.stat().st_size for p in data) < MOST_BYTES
    assert MAKERS.keys() <= folders


def test_files_that_are_there_are_kept(tmp_path: Path) -> None:
    """The error names the file and the way out; --force overwrites."""
    write_example("torques", tmp_path)
    with pytest.raises(UsageError, match=r"README\.md.* exists already.*--force"):
        write_example("torques", tmp_path)
    assert write_example("torques", tmp_path, overwrite=True) == tmp_path


def test_a_wrong_name_is_answered_with_the_nearest(tmp_path: Path) -> None:
    """From the library as well; without a near one all are listed."""
    with pytest.raises(UsageError, match="did you mean 'joint'"):
        jb.example("joints", tmp_path)
    with pytest.raises(UsageError, match="there are hits, joint"):
        jb.example("xyz", tmp_path)


def test_the_maker_makes_the_same_surfaces_again(tmp_path: Path) -> None:
    """Fixed seeds: what is shipped is what the simulators make."""
    make_surfaces(tmp_path)
    for path in sorted(tmp_path.iterdir()):
        if path.name.startswith("face"):
            made, shipped = (
                np.loadtxt(p, delimiter=",", skiprows=1)
                for p in (path, FOLDER / "surfaces" / path.name)
            )
            # Another FFT may round the last digit of a nanometre otherwise.
            np.testing.assert_allclose(made, shipped, atol=2e-4)
