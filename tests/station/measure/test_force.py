"""What ``--force`` may replace, and when: an earlier session, by a whole new one."""

import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.file_access.file_lock import hold_lock, is_held
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.overwrite_guard import fresh_path
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.commands.import_command import ImportRequest, run_import
from jointbench.station.commands.record_command import run_record
from jointbench.station.commands.verify_command import run_recover, run_verify
from jointbench.station.main import app, exit_code
from jointbench.station.measure.bench_session import Measured, run_measure

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
START = """
import sys
sys.path[:0] = {path!r}
from jointbench.station.main import run
sys.argv = ["jointbench", *{arguments!r}]
run()
"""


def plan_file(folder: Path, repeats: int = 1) -> Path:
    """Return the example's plan at 12.8 kHz: one point, no trial."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    hits = (
        f'points = ["1"]\ntorques = ["20 N m"]\nrepeats = {repeats}\n'
        f'most_repeats = 30\ntrial_hits = 0\nlength = "0.3 s"\n'
    )
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{hits}\n[joint]{tail}", encoding="utf-8")
    return path


def forced(folder: Path, source: str) -> Measured:
    """Measure over what is at ``s.h5``."""
    return run_measure(
        plan_file(folder),
        folder / "s.h5",
        source=source,
        overwrite=True,
        json_target=None,
    )


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    """Write last week's session."""
    path = tmp_path / "s.h5"
    write_session(new_session(source="last week", simulated=False), path)
    return path


def hits_file(folder: Path) -> Path:
    """Write a table of a hit."""
    path = folder / "hit.csv"
    time = np.arange(400) / 2000.0
    force = 50.0 * np.exp(-(((time - 0.05) / 0.001) ** 2))
    rows = [f"{t},{f},{f}" for t, f in zip(time, force, strict=True)]
    heads = "time [s],force [N],acceleration [m/s^2]"
    path.write_text("\n".join([heads, *rows, ""]), encoding="utf-8")
    return path


def test_a_source_that_does_not_answer_costs_no_earlier_session(earlier: Path) -> None:
    """No server is at port 9; the file is the same to the last byte, and alone."""
    before = earlier.read_bytes()
    with pytest.raises(InstrumentError, match="does not answer"):
        forced(earlier.parent, "ni+grpc://127.0.0.1:9")
    assert earlier.read_bytes() == before
    assert {p.name for p in earlier.parent.iterdir()} == {"s.h5", "plan.toml"}


def test_a_mistyped_source_costs_no_earlier_session(earlier: Path) -> None:
    """It is a usage error, and no more."""
    before = earlier.read_bytes()
    with pytest.raises(UsageError, match="no chassis"):
        forced(earlier.parent, "nj:")
    assert earlier.read_bytes() == before


def test_a_session_that_is_being_recorded_is_not_replaced(earlier: Path) -> None:
    """A second terminal is refused for as long as the lock is held."""
    before = earlier.read_bytes()
    with hold_lock(earlier), pytest.raises(UsageError, match="recorded right now"):
        forced(earlier.parent, "sim:plates")
    assert earlier.read_bytes() == before


def test_a_session_that_came_to_its_end_takes_the_place_of_the_earlier_one(
    earlier: Path,
) -> None:
    """One file is left, the new one; no lock."""
    measured = forced(earlier.parent, "sim:plates")
    assert measured.path == earlier
    assert read_session(earlier).source == "sim:plates"
    assert {p.name for p in earlier.parent.iterdir()} == {"s.h5", "plan.toml"}


@POSIX
def test_a_session_that_was_stopped_leaves_the_earlier_one_and_lies_beside_it(
    earlier: Path,
) -> None:
    """Reported on the screen; both are whole, and no lock is left."""
    before, folder = earlier.read_bytes(), earlier.parent
    plan = plan_file(folder, repeats=30)
    arguments = ["measure", str(plan), "--out", str(earlier), "--force"]
    with started([*arguments, "--source", "sim:plates?speed=4"]) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("hit 2"):
                assert is_held(earlier)
                process.send_signal(signal.SIGTERM)
                break
        said, _ = process.communicate(timeout=300)
    assert process.returncode == 5
    assert "stays as it was" in said
    assert earlier.read_bytes() == before
    assert run_verify(folder / "s.new.h5", json_target=None)
    assert not list(folder.glob("*.lock"))


def started(arguments: list[str]) -> "subprocess.Popen[str]":
    """Start the command line in a process of its own."""
    return subprocess.Popen(
        [
            sys.executable,
            "-u",
            "-c",
            START.format(path=sys.path, arguments=arguments),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


FOREIGN = ("text", "another HDF5 file", "a folder")


def foreign_file(folder: Path, kind: str) -> Path:
    """Put something at ``s.h5`` that no jointbench made."""
    path = folder / "s.h5"
    if kind == "text":
        path.write_text("my thesis", encoding="utf-8")
    elif kind == "a folder":
        path.mkdir()
    else:
        with h5py.File(path, "w") as file:
            file["mine"] = np.arange(3)
    return path


@pytest.mark.parametrize("kind", FOREIGN)
def test_measure_replaces_nothing_that_is_no_session(tmp_path: Path, kind: str) -> None:
    """Somebody else's file stays, whatever its ending."""
    path = foreign_file(tmp_path, kind)
    with pytest.raises(UsageError, match="no session"):
        forced(tmp_path, "sim:plates")
    assert path.exists()


@pytest.mark.parametrize("kind", FOREIGN)
def test_record_replaces_nothing_that_is_no_session(tmp_path: Path, kind: str) -> None:
    """As `measure`."""
    path = foreign_file(tmp_path, kind)
    with pytest.raises(UsageError, match="no session"):
        run_record("sim:two-body?seed=1", path, overwrite=True, json_target=None)
    assert path.exists()


@pytest.mark.parametrize("kind", FOREIGN)
def test_import_replaces_nothing_that_is_no_session(tmp_path: Path, kind: str) -> None:
    """As `measure`; the table is not even read."""
    path = foreign_file(tmp_path, kind)
    with pytest.raises(UsageError, match="no session"):
        run_import(
            [hits_file(tmp_path)],
            path,
            ImportRequest(SampleOptions(), overwrite=True, json_target=None),
        )
    assert path.exists()


def test_import_does_not_replace_a_session_that_is_being_recorded(
    earlier: Path,
) -> None:
    """The samples that a recording has written would be gone with their name."""
    before = earlier.read_bytes()
    table = hits_file(earlier.parent)
    with hold_lock(earlier):
        code = exit_code(
            lambda standalone_mode: app(
                ["import", str(table), "--out", str(earlier), "--force"],
                standalone_mode=standalone_mode,
            ),
            debug=False,
        )
    assert code == 2
    assert earlier.read_bytes() == before


def test_a_file_without_overwrite_that_is_being_recorded_meanwhile_is_kept(
    tmp_path: Path,
) -> None:
    """The lock counts where the file is not there yet, too."""
    path = tmp_path / "s.h5"
    with hold_lock(path), pytest.raises(UsageError, match="being recorded"):
        write_session(new_session(source="x", simulated=True), path, overwrite=True)
    assert not path.exists()


def test_recover_never_writes_over_the_recording_it_reads(tmp_path: Path) -> None:
    """The file itself stays, even with --force."""
    fixture = Path(__file__).parents[2] / "fixtures" / "live-1.h5"
    path = tmp_path / "live.h5"
    path.write_bytes(fixture.read_bytes())
    before = path.read_bytes()
    with pytest.raises(UsageError, match="the input file"):
        run_recover(path, out=path, overwrite=True, json_target=None)
    assert path.read_bytes() == before


def test_a_fresh_name_is_free(tmp_path: Path) -> None:
    """The second new session beside the first has a number."""
    path = tmp_path / "s.h5"
    assert fresh_path(path).name == "s.new.h5"
    fresh_path(path).touch()
    assert fresh_path(path).name == "s.new-2.h5"
