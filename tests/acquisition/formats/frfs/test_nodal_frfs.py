"""FRFs as SDynPy and pyFRF save them, the files made here in their layouts."""

from pathlib import Path

import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.basics.errors import FormatError, UnitError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.records.recordings import Quantity

LINES = np.arange(7) * 0.5
VALUES = np.exp(1j * np.arange(7)) * np.arange(1.0, 8.0)
NODES = np.array([[[101, 101], [101, 205]], [[205, 101], [205, 205]]], np.uint64)
WAYS = np.array([[[3, 3], [3, -1]], [[-1, 3], [-1, -1]]], np.int8)
PAIRS = [
    ("101+z", "101+z"),
    ("101+z", "205-x"),
    ("205-x", "101+z"),
    ("205-x", "205-x"),
]
UNIT = "frf:m/s^2/N"


def records(*, compressed: bool = False) -> dict[str, np.ndarray]:
    """Return the arrays of an .npz that SDynPy saved: two outputs, two inputs."""
    place = np.dtype([("node", "<u8"), ("direction", "i1")])
    fields = [
        ("ordinate", "<c16", (7,)),
        ("comment1", "<U80"),
        ("coordinate", place, (2,)),
    ]
    if not compressed:
        fields.insert(0, ("abscissa", "<f8", (7,)))
    data = np.zeros((2, 2), fields)
    data["ordinate"] = np.arange(1.0, 5.0).reshape(2, 2, 1) * VALUES
    data["coordinate"]["node"], data["coordinate"]["direction"] = NODES, WAYS
    step = {"abscissa_start": np.array(0.0), "abscissa_step": np.array(0.5)}
    if not compressed:
        data["abscissa"] = LINES
    return {"data": data, "function_type": np.array(4)} | (step if compressed else {})


def variables() -> dict[str, object]:
    """Return the variables of a MAT file that SDynPy saved."""
    saved = records()["data"]
    return {
        "abscissa": saved["abscissa"],
        "ordinate": saved["ordinate"],
        "comment1": saved["comment1"],
        "coordinate": {"node": NODES, "direction": WAYS},
    }


def read(path: Path, columns: str | None = UNIT, averages: int = 0):
    """Read the FRFs of a file."""
    return read_frfs(path, FrfOptions(columns, averages=averages))


@pytest.mark.parametrize("layout", ["npz", "compressed", "mat"])
def test_functions_of_sdynpy_keep_their_degrees_of_freedom(tmp_path, layout):
    """Node and direction of both sides name output and input; the unit is stated."""
    path = tmp_path / ("a.mat" if layout == "mat" else "a.npz")
    if layout == "mat":
        scipy.io.savemat(path, variables())
    else:
        np.savez(path, **records(compressed=layout == "compressed"))
    found = read(path)
    assert [(one.output, one.input) for one in found] == PAIRS
    for number, one in enumerate(found, 1):
        np.testing.assert_allclose(one.frequency, LINES)
        np.testing.assert_allclose(one.response, number * VALUES)
        assert one.quantity is Quantity.ACCELERATION


@pytest.mark.parametrize("name", ["a.npz", "a.mat"])
def test_functions_of_sdynpy_state_no_unit(tmp_path, name):
    """The message names the first FRF by its degrees of freedom, and what to type."""
    path = tmp_path / name
    if name == "a.mat":
        scipy.io.savemat(path, variables())
    else:
        np.savez(path, **records())
    with pytest.raises(UnitError, match=r"101\+z / 101\+z.*--columns 'frf:m/s"):
        read(path, None)


def test_functions_of_another_type_are_no_frfs(tmp_path):
    """Coherence has type 6 in SDynPy as in universal files."""
    np.savez(tmp_path / "a.npz", **records() | {"function_type": np.array(6)})
    with pytest.raises(FormatError, match="type 6"):
        read(tmp_path / "a.npz")


def test_arrays_that_lack_a_part_are_named_by_columns(tmp_path):
    """Without nodes the file is one of plain arrays."""
    np.savez(tmp_path / "a.npz", abscissa=LINES, ordinate=VALUES)
    with pytest.raises(UnitError, match="'abscissa', 'ordinate'"):
        read(tmp_path / "a.npz", None)
    columns = "frequency.abscissa:Hz,frf.ordinate:m/N"
    (one,) = read(tmp_path / "a.npz", columns)
    np.testing.assert_allclose(one.response, VALUES)


def test_a_line_at_0_hz_without_a_number_is_left_out(tmp_path):
    """PyFRF divides by the frequency; any other line must be a number."""
    holed = np.where(LINES == 0.0, np.nan, VALUES)
    np.savez(tmp_path / "a.npz", f=LINES, H=holed, c=np.full(7, 0.9))
    columns = "frequency.f:Hz,frf.H:m/s^2/N,coherence.c"
    (one,) = read(tmp_path / "a.npz", columns)
    np.testing.assert_allclose(one.frequency, LINES[1:])
    np.testing.assert_allclose(one.response, VALUES[1:])
    assert one.coherence is not None and one.coherence.shape == (6,)
    assert [done.name for done in one.provenance] == ["read_frf", "leave_out_line"]


def test_an_array_of_objects_is_refused_with_its_reason(tmp_path):
    """Frequencies and FRFs of unequal shapes in one array: reading runs code."""
    pair = np.empty(2, object)
    pair[0], pair[1] = LINES, np.stack([VALUES, VALUES])
    np.save(tmp_path / "a.npy", pair, allow_pickle=True)
    with pytest.raises(FormatError, match="Python objects"):
        read(tmp_path / "a.npy", "frf:m/s^2/N@0.5Hz")
