"""netCDF-compatible HDF5: what is written is what any reader gets."""

import os
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import BadData, ShapeError, UsageError
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.hdf5_layout import (
    dimension_names,
    is_dimension_only,
)
from jointbench.acquisition.file_access.netcdf_encodings import (
    write_complex,
    write_flags,
    write_texts,
)
from jointbench.acquisition.file_access.netcdf_read import (
    read_attribute,
    read_complex,
    read_flags,
    read_texts,
)
from jointbench.acquisition.file_access.netcdf_write import (
    write_attributes,
    write_axis,
    write_variable,
)

SCHEMA = {"schema": "jointbench-results/1", "title": "test"}


def test_a_file_appears_only_when_it_is_whole(tmp_path):
    """While it is written there is a .part, and after a failure nothing."""
    path = tmp_path / "a.h5"

    def fail():
        with new_file(path, **SCHEMA):
            assert [p.name for p in tmp_path.iterdir()] == ["a.h5.part"]
            raise KeyError("half-way")

    with pytest.raises(KeyError):
        fail()
    assert list(tmp_path.iterdir()) == []
    with new_file(path, **SCHEMA):
        pass
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_that_is_there_is_not_overwritten_unless_asked(tmp_path):
    """The old content stays to the byte."""
    path = tmp_path / "a.h5"
    path.write_bytes(b"precious")
    with pytest.raises(UsageError, match="exists already"), new_file(path, **SCHEMA):
        pass
    assert path.read_bytes() == b"precious"
    with new_file(path, overwrite=True, **SCHEMA):
        pass
    with h5py.File(path) as file:
        assert read_attribute(file, "schema") == "jointbench-results/1"


def test_a_failed_overwrite_leaves_the_old_file(tmp_path):
    """Replacing is one rename at the end."""
    path = tmp_path / "a.h5"
    path.write_bytes(b"precious")

    def fail():
        with new_file(path, overwrite=True, **SCHEMA):
            raise KeyError("half-way")

    with pytest.raises(KeyError):
        fail()
    assert path.read_bytes() == b"precious"


def test_a_place_that_cannot_be_written_is_a_usage_error(tmp_path):
    """No such folder, or a folder under that name: one line."""
    for path in (tmp_path / "none" / "a.h5", tmp_path):
        with pytest.raises(UsageError) as caught, new_file(path, **SCHEMA):
            pass
        assert "\n" not in str(caught.value)


@pytest.fixture
def file(tmp_path):
    with new_file(tmp_path / "a.h5", **SCHEMA) as opened:
        yield opened


@pytest.mark.parametrize("value", ["", "plain", "Prüfstand µm", 7, -2.5, 1e300])
def test_attributes_come_back_as_written(file, value):
    """Empty text and other alphabets included."""
    write_attributes(file, {"a": value})
    assert read_attribute(file, "a") == value


def test_an_attribute_of_none_is_left_out(file):
    """Values that are not given are not stored."""
    write_attributes(file, {"a": None})
    assert "a" not in file.attrs
    assert read_attribute(file, "a") is None


@pytest.mark.parametrize("text", ["a\0b", "\ud800", "x" * 70_000])
def test_a_text_that_cannot_be_stored_is_refused(file, text):
    """Better than to lose a part of it."""
    with pytest.raises(BadData):
        write_attributes(file, {"a": text})


def test_texts_come_back_as_written(file):
    """Empty ones and ones of several bytes a character."""
    texts = ("force", "", "Ä 中 😀", " blank ")
    assert read_texts(write_texts(file, "name", texts, "n", long_name="")) == texts


def test_flags_come_back_as_words(file):
    """Codes carry their meanings with them."""
    codes = [2, 0, 1, 2]
    words = ("ok", "weak", "late")
    flags = write_flags(file, "v", codes, ("n",), meanings=words, long_name="")
    assert read_flags(flags) == ("late", "ok", "weak", "late")


def test_complex_numbers_come_back_to_the_bit(file):
    """Two real variables; signed zeros survive."""
    values = np.array([[1 + 2j, -0.0 - 0.0j], [complex(0.0, -0.0), 3e-300j]])
    write_complex(file, "frf", values, ("output", "line"), units="m/N")
    assert read_complex(file, "frf").tobytes() == values.tobytes()
    assert read_attribute(file["frf_re"], "units") == "m/N"


def test_variables_share_dimensions_with_the_groups_above(file):
    """A coordinate at the root names the axis of a variable below."""
    write_axis(file, "frequency", 300, step=0.5, units="Hz", long_name="")
    group = file.create_group("modal/a")
    values = write_variable(group, "h", np.zeros((2, 300)), ("output", "frequency"))
    assert dimension_names(values) == ("output", "frequency")
    assert "frequency" not in group
    assert is_dimension_only(group["output"])
    assert not is_dimension_only(file["frequency"])


def test_values_that_do_not_fit_their_dimensions_are_refused(file):
    """Another length, another number of axes, nothing at all."""
    write_axis(file, "x", 3, step=1.0, units="m", long_name="")
    for values, dims in (
        (np.zeros(4), ("x",)),
        (np.zeros(3), ("x", "y")),
        ([], ("n",)),
    ):
        with pytest.raises(ShapeError):
            write_variable(file, "z", values, dims)
        if "z" in file:
            del file["z"]


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_reads_variables_axes_and_texts(tmp_path, engine):
    """Both engines, group by group, with dimensions, units and unpacked axes."""
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf" if engine == "h5netcdf" else "netCDF4")
    values = np.random.default_rng(2).normal(size=(2, 500))
    with new_file(tmp_path / "a.h5", **SCHEMA) as file:
        group = file.create_group("frf")
        write_axis(
            group, "frequency", 500, step=0.25, origin=10, units="Hz", long_name=""
        )
        write_variable(group, "h", values, ("output", "frequency"), units="m/N")
        write_texts(group, "label", ["a1", "µ2"], "output", long_name="")
    path = tmp_path / "a.h5"
    with xarray.open_dataset(path, group="frf", engine=engine) as dataset:
        assert dataset["h"].dims == ("output", "frequency")
        assert_array_equal(dataset["h"], values)
        assert_array_equal(dataset["frequency"], 10 + 0.25 * np.arange(500))
        assert list(dataset["label"].values) == ["a1", "µ2"]
        assert dataset["h"].attrs["units"] == "m/N"


def test_a_path_that_leads_nowhere_is_refused_in_plain_words(tmp_path):
    """The system's word, without HDF5's error number."""
    with (
        pytest.raises(UsageError, match="No such file or directory; choose") as caught,
        new_file(tmp_path / "no" / "r.h5", schema="a/1", title="a"),
    ):
        pass
    assert "errno" not in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_pipe_is_never_replaced_by_a_file(tmp_path: Path) -> None:
    """Not even where files may be overwritten."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with (
        pytest.raises(UsageError, match="is no file"),
        new_file(pipe, schema="x/1", title="x", overwrite=True),
    ):
        pass
    assert pipe.is_fifo()
