"""FRFs in universal files, written here byte by byte."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError, UnitError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.records.recordings import Quantity

LINES = 8
VALUES = np.exp(1j * np.arange(LINES)) * np.linspace(1.0, 3.0, LINES)
EDGE = b"    -1\n"
COMPLEX_SINGLE, COMPLEX_DOUBLE, REAL_SINGLE = 5, 6, 2


def data_set(
    values: np.ndarray = VALUES,
    *,
    function: int = 4,
    kind: int = COMPLEX_DOUBLE,
    units: tuple[str, str] = ("m/s^2", "N"),
    place: tuple[int, int, int, int] = (2, 3, 1, -3),
    even: bool = True,
    binary: bool = False,
    step: float = 0.5,
    abscissa: str = "Hz",
) -> bytes:
    """Return one data set 58: identification, header, four axes, values."""
    node, way, own, back = place
    head = "    58"
    flat = np.column_stack([values.real, values.imag]).ravel()
    data = flat if kind != REAL_SINGLE else values.real
    if binary:
        packed = data.astype("<f8" if kind == COMPLEX_DOUBLE else "<f4").tobytes()
        head = (
            f"    58b{1:6d}{2:6d}{11:12d}{len(packed):12d}"
            + f"{0:6d}{0:6d}"
            + (f"{0:12d}{0:12d}")
        )
    lines = [head, "a1", "NONE", "22-Nov-26 10:00:00", "NONE", "NONE"]
    lines.append(
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{node:10d}{way:4d}"
        f" {'NONE':10s}{own:10d}{back:4d}"
    )
    lines.append(
        f"{kind:10d}{values.size:10d}{int(even):10d}{0.0:13.5e}"
        f"{step if even else 0.0:13.5e}{0.0:13.5e}"
    )
    for code, name, unit in (
        (18, "Frequency", abscissa),
        (12, "Acceleration", units[0]),
        (13, "Force", units[1]),
        (0, "NONE", "NONE"),
    ):
        lines.append(f"{code:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}")
    text = "\n".join(lines).encode("latin-1") + b"\n"
    if binary:
        return EDGE + text + packed + b"\n" + EDGE
    wide = kind == COMPLEX_DOUBLE
    cells = [f"{v:20.11e}" if wide else f"{v:13.5e}" for v in data]
    width = 4 if wide else 6
    if not even:
        x = [f"{step * i:13.5e}" for i in range(values.size)]
        pairs = zip(x, cells[::2], cells[1::2], strict=True)
        cells, width = ["".join(pair) for pair in pairs], 1
    rows = ["".join(cells[i : i + width]) for i in range(0, len(cells), width)]
    return EDGE + text + ("\n".join(rows) + "\n").encode() + EDGE


def read(path: Path, data: bytes, columns: str | None = None):
    """Write a file and read its FRFs."""
    path.write_bytes(data)
    return read_frfs(path, FrfOptions(columns))


@pytest.mark.parametrize(
    ("how", "digits"),
    [
        ({}, 1e-11),
        ({"kind": COMPLEX_SINGLE}, 1e-5),
        ({"even": False}, 1e-11),
        ({"binary": True}, 0.0),
        ({"binary": True, "kind": COMPLEX_SINGLE}, 1e-7),
    ],
    ids=["double", "single", "uneven", "binary-double", "binary-single"],
)
def test_an_frf_of_any_precision_is_read_with_its_degrees_of_freedom(
    tmp_path, how, digits
):
    """Values to the printed digits, lines in Hz, node and direction as labels."""
    (frf,) = read(tmp_path / "a.uff", data_set(**how))
    np.testing.assert_allclose(frf.response, VALUES, rtol=2 * digits, atol=digits)
    np.testing.assert_allclose(frf.frequency, 0.5 * np.arange(LINES), rtol=1e-12)
    assert (frf.output, frf.input) == ("2+z", "1-z")
    assert frf.quantity is Quantity.ACCELERATION


@pytest.mark.parametrize(
    ("units", "quantity", "factor"),
    [
        (("g", "N"), Quantity.ACCELERATION, 9.80665),
        (("m/s^2", "lbf"), Quantity.ACCELERATION, 1 / 4.4482216152605),
        (("(1/N)*(m/s2)", "NONE"), Quantity.ACCELERATION, 1.0),
        (("mm/s", "kN"), Quantity.VELOCITY, 1e-6),
        (("um/N", "NONE"), Quantity.DISPLACEMENT, 1e-6),
        (("1/kg", ""), Quantity.ACCELERATION, 1.0),
    ],
)
def test_units_of_motion_over_force_lead_to_si(tmp_path, units, quantity, factor):
    """The factor is that of the motion over that of the force."""
    (frf,) = read(tmp_path / "a.uff", data_set(units=units))
    assert frf.quantity is quantity
    np.testing.assert_allclose(frf.response, VALUES * factor, rtol=1e-10)


def test_a_missing_unit_is_refused_with_what_to_type_and_taken_from_columns(tmp_path):
    """No unit is guessed; --columns states it."""
    data = data_set(units=("NONE", "NONE"))
    with pytest.raises(UnitError, match="--columns 'frf:m/s"):
        read(tmp_path / "a.uff", data)
    (frf,) = read(tmp_path / "a.uff", data, "frf:g/N")
    np.testing.assert_allclose(frf.response, 9.80665 * VALUES, rtol=1e-10)
    with pytest.raises(UnitError, match="by its file"):
        read(tmp_path / "a.uff", data_set(), "frf:g/N")


def test_coherence_goes_to_the_frf_of_its_degrees_of_freedom(tmp_path):
    """Type 6 of node 2 is that of the FRF of node 2, wherever it stands."""
    share = np.linspace(0.5, 1.0, LINES) + 0j
    one, other = (2, 3, 1, 3), (5, 3, 1, 3)
    data = data_set(share, function=6, kind=REAL_SINGLE, place=other)
    data += data_set(place=one) + data_set(place=other)
    first, second = read(tmp_path / "a.uff", data)
    assert first.coherence is None
    np.testing.assert_allclose(second.coherence, share.real, rtol=1e-5)


def test_time_histories_are_no_frfs(tmp_path):
    """A file with samples is left to the readers of samples."""
    samples = data_set(function=1, kind=REAL_SINGLE)
    assert read(tmp_path / "a.uff", samples) == ()
    assert read(tmp_path / "b.uff", samples + data_set()) == ()


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (data_set()[:-120], "cut short"),
        (data_set(np.where(np.arange(LINES) == 3, np.nan, VALUES)), "1.5 Hz"),
        (data_set(kind=REAL_SINGLE), "no imaginary part"),
        (data_set(step=0.0), "ascend"),
        (data_set(abscissa="s"), "over frequency in Hz"),
        (data_set().replace(b"         8    ", b" 999999999    "), "claims"),
        (data_set().replace(b"         8    ", b"        12    "), "use another copy"),
    ],
    ids=["cut", "nan", "real", "step", "axis", "claim", "fewer"],
)
def test_a_damaged_file_is_one_line(tmp_path, data, words):
    """Each message is one line that names the file."""
    with pytest.raises(BadData, match=words) as error:
        read(tmp_path / "a.uff", data)
    assert "\n" not in str(error.value)
    assert "a.uff" in str(error.value)


def test_a_file_of_another_kind_is_not_recognised(tmp_path):
    """Text that merely holds the mark is no universal file."""
    assert read(tmp_path / "a.uff", b"words\n" + data_set()) == ()
    with pytest.raises(FormatError):
        read(tmp_path / "b.npz", b"PK\x03\x04" + bytes(100), "frf:m/N@1Hz")


def test_lines_padded_with_spaces_are_numbers_and_no_more(tmp_path):
    """SDynPy fills the last line of an odd number of values up to 80 characters."""
    values = np.append(VALUES, 9.0 - 1.0j)
    text = data_set(values).split(b"\n")
    text[-3] = text[-3].ljust(80)
    found = read(tmp_path / "a.uff", b"\n".join(text) * 2)
    assert len(found) == 2
    for one in found:
        np.testing.assert_allclose(one.response, values, rtol=1e-10)


def test_a_unit_in_latin_1_is_read(tmp_path):
    """A superscript two is one byte there, which is no UTF-8."""
    data = data_set(units=("(1/N)*(m/s2)", "NONE")).replace(b"m/s2)", b"m/s\xb2)")
    (one,) = read(tmp_path / "a.uff", data)
    assert one.quantity is Quantity.ACCELERATION


def test_averages_given_with_coherence_reach_an_frf_of_a_universal_file(tmp_path):
    """The file states coherence, the user the number of averages."""
    share = np.linspace(0.5, 1.0, 8) + 0j
    path = tmp_path / "a.uff"
    path.write_bytes(data_set() + data_set(share, function=6, kind=REAL_SINGLE))
    (one,) = read_frfs(path, FrfOptions(averages=5))
    assert one.averages == 5
    assert one.coherence is not None
