"""FRFs in tables, arrays and MAT files."""

import io
import struct
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    UnitError,
    UsageError,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.records.recordings import Quantity

LINES = np.arange(6) * 2.0
VALUES = np.exp(1j * np.arange(6)) * np.arange(1.0, 7.0)
TABLE = "frequency:Hz,real:m/s^2/N,imaginary:m/s^2/N"
ARRAYS = "frequency.f:Hz,frf.H:m/N"


def text_of(*columns: np.ndarray, head: str = "") -> str:
    """Return columns as text, one row a line."""
    rows = "\n".join(" ".join(f"{v:.12e}" for v in row) for row in np.array(columns).T)
    return f"{head}{rows}\n"


def struct_of_testlab(
    values: np.ndarray = VALUES, label: str = "m/s^2/N", factor: float = 1.0
):
    """Return a struct as Simcenter Testlab exports one."""
    quantity = {"label": label, "unit_transformation": {"factor": factor}}
    return {
        "x_values": {
            "start_value": 0.0,
            "increment": 2.0,
            "number_of_values": 6.0,
            "quantity": {"label": "Hz"},
        },
        "y_values": {"values": values.reshape(-1, 1), "quantity": quantity},
        "function_record": {
            "name": "FRF",
            "primary_channel": {"name": "plate:2:+Z"},
            "reference_channel": {"name": "plate:1:+Z"},
        },
    }


def write_v73(path: Path, content: dict) -> None:
    """Write nested dictionaries as `save -v7.3` does, with its 512 bytes in front."""
    pair = np.dtype([("real", "<f8"), ("imag", "<f8")])

    def put(group: h5py.Group, name: str, value: object) -> None:
        if isinstance(value, dict):
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_("struct")
            names = np.empty(1, object)
            names[0] = np.array([b"a"], "S1")
            inner.attrs.create("MATLAB_fields", names, dtype=h5py.vlen_dtype("S1"))
            for key, item in value.items():
                put(inner, key, item)
        elif isinstance(value, str):
            codes = group.create_dataset(
                name, data=np.array([[ord(c)] for c in value], np.uint16)
            )
            codes.attrs["MATLAB_class"] = np.bytes_("char")
        else:
            array = np.atleast_2d(np.asarray(value)).T
            if np.iscomplexobj(array):
                packed = np.empty(array.shape, pair)
                packed["real"], packed["imag"] = array.real, array.imag
                array = packed
            group.create_dataset(name, data=array)

    with h5py.File(path, "w", userblock_size=512) as file:
        for key, item in content.items():
            put(file, key, item)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def read(path: Path, columns: str | None = None, **more):
    """Read the FRFs of a file."""
    return read_frfs(path, FrfOptions(columns, **more))


@pytest.mark.parametrize(
    ("columns", "values"),
    [
        (TABLE, (VALUES.real, VALUES.imag)),
        (
            "frequency:Hz,magnitude:m/s^2/N,phase:deg",
            (np.abs(VALUES), np.degrees(np.angle(VALUES))),
        ),
        (
            "frequency:Hz,magnitude:dB re m/s^2/N,phase:rad",
            (20 * np.log10(np.abs(VALUES)), np.angle(VALUES)),
        ),
    ],
    ids=["real", "degrees", "decibel"],
)
def test_a_table_of_two_columns_an_frf_is_read(tmp_path, columns, values):
    """Real and imaginary, magnitude and phase, and decibels give the same numbers."""
    path = tmp_path / "a.txt"
    path.write_text(text_of(LINES, *values))
    (frf,) = read(path, columns)
    np.testing.assert_allclose(frf.response, VALUES, rtol=1e-9)
    assert frf.quantity is Quantity.ACCELERATION


def test_a_table_holds_several_frfs_with_noise_named_by_their_degrees(tmp_path):
    """Labels are output/input; sd squared is the variance, in SI."""
    path = tmp_path / "a.txt"
    sd = np.full(6, 0.1)
    path.write_text(text_of(LINES, VALUES.real, VALUES.imag, sd, sd, VALUES.real))
    spec = (
        "frequency:Hz,real.2z/1z:mm/N,imaginary.2z/1z:mm/N,sd.2z/1z:mm/N,"
        "imaginary.3z/1z:mm/N,real.3z/1z:mm/N"
    )
    one, other = read(path, spec)
    assert [(f.output, f.input) for f in (one, other)] == [("2z", "1z"), ("3z", "1z")]
    np.testing.assert_allclose(one.variance, 1e-8, rtol=1e-12)
    assert other.variance is None


def test_a_header_with_units_does_without_columns(tmp_path):
    """The heading states role and unit; without a unit the table is left alone."""
    path = tmp_path / "a.csv"
    rows = text_of(LINES, VALUES.real, VALUES.imag).replace(" ", ",")
    path.write_text("Frequency [Hz],Real [m/N],Imag [m/N]\n" + rows)
    (frf,) = read(path)
    assert frf.quantity is Quantity.DISPLACEMENT
    path.write_text("Frequency [Hz],Real,Imag\n" + rows)
    assert read(path) == ()


def test_a_list_of_complex_numbers_needs_the_distance_of_its_lines(tmp_path):
    """One number a line, as NumPy prints it."""
    path = tmp_path / "a.txt"
    path.write_text("\n".join(map(str, VALUES)))
    (frf,) = read(path, "frf:m/s/N@2Hz")
    np.testing.assert_allclose(frf.frequency, LINES)
    np.testing.assert_allclose(frf.response, VALUES)
    with pytest.raises(UsageError, match="@1Hz"):
        read(path, "frf:m/s/N")


@pytest.mark.parametrize(
    ("spec", "error", "words"),
    [
        ("frequency:Hz,real:N,imaginary:N", UnitError, "motion over a force"),
        ("frequency:Hz,real,imaginary:m/N", UnitError, "no unit is given"),
        ("frequency:Hz,rael:m/N,imaginary:m/N", UsageError, "did you mean 'real'"),
        ("frequency:Hz,real:m/N,phase:deg", UsageError, "real and imaginary"),
        ("frequency:Hz,real:m/N,imaginary:g/N", UnitError, "one quantity"),
        ("frequency:Hz,real:m/N", FormatError, "3 columns"),
        ("frequency:s,real:m/N,imaginary:m/N", UnitError, "frequency"),
    ],
)
def test_columns_that_do_not_fit_say_what_to_type(tmp_path, spec, error, words):
    """Unknown roles, half FRFs, wrong units."""
    path = tmp_path / "a.txt"
    path.write_text(text_of(LINES, VALUES.real, VALUES.imag))
    with pytest.raises(error, match=words):
        read(path, spec)


def test_missing_and_infinite_values_of_a_table_are_refused(tmp_path):
    """A cell without a number is named by its frequency."""
    path = tmp_path / "a.txt"
    holed = np.where(np.arange(6) == 2, np.nan, VALUES.imag)
    path.write_text(text_of(LINES, VALUES.real, holed))
    with pytest.raises(BadData, match="at 4 Hz"):
        read(path, TABLE)


@pytest.mark.parametrize("first", [False, True], ids=["last", "first"])
def test_an_archive_of_arrays_gives_a_matrix(tmp_path, first):
    """Lines on the last or the first axis; outputs and inputs are numbered."""
    path = tmp_path / "a.npz"
    cube = np.arange(1.0, 7.0).reshape(3, 2, 1) * VALUES
    np.savez(path, f=LINES, H=np.moveaxis(cube, -1, 0) if first else cube)
    found = read(path, ARRAYS)
    assert [(f.output, f.input) for f in found][:3] == [
        ("1", "1"),
        ("1", "2"),
        ("2", "1"),
    ]
    np.testing.assert_allclose(found[-1].response, 6.0 * VALUES)
    with pytest.raises(UnitError, match="'f', 'H'"):
        read(path)


def test_a_complex_npy_array_is_an_frf_and_a_real_one_a_table(tmp_path):
    """The type of the array decides."""
    np.save(tmp_path / "a.npy", np.stack([VALUES, 2.0 * VALUES]))
    found = read(tmp_path / "a.npy", "frf:g/N@2Hz")
    np.testing.assert_allclose(found[1].response, 2.0 * 9.80665 * VALUES)
    np.save(tmp_path / "b.npy", np.stack([LINES, VALUES.real, VALUES.imag]))
    (frf,) = read(tmp_path / "b.npy", TABLE)
    np.testing.assert_allclose(frf.response, VALUES)
    assert read(tmp_path / "b.npy") == ()


def npy_header(shape: str, kind: str = "<f8") -> bytes:
    """Return the header of a .npy file."""
    words = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    padded = words.encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(padded)) + padded


@pytest.mark.parametrize(
    ("entry", "error"),
    [
        (npy_header("(10000000000,)") + bytes(8), FormatError),
        (npy_header("(1,)", "|O") + bytes(8), FormatError),
        (b"no array", FormatError),
    ],
    ids=["claim", "objects", "other"],
)
def test_a_hostile_archive_is_refused(tmp_path, entry, error):
    """Shapes are compared with the bytes; objects are never unpickled."""
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("f.npy", entry)
    with pytest.raises(error, match=r"a\.npz"):
        read(path, ARRAYS)


def test_an_archive_that_unfolds_into_gigabytes_is_refused_unread(tmp_path):
    """The sizes in the directory of the zip are added up first."""
    path, zeros = tmp_path / "a.npz", io.BytesIO(bytes(2**20))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for number in range(200):
            archive.writestr(f"{number}.npy", zeros.getvalue())
    with pytest.raises(HostileFile):
        read(path, ARRAYS)


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_structs_of_testlab_are_read_from_both_versions(tmp_path, version):
    """Axis, unit and channels come from the struct, coherence from its neighbour."""
    path = tmp_path / "a.mat"
    coherence = struct_of_testlab(np.linspace(0.5, 1.0, 6), "")
    coherence["function_record"]["name"] = "Coherence"
    content = {"FRF_2_1": struct_of_testlab(label="g/N"), "C_2_1": coherence}
    if version == "5":
        scipy.io.savemat(path, content)
    else:
        write_v73(path, content)
    (frf,) = read(path)
    assert (frf.output, frf.input) == ("plate:2:+Z", "plate:1:+Z")
    np.testing.assert_allclose(frf.response, 9.80665 * VALUES)
    np.testing.assert_allclose(frf.frequency, LINES)
    np.testing.assert_allclose(frf.coherence, np.linspace(0.5, 1.0, 6))


def test_a_display_unit_with_a_factor_is_asked_for(tmp_path):
    """Whether the numbers have the label's unit is not stated: the user does."""
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"FRF": struct_of_testlab(label="g/N", factor=0.10197)})
    with pytest.raises(UnitError, match=r"factor of 0\.10197"):
        read(path)
    (frf,) = read(path, "frf:m/s^2/N")
    np.testing.assert_allclose(frf.response, VALUES)


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_plain_variables_are_named_by_columns(tmp_path, version):
    """Frequencies and a matrix, in any version."""
    path = tmp_path / "a.mat"
    content = {"f": LINES, "H": np.stack([VALUES, 3.0 * VALUES])}
    if version == "5":
        scipy.io.savemat(path, content)
    else:
        write_v73(path, content)
    found = read(path, ARRAYS)
    np.testing.assert_allclose(found[1].response, 3.0 * VALUES)
    assert read(path) == ()


def test_time_histories_of_testlab_are_no_frfs(tmp_path):
    """Real values over seconds are left to the readers of samples."""
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"Signal": struct_of_testlab(VALUES.real, "g")})
    assert read(path) == ()


def test_a_struct_nested_without_end_is_refused(tmp_path):
    """Twelve levels are more than any export has."""
    nested: object = 1.0
    for _ in range(40):
        nested = {"a": nested}
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"FRF": nested})
    with pytest.raises(HostileFile, match="nested"):
        read(path, ARRAYS)


def test_a_cut_mat_file_is_one_line(tmp_path):
    """The message names the file, whatever the version."""
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"FRF": struct_of_testlab()})
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(BadData, match=r"a\.mat"):
        read(path, ARRAYS)
    write_v73(path, {"FRF": struct_of_testlab()})
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(BadData, match=r"a\.mat"):
        read(path, ARRAYS)
