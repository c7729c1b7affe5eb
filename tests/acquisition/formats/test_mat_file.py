"""MATLAB files: rows of numbers come in, everything else is refused by name."""

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.formats.mat_file import read_mat_rows

ROW = np.linspace(-1.0, 1.0, 600)


def saved(folder: Path, **variables: Any) -> Path:
    """Write a MAT file, compressed as MATLAB does."""
    path = folder / "record.mat"
    scipy.io.savemat(path, variables, do_compression=True)
    return path


@pytest.mark.parametrize("shape", [(1, 600), (600, 1)])
def test_rows_and_columns_come_in_alike(tmp_path: Path, shape: tuple[int, int]) -> None:
    """MATLAB knows no one-dimensional array."""
    path = saved(tmp_path, u=ROW.reshape(shape), y=np.arange(600))
    u, y = read_mat_rows(path, ["u", "y"])
    assert_array_equal(u, ROW)
    assert_array_equal(y, np.arange(600.0))


@pytest.mark.parametrize(
    ("value", "word"),
    [
        (np.array([{"a": 1}, 2], dtype=object), "cell"),
        ({"a": 1.0}, "struct"),
        ("text", "char"),
        (ROW.reshape(2, 300), "shape"),
        (1j * ROW, "real"),
    ],
)
def test_what_is_no_row_of_numbers_is_refused(
    tmp_path: Path, value: object, word: str
) -> None:
    """Objects are never unpacked."""
    with pytest.raises(FormatError, match=word):
        read_mat_rows(saved(tmp_path, u=value), ["u"])


def test_samples_that_are_not_finite_are_refused(tmp_path: Path) -> None:
    """The line names the sample."""
    row = ROW.copy()
    row[17] = np.nan
    with pytest.raises(BadData, match="sample 17"):
        read_mat_rows(saved(tmp_path, u=row), ["u"])


def test_a_variable_that_is_not_there_is_named_with_those_that_are(
    tmp_path: Path,
) -> None:
    """A typing error is mended at a glance."""
    with pytest.raises(FormatError, match=r"'V1'.*'u'"):
        read_mat_rows(saved(tmp_path, u=ROW), ["V1"])


@pytest.mark.parametrize("size", [0, 100, 300])
def test_a_file_cut_short_is_refused_in_one_line(tmp_path: Path, size: int) -> None:
    """Whatever SciPy makes of it."""
    path = saved(tmp_path, u=ROW)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(BadData, match=r"record\.mat") as caught:
        read_mat_rows(path, ["u"])
    assert "\n" not in str(caught.value)


def test_a_few_bytes_that_unpack_into_gigabytes_are_refused(tmp_path: Path) -> None:
    """The packed element is measured before SciPy sees it."""
    packer = zlib.compressobj()
    zeros = bytes(2**20)
    packed = b"".join(packer.compress(zeros) for _ in range(600)) + packer.flush()
    path = tmp_path / "bomb.mat"
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)
    assert len(packed) < 2**20
    with pytest.raises(HostileFile, match="unpacks"):
        read_mat_rows(path, ["u"])
