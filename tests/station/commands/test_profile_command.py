"""A roughness tester on a line, into a table or a session."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.records.surfaces import Profile
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.simulators.serial_instruments.dialogue import (
    DiaviteSimulator,
    wave_counts,
)
from jointbench.simulators.serial_instruments.serial_simulator import SerialSimulator
from jointbench.station.sources.read_profile import ProfileRequest, run_profile


def fetch(
    line: str,
    out: Path | None = None,
    *,
    session: Path | None = None,
    instrument: str = "diavite",
    name: str = "face",
    traverse: str | None = "4.8 mm",
) -> Profile:
    """Run the command's own function."""
    wanted = ProfileRequest(instrument, line, name, traverse)
    return run_profile(
        wanted, out=out, session=session, overwrite=False, json_target=None
    )


@pytest.mark.parametrize("instrument", ["diavite", "mitutoyo"])
def test_a_profile_in_a_table_reads_back_as_it_was_measured(
    tmp_path: Path, instrument: str
) -> None:
    """To the picometre that the table keeps, and at the same spacing."""
    out = tmp_path / "face.csv"
    profile = fetch(f"sim:{instrument}?points=500", out, instrument=instrument)
    back = read_surface(out)
    assert isinstance(back, Profile)
    np.testing.assert_allclose(back.heights, profile.heights, atol=1e-12)
    assert back.spacing == pytest.approx(profile.spacing, rel=1e-6)


def test_a_profile_is_added_to_a_session_that_keeps_what_it_had(tmp_path: Path) -> None:
    """The same session by its name, with one surface more."""
    path = tmp_path / "recorded.h5"
    write_session(new_session(source="test", simulated=True, operator="me"), path)
    before = read_session(path)
    profile = fetch("sim:diavite?points=64", session=path)
    after = read_session(path)
    assert (after.uuid, after.operator) == (before.uuid, "me")
    (surface,) = after.surfaces
    np.testing.assert_array_equal(surface.heights, profile.heights)


def test_a_second_profile_of_the_same_name_is_refused_before_it_is_read(
    tmp_path: Path,
) -> None:
    """The line that does not exist is not even opened."""
    path = tmp_path / "recorded.h5"
    write_session(new_session(source="test", simulated=True), path)
    fetch("sim:diavite?points=64", session=path)
    with pytest.raises(UsageError, match="already"):
        fetch("/dev/no-such-line", session=path)


@pytest.mark.parametrize("over_socket", [False, True])
def test_a_plug_removed_mid_profile_leaves_the_points_that_came_in_a_table(
    tmp_path: Path, over_socket: bool
) -> None:
    """1007 bytes hold two answers' frames and 500 whole heights; all 500 are there."""
    counts = wave_counts(900)
    simulator = SerialSimulator(
        DiaviteSimulator(counts).answer, over_socket=over_socket, unplug_after=1007
    )
    with simulator, pytest.raises(InstrumentError, match="500 heights are in"):
        fetch(simulator.name, tmp_path / "face.csv")
    broken = tmp_path / "face.broken.csv"
    heights = np.loadtxt(broken, delimiter=",", skiprows=1)[:, 1]
    np.testing.assert_allclose(heights, np.array(counts[:500]) / 128, atol=1e-6)
    assert not (tmp_path / "face.csv").exists()


def test_a_mitutoyo_that_breaks_off_keeps_the_files_before(tmp_path: Path) -> None:
    """Heights of whole files and of the one that broke off, in a table without x."""
    out = tmp_path / "face.csv"
    with pytest.raises(InstrumentError, match="heights are in"):
        fetch("sim:mitutoyo?points=500&unplug=2400", out, instrument="mitutoyo")
    lines = (tmp_path / "face.broken.csv").read_text().splitlines()
    assert lines[0] == "z [um]"
    # 26 bytes of conditions and count, then files of 6 + 100 x 9 bytes.
    assert 200 < len(lines) - 1 <= 270


def test_the_traverse_of_a_dh8_has_to_be_given(tmp_path: Path) -> None:
    """The error names what to type."""
    with pytest.raises(UsageError, match="--traverse"):
        fetch("sim:diavite", tmp_path / "face.csv", traverse=None)


def test_a_profile_without_a_place_is_refused() -> None:
    """A table or a session."""
    with pytest.raises(UsageError, match="--out"):
        fetch("sim:diavite")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("sim:talysurf", "no serial instrument"),
        ("sim:diavite?point=3", "unknown key"),
        ("sim:diavite?points=many", "give a number"),
    ],
)
def test_a_simulator_that_does_not_exist_is_refused(
    tmp_path: Path, line: str, words: str
) -> None:
    """With what there is."""
    with pytest.raises(UsageError, match=words):
        fetch(line, tmp_path / "face.csv")


def test_a_table_of_ones_own_is_not_replaced_by_a_profile(tmp_path: Path) -> None:
    """With --force an earlier profile is, and nothing else."""
    out = tmp_path / "face.csv"
    wanted = ProfileRequest("diavite", "sim:diavite?points=64", "face", "4.8 mm")
    for _ in range(2):
        run_profile(wanted, out=out, session=None, overwrite=True, json_target=None)
    out.write_text("time,force\n0,1\n", encoding="utf-8")
    with pytest.raises(UsageError, match="made by no profile"):
        run_profile(wanted, out=out, session=None, overwrite=True, json_target=None)
    assert out.read_text(encoding="utf-8") == "time,force\n0,1\n"


def test_points_of_an_earlier_break_are_kept(tmp_path: Path) -> None:
    """The second table of a profile that broke off has a number."""
    for _ in range(2):
        simulator = SerialSimulator(
            DiaviteSimulator(wave_counts(90)).answer, unplug_after=100
        )
        with simulator, pytest.raises(InstrumentError, match="heights are in"):
            fetch(simulator.name, tmp_path / "face.csv")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"face.broken.csv", "face.broken-2.csv"}
