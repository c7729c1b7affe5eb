"""Exports of recordings of hours: samples are read as they are written."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.netcdf_write import CHUNK_VALUES
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import new_session
from jointbench.station.files.long_values import LongValues
from jointbench.station.files.netcdf_tables import write_netcdf
from jointbench.station.files.session_tables import session_tables
from jointbench.station.files.table_files import (
    ExportColumn,
    ExportTable,
    write_csv,
    write_mat,
)
from jointbench.station.files.universal_samples import write_universal_samples

COUNT = 2 * CHUNK_VALUES + 3


@pytest.fixture
def asked() -> list[int]:
    """How many samples were asked for at a time."""
    return []


@pytest.fixture
def table(asked: list[int]) -> ExportTable:
    """A table of one long column, half of its index."""

    def read(first: int, past: int) -> FloatArray:
        asked.append(past - first)
        return 0.5 * np.arange(first, past)

    column = ExportColumn("N", LongValues(COUNT, read), ("time",))
    return ExportTable("long", {"force": column})


def test_a_csv_file_is_written_in_pieces(
    table: ExportTable, asked: list[int], tmp_path: Path
) -> None:
    """A row a sample, no more than a chunk of them at a time."""
    (path,) = write_csv(tmp_path / "s", [table])
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "force [N]"
    assert [float(line) for line in lines[1:]] == [0.5 * i for i in range(COUNT)]
    assert max(asked) == CHUNK_VALUES


def test_a_netcdf_file_is_written_in_pieces(
    table: ExportTable, asked: list[int], tmp_path: Path
) -> None:
    """Bit for bit, no more than a chunk at a time."""
    with h5py.File(write_netcdf(tmp_path / "s", table, {})) as file:
        assert np.array_equal(file["force"][()], 0.5 * np.arange(COUNT))
    assert max(asked) == CHUNK_VALUES


def test_a_mat_file_that_cannot_hold_the_samples_is_refused_unread(
    tmp_path: Path,
) -> None:
    """With the format that can."""

    def read(first: int, past: int) -> FloatArray:
        raise AssertionError

    column = ExportColumn("N", LongValues(2**29, read), ("time",))
    with pytest.raises(UsageError, match=r"4\.3 GB .* --to netcdf"):
        write_mat(tmp_path / "s.mat", [ExportTable("long", {"force": column})])


@pytest.mark.parametrize("quantity", Quantity)
def test_a_channel_of_any_quantity_goes_into_a_universal_file(
    quantity: Quantity, tmp_path: Path
) -> None:
    """All its samples, four a row, and the last row shorter."""
    samples = np.arange(7.0)[None] / 3
    recording = Recording("r", samples, 100.0, (Channel("c", quantity),))
    path = tmp_path / "s.uff"
    made = new_session(source="made", simulated=True, recordings=[recording])
    write_universal_samples(path, made)
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = lines[-3:-1]
    assert [len(row) for row in rows] == [80, 60]
    assert np.allclose([float(v) for row in rows for v in row.split()], samples[0])


def test_times_of_a_recording_begin_with_its_start() -> None:
    """In a piece as in the whole."""
    channels = (Channel("c", Quantity.FORCE),)
    recording = Recording("r", np.zeros((1, 9)), 4.0, channels, start_time=2.0)
    made = new_session(source="made", simulated=True, recordings=[recording])
    (found,) = session_tables(made)
    time = found.columns["time"].values
    assert np.asarray(time).tolist() == [2.0 + i / 4 for i in range(9)]
    assert np.asarray(time[4:6]).tolist() == [3.0, 3.25]
