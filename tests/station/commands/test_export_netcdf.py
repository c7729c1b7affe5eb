"""Exports as netCDF: flat files by the CF conventions, one unit a variable."""

import io
import json
import re
import warnings
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.surfaces import Areal, Profile
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.commands.export_command import run_export
from jointbench.station.files.input_files import read_foreign
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.recipe import Recipe

xarray = pytest.importorskip("xarray")


def exported(path: Path) -> dict[str, Path]:
    """Export beside the file; return the files by what follows the stem."""
    written = run_export(path, kind="netcdf", folder=None, json_target=None)
    return {one.name.removeprefix(f"{path.stem}."): one for one in written}


@pytest.fixture
def result(make_session, tmp_path: Path) -> Path:
    """Process a small session."""
    path = tmp_path / "r.h5"
    process_task(Task(make_session("s.h5"), path), Recipe(name="plain"))
    return path


@pytest.fixture
def surfaces(make_session, tmp_path: Path) -> Path:
    """Write a session with a profile and a map, each with a point missing."""
    rng = np.random.default_rng(5)
    line, area = rng.normal(size=40) * 1e-6, rng.normal(size=(6, 9)) * 1e-6
    whole, gaps = np.arange(40) != 7, np.arange(54).reshape(6, 9) != 11
    session = replace(
        read_session(make_session("m.h5")),
        surfaces=(
            Profile("side a", np.where(whole, line, 0.0), 2e-6, whole),
            Areal("map", np.where(gaps, area, 0.0), (1e-6, 2e-6), gaps),
        ),
    )
    path = tmp_path / "with-surfaces.h5"
    write_session(session, path)
    return path


def test_samples_come_back_bit_for_bit_without_stating_columns(make_session) -> None:
    """Names, units and the even time axis are in the file."""
    path = make_session("s.h5")
    wanted = read_session(path).recordings[0]
    (found,) = read_foreign(exported(path)["stream.nc"], SampleOptions(None))
    assert found.sample_rate == pytest.approx(wanted.sample_rate, rel=1e-12)
    names = [channel.name for channel in found.channels]
    assert sorted(names) == sorted(channel.name for channel in wanted.channels)
    for channel, row in zip(wanted.channels, wanted.samples, strict=True):
        assert np.array_equal(found.samples[names.index(channel.name)], row)


def test_a_channel_is_a_variable_and_hits_are_beside_it(make_session) -> None:
    """As another program opens it."""
    path = make_session("s.h5")
    (recording,) = read_session(path).recordings
    with xarray.open_dataset(exported(path)["stream.nc"]) as found:
        assert found["force"].attrs["units"] == "N"
        assert found["force"].dims == ("elapsed_time",)
        assert found["hit_verdict"].values.tolist() == [
            hit.verdict.value for hit in recording.hits
        ]
        assert found["hit_peak_force"].values.tolist() == [
            hit.peak_force for hit in recording.hits
        ]
        assert "find_hits" in found.attrs["history"]


def test_a_map_has_axes_and_says_where_heights_are_missing(surfaces: Path) -> None:
    """The point that is missing is the only one without a number."""
    with xarray.open_dataset(exported(surfaces)["map.nc"]) as found:
        assert found["z"].dims == ("y", "x")
        assert np.argwhere(np.isnan(found["z"].values)).tolist() == [[1, 2]]
        assert found["x"].values[1] == 2e-6
        assert "_FillValue" in found["z"].encoding


def test_a_quantity_is_a_variable_with_its_unit_and_deviation(result: Path) -> None:
    """No list of units: rows of the table have become variables."""
    stored = next(
        q for q in read_result(result).quantities if q.name == "natural_frequency"
    )
    with xarray.open_dataset(exported(result)["quantities.nc"]) as found:
        name = next(n for n in found if str(n).endswith("natural_frequency"))
        assert float(found[name]) == stored.value
        assert found[name].attrs["units"] == "Hz"
        beside = found[name].attrs["ancillary_variables"]
        assert float(found[beside]) == stored.sd


def test_exports_keep_the_rules_of_cf(result: Path, surfaces: Path) -> None:
    """Names, units, titles, labels and missing values by the text of CF 1.11."""
    files = [*exported(result).values(), *exported(surfaces).values()]
    for path in files:
        with h5py.File(path) as file:
            assert not faults(file), path.name


def faults(file: h5py.File) -> list[str]:
    """Return what breaks sections 2.3, 2.5.1, 2.6, 3.1, 3.2 and 5 of CF 1.11."""
    found = [
        f"no {name}"
        for name in ("Conventions", "title", "history")
        if not file.attrs.get(name)
    ]
    for name, item in file.items():
        if not isinstance(item, h5py.Dataset):
            found.append(f"{name} is a group")
            continue
        if b"not a netCDF variable" in item.attrs.get("NAME", b""):
            continue
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
            found.append(f"name {name}")
        if not item.attrs.get("long_name"):
            found.append(f"{name}: no long_name")
        if item.dtype.kind not in "fiu":
            continue
        units = item.attrs.get("units", b"").decode()
        if not units or "," in units or " unit" in units:
            found.append(f"{name}: units {units!r}")
        missing = item.dtype.kind == "f" and np.isnan(item[...]).any()
        if missing and "_FillValue" not in item.attrs:
            found.append(f"{name}: NaN without _FillValue")
        for other in item.attrs.get("coordinates", b"").decode().split():
            if other not in file:
                found.append(f"{name}: no {other}")
        if item.is_scale and missing:
            found.append(f"{name}: coordinate with a gap")
    return found


def test_a_cf_checker_finds_nothing(result: Path, surfaces: Path) -> None:
    """compliance-checker of IOOS, CF 1.11, all its remarks, units by UDUNITS."""
    runner = pytest.importorskip("compliance_checker.runner")
    files = [*exported(result).values(), *exported(surfaces).values()]
    runner.CheckSuite.load_all_available_checkers()
    out = result.parent / "checked.json"
    for path in files:
        with warnings.catch_warnings(), redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            runner.ComplianceChecker.run_checker(
                str(path),
                ["cf:1.11"],
                0,
                "strict",
                output_filename=str(out),
                output_format="json",
            )
        said = json.loads(out.read_text("utf-8"))["cf:1.11"]
        messages = [
            f"{one['name']}: {one['msgs']}"
            for level in ("high", "medium", "low")
            for one in said[f"{level}_priorities"]
            if one["msgs"]
        ]
        assert not messages, path.name


def test_a_netcdf_file_of_others_is_not_replaced(make_session) -> None:
    """A second export may replace the first, and nothing else."""
    path = make_session("s.h5")
    first = exported(path)["stream.nc"]
    assert exported(path)["stream.nc"] == first
    with h5py.File(first, "w") as file:
        file["mine"] = [1.0]
    mine = first.read_bytes()
    with pytest.raises(UsageError, match="made by no export"):
        exported(path)
    assert first.read_bytes() == mine
