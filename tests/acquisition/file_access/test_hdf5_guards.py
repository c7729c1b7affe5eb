"""Hostile and broken HDF5 files: each is refused before a value is read."""

import time

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import FileLimits, open_guarded


def external_link(file, folder):
    file["stream"] = h5py.ExternalLink(str(folder / "secret.h5"), "/")


def soft_link(file, folder):
    file["stream"] = h5py.SoftLink("/elsewhere")


def hard_link_loop(file, folder):
    inner = file.create_group("a/b")
    inner["back"] = file["a"]


def link_to_the_root(file, folder):
    file.create_group("a")["root"] = file["/"]


def external_storage(file, folder):
    secret = folder / "secret.txt"
    secret.write_bytes(b"password")
    file.create_dataset("a", shape=(8,), dtype="i1", external=[(str(secret), 0, 8)])


def virtual_dataset(file, folder):
    layout = h5py.VirtualLayout((10,), "f8")
    layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "a", (10,))
    file.create_virtual_dataset("a", layout)


def eight_terabytes(file, folder):
    file.create_dataset("a", shape=(10**12,), dtype="f8")


def a_million_chunks(file, folder):
    file.create_dataset("a", shape=(10**6,), dtype="i1", chunks=(1,))


def bomb(file, folder):
    zeros = np.zeros(2**24)  # 134 MB in 140 kB
    file.create_dataset("a", data=zeros, compression="gzip", chunks=(2**20,))


def bomb_in_parts(file, folder):
    for i in range(20):
        zeros = np.zeros(2**20)
        file.create_dataset(f"a{i}", data=zeros, compression="gzip", chunks=(2**20,))


def one_value_in_a_huge_chunk(file, folder):
    file.create_dataset("a", (1,), "f8", maxshape=(None,), chunks=(2**28,))


def plugin_filter(file, folder):
    file.create_dataset("a", data=np.zeros(100), compression="lzf")


def variable_length_numbers(file, folder):
    file.create_dataset("a", shape=(3,), dtype=h5py.vlen_dtype("f8"))


def variable_length_texts(file, folder):
    file.create_dataset("a", data=["one", "two"])


def compound(file, folder):
    file.create_dataset("a", data=np.zeros(3, dtype=complex))


def reference(file, folder):
    file.create_dataset("a", data=file.ref, dtype=h5py.ref_dtype)


def too_many_groups(file, folder):
    for i in range(20_001):
        file.create_group(f"g{i}")


def groups_without_end(file, folder):
    file.create_group("/".join("g" * 40))


def null_extent(file, folder):
    file.create_dataset("a", data=h5py.Empty("f8"))


def named_type(file, folder):
    file["a"] = np.dtype("f8")


def attributes_without_end(file, folder):
    for i in range(300):
        file.attrs[f"a{i}"] = i


def attribute_of_references(file, folder):
    file.attrs.create("a", file.ref, dtype=h5py.ref_dtype)


HOSTILE = {
    external_link: "link to another file",
    soft_link: "soft link",
    hard_link_loop: "leads back",
    link_to_the_root: "leads back",
    external_storage: "in another file",
    virtual_dataset: "virtual dataset",
    eight_terabytes: "8000000000000 bytes",
    a_million_chunks: "chunks",
    bomb: "bytes of values",
    bomb_in_parts: "bytes of values",
    one_value_in_a_huge_chunk: "bytes of values",
    plugin_filter: "filter",
    variable_length_numbers: "neither numbers nor texts",
    variable_length_texts: "neither numbers nor texts",
    compound: "neither numbers nor texts",
    reference: "neither numbers nor texts",
    too_many_groups: "20001 objects",
    groups_without_end: "nested deeper",
    null_extent: "no extent",
    named_type: "neither a group nor a dataset",
    attributes_without_end: "300 attributes",
    attribute_of_references: "attribute of neither",
}


@pytest.mark.parametrize("make", HOSTILE, ids=lambda make: make.__name__)
def test_a_hostile_file_is_refused_with_object_and_rule(tmp_path, make):
    """One line that names the file, the object and what is wrong with it."""
    path = tmp_path / "hostile.h5"
    with h5py.File(path, "w") as file:
        make(file, tmp_path)
    with (
        pytest.raises(HostileFile, match=f"hostile.h5.*{HOSTILE[make]}") as caught,
        open_guarded(path),
    ):
        pass
    assert "\n" not in str(caught.value)


def test_an_attribute_as_large_as_a_dataset_is_refused(tmp_path):
    """The limit holds for one attribute."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.attrs["a"] = np.zeros(1000)
    with (
        pytest.raises(HostileFile, match="attribute of 8000 bytes"),
        open_guarded(path, limits=FileLimits(attribute_bytes=4000)),
    ):
        pass


def honest(path):
    rng = np.random.default_rng(1)
    with h5py.File(path, "w") as file:
        for i in range(50):
            group = file.create_group(f"stream/hit_{i}")
            data = rng.normal(size=(2, 4000))
            group.create_dataset("samples", data=data, compression="gzip", shuffle=True)
            group.attrs["name"] = f"hit {i}"
        file.create_dataset(
            "mask", data=np.ones((1000, 1000), "i1"), compression="gzip"
        )
    return path


def test_an_honest_file_opens_and_its_values_are_there(tmp_path):
    """Compressed samples and a mask that packs 1000:1."""
    with open_guarded(honest(tmp_path / "a.h5")) as file:
        assert file["mask"][...].all()
        assert len(file["stream"]) == 50


def test_the_look_over_costs_little(tmp_path):
    """A hundred objects are looked over in a fraction of a second of CPU."""
    path = honest(tmp_path / "a.h5")
    before = time.process_time()
    with open_guarded(path):
        pass
    assert time.process_time() - before < 0.5


@pytest.mark.parametrize("kept", [0, 3, 8, 60, 400, 0.3, 0.9, 0.999])
def test_a_file_cut_short_is_refused_in_one_line(tmp_path, kept):
    """Empty, only a signature, a half, all but the end."""
    data = honest(tmp_path / "a.h5").read_bytes()
    size = int(kept * len(data)) if isinstance(kept, float) else kept
    path = tmp_path / "cut.h5"
    path.write_bytes(data[:size])
    with pytest.raises(FormatError) as caught, open_guarded(path):
        pass
    assert "\n" not in str(caught.value)


def test_flipped_bytes_raise_bad_data_and_nothing_else(tmp_path):
    """A hundred damaged copies: opened, or refused in one line."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("g/a", data=np.arange(1000.0), compression="gzip")
        file["g"].attrs["name"] = "g"
    data = (tmp_path / "a.h5").read_bytes()
    rng = np.random.default_rng(17)
    refused = 0
    for _ in range(100):
        damaged = bytearray(data)
        for place in rng.integers(8, len(data), size=20):
            damaged[place] = rng.integers(256)
        (tmp_path / "b.h5").write_bytes(damaged)
        try:
            with open_guarded(tmp_path / "b.h5"):
                pass
        except BadData as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > 10


def test_what_is_no_hdf5_file_is_refused(tmp_path):
    """Text, a folder, no file at all."""
    (tmp_path / "a.txt").write_text("time,force\n0,1\n")
    for path in (tmp_path / "a.txt", tmp_path, tmp_path / "none.h5"):
        with pytest.raises(BadData) as caught, open_guarded(path):
            pass
        assert "\n" not in str(caught.value)
