"""Results never destroy what they were made from."""

import os
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.acquisition.session_file.store import write_session
from jointbench.station.files.input_files import refuse_twice
from jointbench.station.files.output_paths import (
    check_folder,
    check_outputs,
    write_text,
)


@pytest.fixture
def session(tmp_path: Path) -> Path:
    """Write a small session."""
    heights = np.linspace(0.0, 1e-6, 50)
    profile = Profile("p", heights, 1e-6, all_valid(heights))
    path = tmp_path / "session.h5"
    write_session(new_session(source="test", simulated=True, surfaces=[profile]), path)
    return path


def test_an_input_is_never_an_output(session: Path) -> None:
    """The raw samples would be gone."""
    with pytest.raises(UsageError, match="an input"):
        check_outputs([session], [session])


def test_two_outputs_in_one_file_are_refused(tmp_path: Path) -> None:
    """The second would replace the first."""
    path = tmp_path / "out.html"
    with pytest.raises(UsageError, match="another output"):
        check_outputs([], [path, str(path)])


def test_another_session_is_not_replaced_by_results(session: Path) -> None:
    """Only earlier results may be made again."""
    with pytest.raises(UsageError, match="there already"):
        check_outputs([], [session])


@pytest.mark.parametrize(
    ("name", "content", "kept"),
    [
        ("a.json", "{}", False),
        ("a.json", "my notes", True),
        ("a.html", "<!doctype html>", False),
        ("a.html", "<p>mine</p>", True),
        ("a.csv", "file,input_sha256,session", False),
        ("a.csv", "my,numbers", True),
        ("a.parquet", "PAR1", False),
        ("a.nc", "my notes", True),
    ],
)
def test_a_file_of_another_kind_is_kept(
    name: str, content: str, kept: bool, tmp_path: Path
) -> None:
    """JSON replaces JSON, a page replaces a page, nothing else."""
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    if kept:
        with pytest.raises(UsageError):
            check_outputs([], [path])
    else:
        check_outputs([], [path])


def test_a_missing_folder_is_said_before_the_work(tmp_path: Path) -> None:
    """Not after an hour of it."""
    with pytest.raises(UsageError, match="no folder"):
        check_outputs([], [tmp_path / "gone" / "x.json"])


def test_a_folder_with_foreign_files_is_left_alone(tmp_path: Path) -> None:
    """The demo overwrites its own files only."""
    check_folder(tmp_path / "new", ["own.txt"])
    (tmp_path / "own.txt").touch()
    check_folder(tmp_path, ["own.txt"])
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(UsageError, match=r"thesis\.tex"):
        check_folder(tmp_path, ["own.txt"])


def test_the_same_hits_twice_are_no_repeat(tmp_path: Path) -> None:
    """A copy under another name is found by its content."""
    one, other = tmp_path / "a.csv", tmp_path / "b.csv"
    write_text(one, "1,2,3\n")
    write_text(other, "1,2,3\n")
    with pytest.raises(UsageError, match="same data"):
        refuse_twice([one, other])
    assert not (tmp_path / "a.csv.part").exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_pipe_is_written_to_and_not_replaced(tmp_path: Path) -> None:
    """What reads from a pipe gets the text, and the pipe is still one."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_text(pipe, "42 N/m")
    reported = os.read(reading, 100)
    os.close(reading)
    assert reported == b"42 N/m"
    assert pipe.is_fifo()
