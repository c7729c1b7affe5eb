"""Hits from plain tables."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.records.recordings import Quantity

HITS = Path(__file__).parents[5] / "shared" / "data" / "hits"
shared = pytest.mark.skipif(not HITS.is_dir(), reason=f"no shared data at {HITS}")

RATE = 2000.0
FORCE = np.array([0.0, 3.0, 10.0, 2.0, -0.5, 0.25])
RESPONSE = np.array([0.0, 1.0, -2.0, 1.5, -0.75, 0.5])


def write(path, time=None, force=FORCE, response=RESPONSE, header=""):
    time = np.arange(force.size) / RATE if time is None else time
    rows = [
        ",".join(repr(float(cell)) for cell in row)
        for row in zip(time, force, response, strict=True)
    ]
    path.write_text(header + "\n".join(rows) + "\n")
    return path


def test_units_are_converted_and_channels_named(tmp_path):
    """Milliseconds, kilonewtons and g come out in SI."""
    path = write(tmp_path / "a.csv", time=(np.arange(6) / 2 + 7.5).tolist())
    recording = read_recording(path, columns="time:ms,force:kN,acceleration.a1@3:g")
    force, response = recording.channels
    assert (force.name, force.quantity, force.point) == ("force", Quantity.FORCE, "1")
    assert (response.name, response.point, response.unit) == ("a1", "3", "g")
    assert_array_equal(recording.samples[0], FORCE * 1e3)
    assert_array_equal(recording.samples[1], RESPONSE * 9.80665)
    assert recording.sample_rate == RATE
    assert_allclose(recording.start_time, 7.5e-3, rtol=1e-15)
    assert recording.name == "a"


@pytest.mark.parametrize(
    "header",
    [
        "Time [ms],Force [kN],a1 [g]\n",
        "made by a recorder\n# Time (ms), Force (kN), a1 (g)\n",
        "Time / ms,Force / kN,a1 / g\n",
        "Time in ms,Force in kN,a1 in g\n",
        "Time,Force,a1\n[ms],[kN],[g]\n",
        "Time,Force,a1\nms,kN,g\n\n",
    ],
)
def test_a_header_that_says_all_units_is_taken_at_its_word(tmp_path, header):
    """Nothing is left to type; the channels have the names of the header."""
    path = write(tmp_path / "a.csv", time=(np.arange(6) / 2).tolist(), header=header)
    recording = read_recording(path, columns=None)
    force, response = recording.channels
    assert (force.name, force.quantity, force.unit) == ("Force", Quantity.FORCE, "kN")
    assert (response.name, response.unit) == ("a1", "g")
    assert_array_equal(recording.samples, [FORCE * 1e3, RESPONSE * 9.80665])
    assert recording.sample_rate == RATE
    said = dict(recording.provenance[0].detail)["columns"]
    assert said == "as the file states: time:ms,force:kN,acceleration:g"


@pytest.mark.parametrize(
    ("header", "says"),
    [
        ("t [s],F [N],U [V]\n", "says 't' in 's'.*volts need the sensitivity"),
        ("t [s],F [N],a1\n", r"of column 3 \('a1'\) states no unit"),
        ("t [s],F [N],a1 [xy]\n", "the unit 'xy' is not known"),
        ("t,F,a1\n", "does not say their units; its header reads 't,F,a1'"),
        ("F [N],G [N],a1 [g]\n", "not one time"),
        ("", "does not say their units; describe"),
    ],
)
def test_what_a_header_lacks_is_said(tmp_path, header, says):
    """A header with some units is not reported as having none."""
    path = write(tmp_path / "a.csv", header=header)
    with pytest.raises(UnitError, match=says):
        read_recording(path, columns=None)


def test_si_samples_are_kept_to_the_bit(tmp_path):
    """No factor, no rounding."""
    values = np.random.default_rng(3).normal(size=FORCE.size)
    path = write(tmp_path / "a.csv", response=[float(v) for v in values])
    recording = read_recording(path, columns="time:s,force:N,acceleration:m/s^2")
    assert recording.samples[1].tobytes() == values.tobytes()


def test_volts_are_divided_by_the_sensitivity_which_the_channel_keeps(tmp_path):
    """1 V at 2 mV/N is 500 N."""
    path = write(tmp_path / "a.csv")
    recording = read_recording(path, columns="time:s,force:V@2mV/N,-")
    assert_allclose(recording.samples[0], FORCE * 500, rtol=1e-14)
    assert recording.channels[0].sensitivity == 2e-3


def test_repeated_quantities_are_numbered(tmp_path):
    """Names are unique within a recording."""
    path = write(tmp_path / "a.csv")
    recording = read_recording(path, columns="time:s,acceleration:g,acceleration:g")
    names = [channel.name for channel in recording.channels]
    assert names == ["acceleration_1", "acceleration_2"]


def test_provenance_names_the_file_its_digest_and_the_columns(tmp_path):
    """Where the samples came from can be checked later."""
    path = write(tmp_path / "a.csv")
    recording = read_recording(path, columns="time:s,force:N,-")
    detail = dict(recording.provenance[0].detail)
    assert detail["file"] == "a.csv"
    assert len(str(detail["sha256"])) == 64
    assert detail["columns"] == "time:s,force:N,-"


@pytest.mark.parametrize("count", [2, 3, 5])
def test_without_units_the_message_says_what_to_type(tmp_path, count):
    """What it suggests is accepted."""
    path = tmp_path / "a.npy"
    np.save(path, np.vstack([np.arange(50) / 100] + [np.ones(50)] * (count - 1)))
    with pytest.raises(UnitError, match="--columns") as caught:
        read_recording(path, columns=None)
    suggestion = str(caught.value).split("'")[-2]
    assert read_recording(path, columns=suggestion).samples.shape == (count - 1, 50)


@pytest.mark.parametrize(
    ("columns", "error"),
    [
        ("time:s,force:N", FormatError),
        ("time:s,force:N,acceleration:N", UnitError),
        ("time:s,force:V,acceleration:g", UnitError),
        ("force:N,acceleration:g,-", UsageError),
        ("time:s,-,-", UsageError),
        ("time:s,x:mm,force:N", UsageError),
        ("time:s,force.a:N,acceleration.a:g", UsageError),
    ],
)
def test_columns_that_do_not_fit_are_refused_in_one_line(tmp_path, columns, error):
    """Too few, wrong unit, volts alone, no time, no channel, another trade."""
    path = write(tmp_path / "a.csv")
    with pytest.raises(error) as caught:
        read_recording(path, columns=columns)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("cell", ["nan", "", "inf"])
def test_a_sample_that_is_missing_is_refused_by_its_line(tmp_path, cell):
    """Every sample needs a number."""
    path = tmp_path / "a.csv"
    path.write_text(f"time,force\n0,1\n0.1,2\n0.2,{cell}\n0.3,1\n0.4,1\n")
    with pytest.raises(SamplingError, match="line 4: force is"):
        read_recording(path, columns="time:s,force:N")


def test_a_gap_is_refused_with_file_and_line(tmp_path):
    """The message names both."""
    time = np.delete(np.arange(FORCE.size + 1) / RATE, 3).tolist()
    path = write(tmp_path / "a.csv", time=time, header="time,force,response\n")
    with pytest.raises(SamplingError, match=r"a\.csv': line 5: time goes from"):
        read_recording(path, columns="time:s,force:N,acceleration:g")


def test_a_missing_file_is_bad_data(tmp_path):
    """Not a FileNotFoundError."""
    with pytest.raises(BadData, match=r"No such file.*check the name"):
        read_recording(tmp_path / "none.csv", columns="time:s,force:N")


@shared
@pytest.mark.parametrize("number", [1, 2, 3])
def test_real_hammer_hits_are_read(number):
    """25,600 samples at 25.6 kHz with force peaks of 68 to 89 N."""
    path = HITS / f"measurements_{number}.npy"
    recording = read_recording(path, columns="time:s,force:N,acceleration:m/s^2")
    assert recording.samples.shape == (2, 25600)
    assert recording.sample_rate == 25600
    assert 68 < recording.samples[0].max() < 90


@shared
@pytest.mark.parametrize(
    "name", ["impact_pt8", "impact_pt18", "accel-pt8", "accel-pt18"]
)
def test_stamps_of_few_digits_are_read_at_their_true_rate(name):
    """4 kHz, printed with three digits, in one file only up to its middle."""
    recording = read_recording(HITS / f"{name}.txt", columns="time:s,force:N")
    assert recording.sample_rate == 4000


@shared
@pytest.mark.parametrize("tip", ["hard", "soft"])
def test_force_records_in_volts_are_read_with_their_sensitivity(tip):
    """50 kHz; no response, which an importer may leave to whoever needs one."""
    path = HITS / f"{tip}-tip.txt"
    recording = read_recording(path, columns="time:s,force:V@2.248mV/N")
    assert recording.sample_rate == 50_000
    again = dataclasses.replace(recording, name="again")
    assert again.samples is recording.samples


def test_a_value_beyond_all_instruments_is_refused_by_its_line(tmp_path):
    """Its square would overflow."""
    path = write(tmp_path / "a.csv", response=RESPONSE * 1e200)
    with pytest.raises(FormatError, match=r"a\.csv.*line 2: acceleration is 1e\+200"):
        read_recording(path, columns="time:s,force:N,acceleration:m/s^2")
