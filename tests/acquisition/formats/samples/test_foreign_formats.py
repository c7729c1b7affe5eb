"""Universal, TDMS, MAT, WAV and Rattlesnake files: read rightly, or refused."""

import struct
import wave
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from scipy.io import wavfile

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.formats.samples import rattlesnake as rattlesnake_module
from jointbench.acquisition.formats.samples.mat_recording import read_mat_recordings
from jointbench.acquisition.formats.samples.rattlesnake import read_rattlesnake
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.samples.tdms import read_tdms
from jointbench.acquisition.formats.samples.universal import read_universal
from jointbench.acquisition.formats.samples.wave import read_wave
from jointbench.acquisition.records.recordings import Quantity

RATE = 6400.0
ROWS = np.round(np.random.default_rng(1).normal(0.0, 10.0, (2, 50)), 3)
MAT = "time.t:ms,force.F@3:kN,acceleration.a1:g"


def universal(path: Path, *, unit: str = "g", count: int = 50, kind: int = 12) -> Path:
    """Write two time histories as text: a force and a response."""
    lines = []
    for code, axis, row in ((13, "N", ROWS[0]), (kind, unit, ROWS[1])):
        entity = "force" if code == 13 else "a1"
        lines += ["    -1", "    58", *(["NONE"] * 5)]
        lines.append(
            f"{1:5d}{0:10d}{0:5d}{0:10d} {entity:10s}{7:10d}{-3:4d} {'NONE':10s}"
            f"{0:10d}{0:4d}"
        )
        lines.append(f"{4:10d}{count:10d}{1:10d}{0:13.5e}{1 / RATE:13.5e}{0:13.5e}")
        for number, word, text in (
            (17, "Time", "s"),
            (code, "Data", axis),
            (0, "NONE", "NONE"),
            (0, "NONE", "NONE"),
        ):
            lines.append(f"{number:10d}{0:5d}{0:5d}{0:5d} {word:20s} {text:20s}")
        for first in range(0, row.size, 4):
            lines.append("".join(f"{v:20.11e}" for v in row[first : first + 4]))
        lines.append("    -1")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def test_a_universal_file_states_units_points_and_directions(tmp_path: Path) -> None:
    """N stays, g becomes m/s^2, node 7 in -z is point 7, and the rate is 6400 Hz."""
    (found,) = read_universal(universal(tmp_path / "u.uff"), columns=None, point="1")
    np.testing.assert_allclose(found.samples[0], ROWS[0], rtol=1e-10)
    np.testing.assert_allclose(found.samples[1], 9.80665 * ROWS[1], rtol=1e-10)
    assert found.sample_rate == RATE
    assert [c.name for c in found.channels] == ["force", "a1"]
    assert (found.channels[1].point, found.channels[1].direction) == ("7", "-z")


def test_a_universal_file_without_a_unit_is_refused_with_what_to_type(
    tmp_path: Path,
) -> None:
    """With the suggested option it is read."""
    path = universal(tmp_path / "u.uff", unit="NONE")
    with pytest.raises(UnitError, match=r"force\.force:N,acceleration\.a1:"):
        read_universal(path, columns=None, point="1")
    columns = "force.force:N,acceleration.a1:m/s^2"
    (found,) = read_universal(path, columns=columns, point="1")
    np.testing.assert_allclose(found.samples[1], ROWS[1], rtol=1e-10)


def test_a_unit_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    """The file says g, the user m/s^2: one of them is wrong."""
    path = universal(tmp_path / "u.uff")
    with pytest.raises(UnitError, match="is in 'g' by its file"):
        read_universal(path, columns="force:N,acceleration:m/s^2", point="1")


def test_a_header_that_claims_more_than_the_file_holds_is_refused(
    tmp_path: Path,
) -> None:
    """A billion values in 3 kB: nothing is allocated for them."""
    path = universal(tmp_path / "u.uff", count=10**9)
    with pytest.raises(HostileFile, match="claims 1000000000 values"):
        read_universal(path, columns=None, point="1")


def test_a_text_without_data_sets_is_no_universal_file(tmp_path: Path) -> None:
    """One line."""
    path = tmp_path / "u.uff"
    path.write_text("hello\n", encoding="ascii")
    with pytest.raises(FormatError, match="no data set"):
        read_universal(path, columns=None, point="1")


@pytest.mark.parametrize("order", [1, 2])
def test_binary_time_histories_are_read_bit_for_bit(tmp_path: Path, order: int) -> None:
    """Data set 58b, little and big endian; no line ends after the values."""
    text = universal(tmp_path / "u.uff", unit="m/s^2").read_text(encoding="ascii")
    blocks = text.split("    -1\n    -1\n")
    parts = []
    for block, row in zip(blocks, ROWS, strict=True):
        lines = block.replace("    -1\n", "").splitlines()
        lines[0] = f"    58b{order:6d}{2:6d}{11:12d}{8 * row.size:12d}" + " " * 36
        head = "".join(f"{line}\n" for line in ["    -1", *lines[:12]])
        values = row.astype("<f8" if order == 1 else ">f8").tobytes()
        parts.append(head.encode() + values + b"    -1\n")
    whole = tmp_path / "whole.uff"
    whole.write_bytes(b"".join(parts))
    (found,) = read_universal(whole, columns=None, point="1")
    assert np.array_equal(found.samples, ROWS)
    assert found.sample_rate == RATE
    whole.write_bytes(whole.read_bytes()[:-200])
    with pytest.raises(FormatError, match="data set 2 has no end; it is cut short"):
        read_universal(whole, columns=None, point="1")


def test_a_unit_of_another_quantity_than_the_file_says_is_named(
    tmp_path: Path,
) -> None:
    """An acceleration in N: what is wrong is the unit, whose quantity is known."""
    with pytest.raises(UnitError, match="'N', which is none of acceleration;"):
        read_universal(universal(tmp_path / "u.uff", unit="N"), columns=None, point="1")


def test_a_mat_file_that_was_cut_is_refused_as_that(tmp_path: Path) -> None:
    """Not as one without the variable after the cut."""
    path = tmp_path / "m.mat"
    content = {"t": np.arange(50) / RATE, "F": ROWS[0], "a1": ROWS[1]}
    scipy.io.savemat(path, content)
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(FormatError, match="cut short"):
        read_mat_recordings(path, SampleOptions(MAT))


def test_mat_variables_are_channels_by_their_labels(tmp_path: Path) -> None:
    """Time in ms, force in kN at point 3, acceleration in g."""
    path = tmp_path / "m.mat"
    time = 1e3 * np.arange(50) / RATE
    scipy.io.savemat(path, {"t": time, "F": ROWS[0], "a1": ROWS[1]})
    (found,) = read_mat_recordings(path, SampleOptions(MAT))
    np.testing.assert_allclose(found.samples[0], 1e3 * ROWS[0])
    assert found.sample_rate == pytest.approx(RATE)
    assert found.channels[0].point == "3"
    with pytest.raises(UnitError, match=r"'t' .*, 'F' .*, 'a1'"):
        read_mat_recordings(path, SampleOptions(None))
    with pytest.raises(UsageError, match="names no times"):
        read_mat_recordings(path, SampleOptions("force.F:N"))


def test_a_mat_channel_of_another_length_is_refused(tmp_path: Path) -> None:
    """Both lengths are named."""
    path = tmp_path / "m.mat"
    time = np.arange(50) / RATE * 1e3
    scipy.io.savemat(path, {"t": time, "F": ROWS[0], "a1": ROWS[1][:40]})
    with pytest.raises(SamplingError, match="40 samples, the time 50"):
        read_mat_recordings(path, SampleOptions(MAT))


def test_a_wav_file_needs_units_and_full_scale(tmp_path: Path) -> None:
    """16 bits: 16384 is half of the full scale of 10 V, at 10 mV/N 500 N."""
    path = tmp_path / "w.wav"
    counts = np.array([[16384, 0], [-32768, 8192]], dtype=np.int16)
    wavfile.write(path, 48000, counts)
    columns = "force:V@10mV/N,acceleration:m/s^2"
    with pytest.raises(UnitError, match="states no units"):
        read_wave(path, columns=None, point="1")
    with pytest.raises(UnitError, match="--full-scale"):
        read_wave(path, columns=columns, point="1")
    found = read_wave(path, columns=columns, point="1", full_scale=10.0)
    np.testing.assert_allclose(found.samples, [[500.0, -1000.0], [0.0, 2.5]])
    assert found.sample_rate == 48000.0


@pytest.mark.parametrize("scale", [-1.0, 0.0, np.nan, np.inf])
def test_a_full_scale_that_is_none_is_refused(tmp_path: Path, scale: float) -> None:
    """A negative one would turn every sample round."""
    path = tmp_path / "w.wav"
    wavfile.write(path, 48000, np.zeros((10, 2), dtype=np.int16))
    with pytest.raises(UsageError, match="above zero"):
        read_wave(path, columns="force:N,acceleration:g", point="1", full_scale=scale)


def test_three_bytes_a_sample_keep_all_their_bits(tmp_path: Path) -> None:
    """24 bits, as audio interfaces write them: a step is full scale / 2^23."""
    path = tmp_path / "w.wav"
    counts = np.array([[1, -1], [2**23 - 1, -(2**23)]])
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(3)
        file.setframerate(48000)
        file.writeframes(
            b"".join(int(c).to_bytes(3, "little", signed=True) for c in counts.ravel())
        )
    columns = "force:N,acceleration:m/s^2"
    found = read_wave(path, columns=columns, point="1", full_scale=2.0**23)
    assert np.array_equal(found.samples, counts.T)


def test_a_wav_file_that_was_cut_is_refused(tmp_path: Path) -> None:
    """Its chunk claims more than is left; so does a hostile one."""
    path = tmp_path / "w.wav"
    wavfile.write(path, 48000, np.zeros((100, 2), dtype=np.int16))
    whole = path.read_bytes()
    path.write_bytes(whole[:-10])
    with pytest.raises(FormatError, match="cut short"):
        read_wave(path, columns="force:N,acceleration:g", point="1", full_scale=1.0)
    at = whole.index(b"data") + 4
    path.write_bytes(whole[:at] + struct.pack("<I", 2**31) + whole[at + 4 :])
    with pytest.raises(FormatError, match="2147483648 bytes"):
        read_wave(path, columns="force:N,acceleration:g", point="1", full_scale=1.0)


def tdms(path: Path, *, unit: str = "g", step: float = 1 / RATE) -> Path:
    """Write a TDMS file of two channels."""
    nptdms = pytest.importorskip("nptdms", reason="TDMS is an extra")
    with nptdms.TdmsWriter(path) as writer:
        objects = [
            nptdms.ChannelObject(
                "hits", name, row, {"unit_string": text, "wf_increment": step}
            )
            for name, text, row in (("hammer", "N", ROWS[0]), ("a1", unit, ROWS[1]))
        ]
        writer.write_segment(objects)
    return path


def test_a_tdms_file_states_units_and_rate(tmp_path: Path) -> None:
    """N and g by its properties, the rate by the time step."""
    found = read_tdms(tdms(tmp_path / "t.tdms"), columns=None, point="5")
    np.testing.assert_allclose(found.samples[1], 9.80665 * ROWS[1])
    assert found.sample_rate == pytest.approx(RATE)
    assert [c.name for c in found.channels] == ["hammer", "a1"]
    assert found.channels[0].point == "5"


def test_volts_are_no_newtons_because_someone_says_so(tmp_path: Path) -> None:
    """A file in V takes the sensitivity of its sensor, not another unit."""
    path = tdms(tmp_path / "t.tdms", unit="V")
    with pytest.raises(UnitError, match="the sensitivity of the sensor"):
        read_tdms(path, columns="force.hammer:N,acceleration.a1:g", point="1")
    columns = "force.hammer:N,acceleration.a1:V@10mV/g"
    found = read_tdms(path, columns=columns, point="1")
    np.testing.assert_allclose(found.samples[1], 980.665 * ROWS[1])


def test_a_tdms_file_without_units_or_rate_is_refused(tmp_path: Path) -> None:
    """Neither is guessed."""
    with pytest.raises(UnitError, match="no unit"):
        read_tdms(tdms(tmp_path / "t.tdms", unit=""), columns=None, point="1")
    with pytest.raises(SamplingError, match="wf_increment"):
        read_tdms(tdms(tmp_path / "s.tdms", step=0.0), columns=None, point="1")


def test_a_tdms_file_that_was_cut_is_refused(tmp_path: Path) -> None:
    """NpTDMS reads on with a warning; half a record is none."""
    path = tdms(tmp_path / "t.tdms")
    whole = path.read_bytes()
    path.write_bytes(whole[:-100])
    with pytest.raises(SamplingError, match="'a1' 37"):
        read_tdms(path, columns=None, point="1")
    path.write_bytes(whole + whole[:-800])
    with pytest.raises(FormatError, match="cut short"):
        read_tdms(path, columns=None, point="1")


def rattlesnake(path: Path, units: tuple[str, str] = ("N", "m/s^2")) -> Path:
    """Write a stream as the controller does: texts of variable length."""
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = RATE
        file.create_dataset("time_data", data=ROWS)
        table = file.create_group("channels")
        for name, texts in (
            ("node_number", ("1", "104")),
            ("node_direction", ("Z+", "X-")),
            ("unit", units),
        ):
            data = np.array(texts, dtype=object)
            table.create_dataset(name, data=data, dtype=h5py.string_dtype())
    return path


def test_a_rattlesnake_stream_states_nodes_and_units(tmp_path: Path) -> None:
    """Node 104 in -x measures acceleration."""
    path = rattlesnake(tmp_path / "r.nc4")
    (found,) = read_rattlesnake(path, columns=None, point="9")
    np.testing.assert_array_equal(found.samples, ROWS)
    assert found.sample_rate == RATE
    second = found.channels[1]
    assert (second.point, second.direction) == ("104", "-x")
    assert second.quantity is Quantity.ACCELERATION


def test_every_stream_of_a_rattlesnake_file_is_a_recording(tmp_path: Path) -> None:
    """Streams begun later are variables of their own; an empty one holds nothing."""
    path = rattlesnake(tmp_path / "r.nc4")
    with h5py.File(path, "a") as file:
        file.create_dataset("time_data_10", data=3 * ROWS)
        file.create_dataset("time_data_2", data=2 * ROWS[:, :20])
        file.create_dataset(
            "time_data_1", shape=(2, 0), maxshape=(2, None), dtype="<f8"
        )
    found = read_rattlesnake(path, columns=None, point="9")
    assert [one.name for one in found] == ["r", "r-2", "r-10"]
    np.testing.assert_array_equal(found[0].samples, ROWS)
    np.testing.assert_array_equal(found[1].samples, 2 * ROWS[:, :20])
    np.testing.assert_array_equal(found[2].samples, 3 * ROWS)
    assert ("layout", "Rattlesnake netCDF, time_data_2") in found[1].provenance[
        0
    ].detail


def test_a_long_rattlesnake_file_is_read_chunk_by_chunk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every moment is a chunk: there may be as many as the file has room for."""
    few = replace(rattlesnake_module._LIMITS, chunks=5000)  # noqa: SLF001
    monkeypatch.setattr(rattlesnake_module, "_LIMITS", few)
    path, size = rattlesnake(tmp_path / "r.nc4"), 5001
    rows = np.arange(2.0 * size).reshape(2, size)
    with h5py.File(path, "a") as file:
        del file["time_data"]
        data = file.create_dataset(
            "time_data", shape=(2, size), maxshape=(2, None), chunks=(2, 1), dtype="<f8"
        )
        data[...] = rows
    (found,) = read_rattlesnake(path, columns=None, point="9")
    np.testing.assert_array_equal(found.samples, rows)


def test_a_rattlesnake_stream_that_lacks_samples_is_refused(tmp_path: Path) -> None:
    """What was never written would read as a fill value."""
    path = rattlesnake(tmp_path / "r.nc4")
    with h5py.File(path, "a") as file:
        data = file.create_dataset(
            "time_data_1", shape=(2, 90), maxshape=(2, None), chunks=(2, 1), dtype="<f8"
        )
        data[:, :50] = ROWS
    with pytest.raises(FormatError, match="50 of 90 samples"):
        read_rattlesnake(path, columns=None, point="9")


def test_a_rattlesnake_stream_in_volts_is_refused(tmp_path: Path) -> None:
    """A drive's volts are not supported."""
    path = rattlesnake(tmp_path / "r.nc4", units=("V", "m/s^2"))
    with pytest.raises(UnitError, match="'V'"):
        read_rattlesnake(path, columns=None, point="1")


def test_a_text_without_end_is_refused(tmp_path: Path) -> None:
    """Texts of a channel are short; one of 100 kB is an attack."""
    path = rattlesnake(tmp_path / "r.nc4", units=("N", "x" * 100_000))
    with pytest.raises(HostileFile, match="no text of a channel"):
        read_rattlesnake(path, columns=None, point="1")


@pytest.mark.parametrize("seed", range(40))
def test_mutated_files_are_read_or_refused_in_one_line(
    tmp_path: Path, seed: int
) -> None:
    """Bytes changed, cut or doubled: never another error than ours."""
    rng = np.random.default_rng(seed)
    scipy.io.savemat(
        tmp_path / "m.mat", {"t": np.arange(50.0), "F": ROWS[0], "a1": ROWS[1]}
    )
    wavfile.write(tmp_path / "w.wav", 8000, ROWS.T.astype(np.float32))
    wave = "force:N,acceleration:g"
    readers = (
        (
            universal(tmp_path / "u.uff"),
            lambda p: read_universal(p, columns=None, point=""),
        ),
        (tdms(tmp_path / "t.tdms"), lambda p: read_tdms(p, columns=None, point="")),
        (tmp_path / "m.mat", lambda p: read_mat_recordings(p, SampleOptions(MAT))),
        (tmp_path / "w.wav", lambda p: read_wave(p, columns=wave, point="")),
        (
            rattlesnake(tmp_path / "r.nc4"),
            lambda p: read_rattlesnake(p, columns=None, point=""),
        ),
    )
    for path, read in readers:
        data = bytearray(path.read_bytes())
        for _ in range(4):
            data[int(rng.integers(min(len(data), 1500)))] = int(rng.integers(256))
        if seed % 3 == 0:
            data = data[: int(rng.integers(len(data)))]
        path.write_bytes(bytes(data))
        try:
            read(path)
        except BadData as error:
            assert len(str(error).splitlines()) == 1
