"""What is in a file, in plain data."""

import json

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.netcdf_encodings import write_complex
from jointbench.acquisition.file_access.netcdf_write import write_axis, write_variable
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.acquisition.records.session import JointSetup, new_session
from jointbench.acquisition.records.surfaces import Areal
from jointbench.acquisition.session_file.describe_file import describe_file
from jointbench.acquisition.session_file.store import write_session


def make_session(path):
    mask = np.ones((3, 4), dtype=bool)
    mask[1, 2] = False
    hit = Hit(5, 10, 90, "7", 55.5, Verdict.DOUBLE, float("nan"), "second peak")
    session = new_session(
        source="file:a.csv",
        simulated=False,
        joint=JointSetup(preload=4000.0, masses={"m1": 9.0}),
        recordings=[
            Recording(
                "hit",
                np.zeros((1, 100)),
                50.0,
                (Channel("a1", Quantity.ACCELERATION, "3", unit="g"),),
                start_time=1.0,
                hits=(hit,),
                provenance=(step("import", file="a.csv", sha256="ab"),),
            )
        ],
        surfaces=[Areal("map", np.zeros((3, 4)), (2e-6, 1e-6), mask)],
    )
    write_session(session, path)
    return session


def test_a_session_is_described_for_json(tmp_path):
    """Strict JSON, and everything a person asks first."""
    session = make_session(tmp_path / "s.h5")
    found = describe_file(tmp_path / "s.h5")
    found = json.loads(json.dumps(found, allow_nan=False))
    assert found["schema"] == "jointbench-session/1"
    assert found["uuid"] == session.uuid
    assert found["simulated"] is False
    assert found["joint"]["preload_n"] == 4000.0
    assert found["joint"]["torque_n_m"] is None
    (recording,) = found["recordings"]
    assert recording["duration_s"] == 2.0
    assert recording["channels"][0]["quantity"] == "acceleration"
    assert recording["channels"][0]["unit"] == "g"
    assert recording["verdicts"] == {"double": 1}
    assert recording["hits"][0]["time_s"] == 1.2
    assert recording["hits"][0]["measure"] is None
    assert recording["hits"][0]["reason"] == "second peak"
    (surface,) = found["surfaces"]
    assert (surface["shape"], surface["missing"]) == ([3, 4], 1)
    assert surface["spacing_m"] == [2e-6, 1e-6]
    (entry,) = found["provenance"]
    assert (entry["of"], entry["name"], entry["step"]) == ("recording", "hit", "import")
    assert entry["detail"]["file"] == "a.csv"


def test_a_results_file_is_described_by_its_variables(tmp_path):
    """Names, dimensions and units; what only names a dimension is left out."""
    path = tmp_path / "r.h5"
    with new_file(path, schema="jointbench-results/1", title="results") as file:
        group = file.create_group("frf")
        write_axis(group, "frequency", 300, step=0.5, units="Hz", long_name="frequency")
        values = np.ones((2, 300)) + 1j
        write_complex(group, "frf", values, ("output", "frequency"), units="m/N")
        write_variable(
            file, "stiffness", 1e8, (), units="N/m", long_name="of the joint"
        )
    found = json.loads(json.dumps(describe_file(path), allow_nan=False))
    assert found["schema"] == "jointbench-results/1"
    root, frf = found["groups"]
    assert root["variables"][0]["value"] == 1e8
    variables = {variable["name"]: variable for variable in frf["variables"]}
    assert set(variables) == {"frequency", "frf_re", "frf_im"}
    assert variables["frf_re"]["dims"] == ["output", "frequency"]
    assert variables["frf_re"]["units"] == "m/N"


def test_a_foreign_hdf5_file_is_described_too(tmp_path):
    """Without a schema there are still groups, shapes and types."""
    with h5py.File(tmp_path / "f.h5", "w") as file:
        file["a/b"] = np.zeros((2, 3), dtype="f4")
    found = describe_file(tmp_path / "f.h5")
    assert found["schema"] is None
    assert found["groups"][0]["variables"][0]["shape"] == [2, 3]


@pytest.mark.parametrize(
    "data", [b"", b"time,force\n0,1\n", b"\x89HDF\r\n\x1a\n" + b"\0"]
)
def test_what_is_no_hdf5_file_is_refused_in_one_line(tmp_path, data):
    """Empty, text, and a signature with nothing after it."""
    (tmp_path / "x.h5").write_bytes(data)
    with pytest.raises(BadData) as caught:
        describe_file(tmp_path / "x.h5")
    assert "\n" not in str(caught.value)


def test_a_session_with_a_part_missing_is_refused(tmp_path):
    """Not described by halves."""
    make_session(tmp_path / "s.h5")
    with h5py.File(tmp_path / "s.h5", "r+") as file:
        del file["stream/hit/point"]
    with pytest.raises(BadData, match="damaged"):
        describe_file(tmp_path / "s.h5")


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan])
def test_a_rate_that_no_recording_has_is_damage(tmp_path, rate):
    """Not a division by zero."""
    make_session(tmp_path / "s.h5")
    with h5py.File(tmp_path / "s.h5", "r+") as file:
        file["stream/hit"].attrs["sample_rate"] = rate
    with pytest.raises(FormatError, match=r"damaged: sample_rate"):
        describe_file(tmp_path / "s.h5")


@pytest.mark.parametrize(
    "samples", [np.zeros(100), np.zeros((2, 100)), np.full((1, 100), b"x")]
)
def test_samples_of_another_shape_or_type_are_damage(tmp_path, samples):
    """One axis, a row too many, and text."""
    make_session(tmp_path / "s.h5")
    with h5py.File(tmp_path / "s.h5", "r+") as file:
        del file["stream/hit/samples"]
        file["stream/hit/samples"] = samples
    with pytest.raises(FormatError, match="damaged: its samples") as caught:
        describe_file(tmp_path / "s.h5")
    assert "\n" not in str(caught.value)
