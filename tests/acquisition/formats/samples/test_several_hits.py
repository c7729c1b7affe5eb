"""Several hits in one file, arrays without times, archives, structs and labels."""

import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
import xarray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.formats.samples.read_samples import read_samples
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Quantity, Recording

RATE, COUNT = 6400.0, 60
TIME = np.arange(COUNT) / RATE
HITS = np.round(np.random.default_rng(2).normal(0.0, 10.0, (3, 2, COUNT)), 3)
"""Three hits, force and acceleration, [N] and [m/s^2]."""
ARRAYS = "time.t:s,force.F:N,acceleration.a:m/s^2"
ORDER = "force:N,acceleration:m/s^2"
Set = tuple[FloatArray, int, str, int]


def write_universal(path: Path, sets: Sequence[Set], head: str = "") -> Path:
    """Write time histories: values, code of the quantity, unit and node."""
    lines = [head] if head else []
    for row, code, unit, node in sets:
        lines += ["    -1", "    58", *(["NONE"] * 5)]
        lines.append(
            f"{1:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{node:10d}{3:4d} {'NONE':10s}"
            f"{0:10d}{0:4d}"
        )
        lines.append(f"{4:10d}{COUNT:10d}{1:10d}{0:13.5e}{1 / RATE:13.5e}{0:13.5e}")
        for number, word, text in (
            (17, "Time", "s"),
            (code, "Data", unit),
            (0, "NONE", "NONE"),
            (0, "NONE", "NONE"),
        ):
            lines.append(f"{number:10d}{0:5d}{0:5d}{0:5d} {word:20s} {text:20s}")
        for first in range(0, row.size, 4):
            lines.append("".join(f"{v:20.11e}" for v in row[first : first + 4]))
        lines.append("    -1")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def require_hits(found: Sequence[Recording], allowed: float = 1e-9) -> None:
    """Require the three hits, in order, with force and acceleration."""
    assert len(found) == 3
    for one, hit in zip(found, HITS, strict=True):
        assert [c.quantity for c in one.channels] == [
            Quantity.FORCE,
            Quantity.ACCELERATION,
        ]
        np.testing.assert_allclose(one.samples, hit, atol=allowed)
        assert one.sample_rate == RATE
    assert len({one.name for one in found}) == 3


@pytest.mark.parametrize("order", ["hit by hit", "by channel", "roving hammer"])
def test_hits_of_a_universal_file_are_recordings(tmp_path: Path, order: str) -> None:
    """In either order, and with another hit point each time."""
    node = {"roving hammer": (1, 2, 3)}.get(order, (1, 1, 1))
    force = [(hit[0], 13, "N", n) for hit, n in zip(HITS, node, strict=True)]
    motion = [(hit[1], 12, "m/s^2", 7) for hit in HITS]
    pairs = [one for pair in zip(force, motion, strict=True) for one in pair]
    sets = force + motion if order == "by channel" else pairs
    found = read_samples(write_universal(tmp_path / "u.uff", sets), SampleOptions())
    require_hits(found)
    assert [one.channels[0].point for one in found] == [str(n) for n in node]


def test_sensors_without_names_are_channels_of_one_recording(tmp_path: Path) -> None:
    """One force and three accelerations of node 0: no hit comes again."""
    rows = [(HITS[0, 0], 13, "N", 0), *[(h[1], 12, "m/s^2", 0) for h in HITS]]
    found = read_samples(write_universal(tmp_path / "u.uff", rows), SampleOptions())
    assert len(found) == 1
    assert len(found[0].channels) == 4


def test_units_of_data_set_164_count_where_a_history_has_none(tmp_path: Path) -> None:
    """Millimetres and newtons: the factors lead out of SI."""
    system = "\n".join(
        [
            "    -1",
            "   164",
            f"{10:10d}{'mm (newton)':20s}{2:10d}",
            "".join(f"  {factor}" for factor in ("1.0D+03", "1.0D+00", "1.0D+00")),
            "  2.73149999999999977D+02",
            "    -1",
        ]
    )
    rows = [(HITS[0, 0], 13, "NONE", 1), (HITS[0, 1], 12, "NONE", 2)]
    path = write_universal(tmp_path / "u.uff", rows, system)
    (found,) = read_samples(path, SampleOptions())
    np.testing.assert_allclose(found.samples[0], HITS[0, 0], atol=1e-9)
    np.testing.assert_allclose(found.samples[1], 1e-3 * HITS[0, 1], atol=1e-9)
    assert found.channels[1].unit == "mm/s^2"


def archive(folder: Path) -> Path:
    """Write hits into a .npz archive."""
    path = folder / "h.npz"
    np.savez(path, t=TIME, F=HITS[:, 0], a=HITS[:, 1].T)
    return path


def mat(folder: Path) -> Path:
    """Write hits into a MAT file, samples down the columns."""
    path = folder / "h.mat"
    scipy.io.savemat(path, {"t": TIME, "F": HITS[:, 0].T, "a": HITS[:, 1].T})
    return path


def mat73(folder: Path) -> Path:
    """Write hits into a MAT file of version 7.3."""
    path = folder / "v.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in (("t", TIME[None]), ("F", HITS[:, 0]), ("a", HITS[:, 1])):
            file[name] = value
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return path


@pytest.mark.parametrize("write", [archive, mat, mat73])
def test_tables_of_samples_and_hits_are_hits(tmp_path: Path, write: Any) -> None:
    """In a .npz archive, a MAT file and one of version 7.3."""
    path = write(tmp_path)
    require_hits(read_samples(path, SampleOptions(ARRAYS)))
    without = "force.F:N,acceleration.a:m/s^2"
    require_hits(read_samples(path, SampleOptions(without, rate=RATE)))
    with pytest.raises(SamplingError, match="--rate says 5000 Hz"):
        read_samples(path, SampleOptions(ARRAYS, rate=5000.0))
    with pytest.raises(UsageError, match="--rate '10 kHz'"):
        read_samples(path, SampleOptions(without))
    with pytest.raises(UnitError, match=r"time\.t:s,force\.F:N,acceleration\.a:"):
        read_samples(path, SampleOptions())


def test_an_array_of_hits_channels_and_samples_is_hits(tmp_path: Path) -> None:
    """Axes in any order, as long as the number of channels names one of them."""
    for number, cube in enumerate((HITS, np.moveaxis(HITS, 2, 0))):
        path = tmp_path / f"{number}.npy"
        np.save(path, cube)
        require_hits(read_samples(path, SampleOptions(ORDER, rate=RATE)))
    with pytest.raises(FormatError, match="hits, channels and samples"):
        read_samples(path, SampleOptions("force:N", rate=RATE))


def test_a_table_without_times_needs_the_rate(tmp_path: Path) -> None:
    """One line shows what to type; a negative unit turns the numbers round."""
    path = tmp_path / "h.npy"
    np.save(path, HITS[0])
    with pytest.raises(UsageError, match="--rate '10 kHz'"):
        read_recording(path, columns=ORDER)
    found = read_recording(path, columns="force:-N,acceleration:m/s^2", rate=RATE)
    np.testing.assert_array_equal(found.samples[0], -HITS[0, 0])
    np.testing.assert_array_equal(found.samples[1], HITS[0, 1])
    assert found.sample_rate == RATE


def test_arrays_without_times_need_the_rate_in_the_proposal(tmp_path: Path) -> None:
    """No array ascends as times do: none is proposed as one."""
    np.savez(tmp_path / "h.npz", a=HITS[:, 1], force=HITS[:, 0])
    words = r"'force\.force:N,acceleration\.a:m/s\^2' --rate '10 kHz'"
    with pytest.raises(UnitError, match=words):
        read_samples(tmp_path / "h.npz", SampleOptions())


def history(values: FloatArray, unit: str, label: str) -> dict[str, Any]:
    """Return a struct as Testlab exports a time history."""
    quantity = {"label": unit, "unit_transformation": {"factor": 1.0}}
    return {
        "x_values": {
            "start_value": 0.0,
            "increment": 1 / RATE,
            "number_of_values": float(values.shape[0]),
            "quantity": {"label": "s"},
        },
        "y_values": {"values": values, "quantity": quantity},
        "function_record": {"primary_channel": {"point_info": {"label": label}}},
    }


def test_time_histories_of_testlab_state_their_channels(tmp_path: Path) -> None:
    """A struct for each channel of each hit; the labels come again."""
    content = {}
    for number, (force, motion) in enumerate(HITS):
        content[f"F_{number}"] = history(force, "N", "hammer")
        content[f"A_{number}"] = history(motion, "m/s^2", "plate:4:+Z")
    path = tmp_path / "t.mat"
    scipy.io.savemat(path, content)
    found = read_samples(path, SampleOptions())
    require_hits(found)
    assert [c.name for c in found[0].channels] == ["hammer", "plate:4:+Z"]


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_labelled_arrays_are_read_with_their_units(tmp_path: Path, engine: Any) -> None:
    """As xarray writes them: netCDF-4 and netCDF-3, one axis of hits."""
    path = tmp_path / "x.nc"
    xarray.Dataset(
        {
            "hammer": (("hit", "time"), HITS[:, 0], {"units": "N"}),
            "a": (("channel", "time", "hit"), HITS[:, 1].T[None], {"units": "m s-2"}),
        },
        coords={"time": ("time", 1e3 * TIME, {"units": "ms"}), "channel": ["a1"]},
    ).to_netcdf(path, engine=engine)
    found = read_samples(path, SampleOptions())
    require_hits(found)
    assert [c.name for c in found[0].channels] == ["hammer", "a1"]


def test_a_pickle_is_never_opened(tmp_path: Path) -> None:
    """LDAQ saves pickles; the message has the way out."""
    path = tmp_path / "run.pkl"
    path.write_bytes(pickle.dumps({"NI": {"time": TIME}}, protocol=-1))
    with pytest.raises(FormatError, match=r"LDAQ\.load_measurement.*numpy\.savez"):
        read_samples(path, SampleOptions())


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_packed_arrays_and_names_as_letters_are_read_as_xarray_reads_them(
    tmp_path: Path, engine: str
) -> None:
    """Whole numbers with a scale and an offset, names of channels as characters."""
    path = tmp_path / "packed.nc"
    data = xarray.Dataset(
        {
            "f": (("hit", "time"), HITS[:, 0], {"units": "N"}),
            "a": (("hit", "time"), HITS[:, 1], {"units": "m s-2"}),
            "operator": (("hit",), np.array(["Ada", "Kurt", "Ada"], dtype="S")),
        },
        {"time": (("time",), TIME, {"units": "s"})},
    )
    packed = {"dtype": "int32", "scale_factor": 1e-3, "add_offset": 4.0}
    packed["_FillValue"] = -(2**31)
    data.to_netcdf(path, engine=engine, encoding={"f": packed, "a": packed})
    found = read_samples(path, SampleOptions(None))
    with xarray.open_dataset(path, engine=engine) as own:
        for number, one in enumerate(found):
            for channel, row in zip(one.channels, one.samples, strict=True):
                assert np.allclose(row, own[channel.name].values[number], rtol=1e-12)
