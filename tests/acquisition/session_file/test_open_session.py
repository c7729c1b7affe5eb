"""Sessions whose samples stay in their file."""

import gc
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.records.stored_samples import StoredSamples, remembered
from jointbench.acquisition.session_file import open_session as opening
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.acquisition.session_file.store import read_session, write_session

CHANNELS = (
    Channel("force", Quantity.FORCE, point="1"),
    Channel("a1", Quantity.ACCELERATION, point="1"),
    Channel("a2", Quantity.ACCELERATION, point="2"),
)
LONG, SHORT = 150_001, 301
"""Samples: three chunks a channel, and one chunk of all channels."""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A session with a long and a short recording."""
    folder = tmp_path_factory.mktemp("stored")
    rng = np.random.default_rng(5)
    made = [
        Recording(name, rng.standard_normal((3, count)), 1000.0, CHANNELS)
        for name, count in (("long", LONG), ("short", SHORT))
    ]
    session = new_session(source="made", simulated=True, recordings=made)
    write_session(session, folder / "s.h5")
    return folder / "s.h5"


@pytest.mark.parametrize(
    "key",
    [
        (slice(None), slice(65_530, 131_080)),
        (2, slice(100, 200)),
        ([0, 2], slice(65_536, None)),
        (-1, slice(-5, None)),
        1,
        slice(1, 3),
        (0, 70_000),
        (1, slice(10, 500, 7)),
        (slice(None), slice(20, 10)),
    ],
)
def test_a_part_is_that_of_the_whole(path: Path, key: object) -> None:
    """Rows, lists of rows and spans across chunks, bit for bit."""
    stored = open_session(path, most_whole=0).recordings[0].samples
    assert isinstance(stored, StoredSamples)
    whole = np.asarray(read_session(path).recordings[0].samples)
    np.testing.assert_array_equal(stored[key], whole[key])


def test_recordings_are_those_of_a_session_read_at_once(path: Path) -> None:
    """Names, rates, channels and all samples, also of a chunk of several channels."""
    one, other = open_session(path, most_whole=0), read_session(path)
    for lazy, whole in zip(one.recordings, other.recordings, strict=True):
        assert (lazy.name, lazy.channels) == (whole.name, whole.channels)
        assert lazy.samples.shape == whole.samples.shape
        assert lazy.samples.size == whole.samples.size
        np.testing.assert_array_equal(np.asarray(lazy.samples), whole.samples)
        np.testing.assert_array_equal(np.array(list(lazy.samples)), whole.samples)


def test_a_small_session_is_read_at_once(path: Path) -> None:
    """Reading in parts begins where memory matters."""
    assert isinstance(open_session(path).recordings[0].samples, np.ndarray)


def test_what_is_kept_has_a_limit(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With room for one chunk the values are the same."""
    monkeypatch.setattr(opening, "_MOST_KEPT", 1)
    samples = open_session(path, most_whole=0).recordings[0].samples
    whole = read_session(path).recordings[0].samples
    np.testing.assert_array_equal(samples[:, 1000:140_000], whole[:, 1000:140_000])


def test_the_file_is_closed_with_its_last_recording(path: Path, tmp_path: Path) -> None:
    """It can be written to afterwards."""
    path = Path(shutil.copy(path, tmp_path))
    samples = open_session(path, most_whole=0).recordings[1].samples
    assert samples[0, 0] == read_session(path).recordings[1].samples[0, 0]
    del samples
    gc.collect()
    with h5py.File(path, "r+") as file:
        file.attrs["checked"] = 1


def test_a_damaged_sample_is_one_line_with_the_name_of_the_file(
    path: Path, tmp_path: Path
) -> None:
    """The session opens; the access that meets the value does not pass."""
    path = Path(shutil.copy(path, tmp_path))
    with h5py.File(path, "r+") as file:
        file["stream/long/samples"][1, 140_000] = np.nan
    samples = open_session(path, most_whole=0).recordings[0].samples
    assert samples[1, :1000].shape == (1000,)
    with pytest.raises(FormatError, match="not finite"):
        samples[1, 139_000:]


def test_what_was_computed_from_stored_samples_is_remembered(path: Path) -> None:
    """Once for each argument; an array in memory is computed from each time."""
    calls = []

    @remembered
    def largest(recording: Recording, row: int) -> float:
        calls.append(row)
        return float(recording.samples[row].max())

    stored, whole = open_session(path, most_whole=0), read_session(path)
    for row in (0, 1, 0, 1):
        assert largest(stored.recordings[0], row) == largest(whole.recordings[0], row)
    assert sorted(calls) == [0, 0, 0, 1, 1, 1]
