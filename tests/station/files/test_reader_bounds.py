"""Files made to cost time and memory, small: read or refused, and soon.

The whole of it, with the memory that each reader takes: benchmarks/files/bounds.py.
"""

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, HostileFile, JointbenchError
from jointbench.acquisition.file_access.memory_room import (
    ROOM,
    VARIABLE,
    require_room,
    room,
)
from jointbench.acquisition.file_access.text_files import MAX_LINES, text_lines
from jointbench.acquisition.formats.tables import load_table
from jointbench.station.files.toml_file import read_toml
from jointbench.station.files.toml_text import load_toml
from jointbench.station.schemas.geometry_file import Geometry

FOLDER = Path(__file__).parents[3] / "benchmarks" / "files"
SHARE = 0.003
"""Of the full size; files of TOML are small at full size."""
CPU = 3.0
"""[s]"""


def benchmark_modules() -> tuple[Any, Any]:
    """Return the modules of the benchmark that hold files and readers."""
    sys.path.insert(0, str(FOLDER))
    try:
        import costly_files
        import foreign_readers
    finally:
        sys.path.remove(str(FOLDER))
    return costly_files, foreign_readers


COSTLY, FOREIGN = benchmark_modules()


@pytest.mark.parametrize(
    "one", COSTLY.FILES, ids=lambda one: f"{one.reader} {one.words}"
)
@pytest.mark.filterwarnings("ignore")
def test_a_costly_file_is_read_or_refused_soon(one: Any, tmp_path: Path) -> None:
    """Every reader of foreign bytes, each with what costs it most."""
    path = tmp_path / one.name
    one.make(path, 1.0 if one.reader.startswith("TOML") else SHARE)
    begun = time.process_time()
    try:
        FOREIGN.READERS[one.reader](path)
    except JointbenchError as error:
        assert len(str(error).splitlines()) == 1
    assert time.process_time() - begun < CPU


@pytest.mark.parametrize(
    "text",
    ["a" + ".a" * 16 + " = 1", "[" + "a . " * 16 + "a]", "a = " + "[" * 65 + "]" * 65],
)
def test_toml_that_nests_deeper_than_any_model_is_refused(
    text: str, tmp_path: Path
) -> None:
    """Before the parser takes the square of it."""
    path = tmp_path / "m.toml"
    path.write_text(text)
    with pytest.raises(BadData, match="nests so deep"):
        read_toml(path, Geometry)


def test_dots_and_brackets_in_texts_and_comments_are_no_depth(tmp_path: Path) -> None:
    """What TOML holds in quotes nests nothing."""
    path = tmp_path / "m.toml"
    many, deep = "a." * 50, "[" * 100
    path.write_text(
        f"# {many}{deep}\na = \"{many}{deep}\"\nb = '{many}{deep}'\n"
        f'c = """{many}"\n{deep}\\""""\nd = \'\'\'{many}\n{deep}\'\'\'\ne.f = 1.5\n'
    )
    content = load_toml(path)
    assert set(content) == {"a", "b", "c", "d", "e"}


def test_numbers_of_a_byte_that_become_doubles_are_counted_as_doubles(
    tmp_path: Path,
) -> None:
    """15 million bytes would take 360 MB in the making, of 350 and four times 15."""
    path = tmp_path / "h.npy"
    np.save(path, np.zeros((2, 9_000_000), np.int8))
    with pytest.raises(HostileFile, match=f"432 MB.*{VARIABLE}=432"):
        load_table(path)


def test_who_trusts_a_file_may_say_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The way out that the message names works."""
    path = tmp_path / "f"
    path.write_bytes(b"0" * 10)
    assert room(10) == ROOM * 10**6 + 40
    with pytest.raises(HostileFile):
        require_room(path, 500e6)
    monkeypatch.setenv(VARIABLE, "500")
    require_room(path, 500e6)


def test_a_text_of_more_lines_than_measured_values_is_refused() -> None:
    """Each line takes sixty bytes beside its own."""
    with pytest.raises(HostileFile, match="lines"):
        text_lines("\n" * (2 * MAX_LINES), "t.csv")
