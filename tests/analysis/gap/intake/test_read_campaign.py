# SPDX-License-Identifier: MIT
"""Campaign files of other programs: read as written, or refused in one line."""

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.analysis.gap.intake.read_campaign import (
    DEFAULT_PRELOAD,
    MAX_RECORDS,
    MAX_SAMPLES,
    read_campaign,
)
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.stated_scatter import StatedScatter

NOMINAL = {"m1": 8.0, "m2": 4.0, "k0": 2.4e7, "c0": 300.0, "kj": 6e7, "cj": 220.0}
SPREAD = dict.fromkeys(NOMINAL, 0.05)
RATE = 16384.0
SAMPLES = 512
LEVELS = (30.0, 300.0, 1000.0)
PRELOADS = (4000.0, 4000.0, 8000.0)
ABOVE_ZERO = (
    ("/", "fs_hz"),
    ("/", "preload_ref_N"),
    ("records/r01", "level_N"),
    ("records/r01", "preload_N"),
)
NUMBERS = (*ABOVE_ZERO, ("records/r01", "order"), ("records/r01", "hit_dof"))

Change = Callable[[h5py.File], None]


def sample(record: int) -> np.ndarray:
    """Return force and two accelerations of a record, shape (3, n_samples)."""
    return np.random.default_rng(record).standard_normal((3, SAMPLES))


def whole(path: Path) -> None:
    """Write a campaign as the format says."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "two-body-campaign/1"
        file.attrs["fs_hz"] = RATE
        file.attrs["preload_ref_N"] = 5000.0
        file.attrs["nominal"] = json.dumps(NOMINAL)
        file.attrs["nominal_rel_sigma"] = json.dumps(SPREAD)
        for i, (level, preload) in enumerate(zip(LEVELS, PRELOADS, strict=True)):
            record = file.create_group(f"records/r{i:02d}")
            record["force"] = sample(i)[0].astype(np.float32)
            record["accel"] = sample(i)[1:].astype(np.float32)
            record.attrs["level_N"] = level
            record.attrs["hit_dof"] = i % 2
            record.attrs["preload_N"] = preload
            record.attrs["order"] = i


def read_changed(folder: Path, change: Change) -> Campaign:
    """Write a campaign, change its file, and read it."""
    path = folder / "c.h5"
    whole(path)
    with h5py.File(path, "a") as file:
        change(file)
    return read_campaign(path)


def attribute(where: str, name: str, value: object) -> Change:
    """Return a change that gives an attribute another value."""

    def change(file: h5py.File) -> None:
        file[where].attrs[name] = value

    return change


def dataset(name: str, values: object, record: str = "r01") -> Change:
    """Return a change that puts other values in the place of a record's."""

    def change(file: h5py.File) -> None:
        del file[f"records/{record}/{name}"]
        file[f"records/{record}/{name}"] = values

    return change


def everywhere(name: str, values: object) -> Change:
    """Return a change that puts other values in the place of all records'."""

    def change(file: h5py.File) -> None:
        for record in file["records"]:
            dataset(name, values, record)(file)

    return change


def without(name: str) -> Change:
    """Return a change that takes an object out of the file."""

    def change(file: h5py.File) -> None:
        del file[name]

    return change


def without_attribute(where: str, name: str) -> Change:
    """Return a change that takes an attribute away."""

    def change(file: h5py.File) -> None:
        del file[where].attrs[name]

    return change


def group_for(name: str) -> Change:
    """Return a change that puts a group in the place of a dataset."""

    def change(file: h5py.File) -> None:
        del file[name]
        file.create_group(name)

    return change


def dataset_for(name: str) -> Change:
    """Return a change that puts a dataset in the place of a group."""

    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = np.zeros(SAMPLES)

    return change


def no_records(file: h5py.File) -> None:
    """Take every record away."""
    del file["records"]
    file.create_group("records")


def huge_accelerations(file: h5py.File) -> None:
    """Claim accelerations that no memory could hold, and store none."""
    del file["records/r01/accel"]
    file["records/r01"].create_dataset("accel", shape=(2, 10**12), dtype="f4")


def too_long(file: h5py.File) -> None:
    """Claim a sample more than a record can have, and store none.

    Of two records, so that the guard of the file's memory lets it through.
    """
    for name in sorted(file["records"])[2:]:
        del file["records"][name]
    for record in file["records"].values():
        del record["force"], record["accel"]
        record.create_dataset("force", shape=(MAX_SAMPLES + 1,), dtype="f4")
        record.create_dataset("accel", shape=(2, MAX_SAMPLES + 1), dtype="f4")


def too_many(file: h5py.File) -> None:
    """Claim a record more than a campaign can have."""
    for i in range(MAX_RECORDS - len(LEVELS) + 1):
        file.create_group(f"records/x{i:04d}")


def longer_record(file: h5py.File) -> None:
    """Make one record a sample longer than the others, in force and response."""
    dataset("force", np.zeros(SAMPLES + 1))(file)
    dataset("accel", np.zeros((2, SAMPLES + 1)))(file)


def bytes_no_text(file: h5py.File) -> None:
    """Store nominal parameters that are not text in any encoding."""
    file.attrs["nominal"] = np.bytes_(b"\xff\xfe{")


WRONG_SHAPES = [
    (dataset("accel", np.zeros((2, SAMPLES - 1))), "r01.*accel.*511"),
    (dataset("accel", np.zeros((3, SAMPLES))), "r01.*accel.*3, 512"),
    (dataset("accel", np.zeros(SAMPLES)), "r01.*accel"),
    (dataset("accel", 1.0), "r01.*accel"),
    (everywhere("accel", np.zeros((SAMPLES, 2))), "accel.*512, 2"),
    (dataset("force", 1.0), "r01.*force"),
    (everywhere("force", 1.0), "force"),
    (everywhere("force", np.zeros((2, SAMPLES))), "force.*2, 512"),
    (dataset("force", np.zeros(SAMPLES + 1)), r"r01.*accel.*\(2, 513\)"),
    (longer_record, "512, 513"),
]
WRONG_KINDS = [
    (dataset("force", np.full(SAMPLES, b"x")), "r01.*force.*numbers"),
    (dataset("accel", np.full((2, SAMPLES), b"1")), "r01.*accel.*numbers"),
    (group_for("records/r01/force"), "r01.*force"),
    (group_for("records/r01/accel"), "r01.*accel"),
    (dataset_for("records/r01"), "r01"),
    (dataset_for("records"), "records"),
    (without("records"), "records"),
    (without("records/r01/force"), "r01.*force"),
    (without("records/r01/accel"), "r01.*accel"),
]
WRONG_ATTRIBUTES = [
    *[
        (attribute(where, name, value), f"{name}.*number")
        for where, name in NUMBERS
        for value in ("x", "", "4 kN", np.zeros(2), h5py.Empty("f8"))
    ],
    *[
        (attribute(where, name, value), f"{name}.*above zero")
        for where, name in ABOVE_ZERO
        for value in (0.0, -1.0)
    ],
    *[
        (attribute(where, name, value), f"{name}.*finite")
        for where, name in NUMBERS
        for value in (np.nan, np.inf, "nan")
    ],
    *[(attribute("records/r01", "hit_dof", v), "r01.*0 or 1") for v in (2, -1, 0.5)],
    (attribute("/", "schema", np.zeros(3)), "schema"),
    (without_attribute("/", "schema"), "schema"),
    (without_attribute("/", "fs_hz"), "fs_hz"),
    *[
        (without_attribute("records/r01", name), f"r01.*{name}")
        for name in ("level_N", "preload_N", "order", "hit_dof")
    ],
]
WRONG_NOMINALS = [
    (attribute("/", name, text), name)
    for name in ("nominal", "nominal_rel_sigma")
    for text in (
        "[1, 2]",
        "8.0",
        '"m1"',
        "null",
        "{",
        "",
        "[" * 20_000,
        json.dumps({**NOMINAL, "m2": "heavy"}),
        json.dumps({**NOMINAL, "m2": [4.0]}),
        json.dumps({**NOMINAL, "m2": {}}),
        json.dumps({**NOMINAL, "m2": None}),
        json.dumps({**NOMINAL, "m2": 10**400}),
        '{"m2": ' + "4" * 5000 + "}",
    )
] + [
    (attribute("/", "nominal", 8.0), "nominal"),
    (attribute("/", "nominal", np.zeros(6)), "nominal"),
    (without_attribute("/", "nominal_rel_sigma"), "nominal_rel_sigma"),
    (bytes_no_text, "cannot be read"),
]


@pytest.mark.parametrize(
    ("change", "word"), WRONG_SHAPES + WRONG_KINDS + WRONG_ATTRIBUTES + WRONG_NOMINALS
)
def test_a_campaign_file_that_breaks_the_format_is_refused_in_one_line(
    tmp_path: Path, change: Change, word: str
) -> None:
    """`FormatError` names the file and its fault, on one line."""
    with pytest.raises(FormatError, match=word) as caught:
        read_changed(tmp_path, change)
    message = str(caught.value)
    assert "c.h5" in message
    assert "\n" not in message
    assert "; " in message


def test_the_scatter_to_expect_is_read(tmp_path: Path) -> None:
    """In SI units; a key left out states nothing."""
    text = json.dumps({"force_gain": 0.01, "force_delay": 1e-6})
    found = read_changed(tmp_path, attribute("/", "scatter_sd", text)).scatter
    assert found == StatedScatter(force_gain=0.01, force_delay=1e-6)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("[1]", "JSON object"),
        ("{", "JSON"),
        ('{"force": 0.01}', "'force'.*force_gain"),
        ('{"force_gain": "1 %"}', "without a unit"),
        ('{"force_gain": 0}', "above 0"),
        ('{"force_delay": 1.0}', "below 0.001"),
    ],
)
def test_an_impossible_scatter_is_refused(tmp_path: Path, text: str, word: str) -> None:
    """The message names the key and the rule."""
    with pytest.raises((FormatError, BadData), match=word):
        read_changed(tmp_path, attribute("/", "scatter_sd", text))


@pytest.mark.parametrize("value", [0.0, -4.0, np.nan, np.inf])
def test_an_impossible_nominal_value_is_refused(tmp_path: Path, value: float) -> None:
    """The message names the value and the key."""
    change = attribute("/", "nominal", json.dumps({**NOMINAL, "m2": value}))
    with pytest.raises(BadData, match="m2"):
        read_changed(tmp_path, change)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (huge_accelerations, "r01/accel"),
        (too_long, "1048577 samples"),
        (too_many, "1025 records"),
        (no_records, "0 records"),
    ],
)
def test_a_campaign_that_claims_more_or_less_than_any_is_refused_unread(
    tmp_path: Path, change: Change, word: str
) -> None:
    """Eight terabytes of accelerations are not read; no record is no campaign."""
    with pytest.raises(HostileFile, match=word):
        read_changed(tmp_path, change)


def test_accelerations_of_a_wrong_shape_are_refused_before_a_sample_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only shapes are read."""

    def unwanted(*_: object, **__: object) -> None:
        pytest.fail("samples were read")

    monkeypatch.setattr(h5py.Dataset, "__getitem__", unwanted)
    monkeypatch.setattr(h5py.Dataset, "__array__", unwanted)
    with pytest.raises(FormatError, match="'accel' of shape"):
        read_changed(tmp_path, dataset("accel", np.zeros((3, SAMPLES))))


@pytest.mark.parametrize("name", ["force", "accel"])
def test_an_infinite_sample_is_reported_with_its_record(
    tmp_path: Path, name: str
) -> None:
    """Infinite in one record: the message names it."""

    def spoil(file: h5py.File) -> None:
        file[f"records/r02/{name}"][..., 7] = np.inf

    with pytest.raises(BadData, match="r02"):
        read_changed(tmp_path, spoil)


@pytest.mark.parametrize("content", [b"", b"text", b"\x89HDF\r\n\x1a\n"])
def test_a_file_that_is_no_hdf5_is_refused(tmp_path: Path, content: bytes) -> None:
    """Empty, something else, or nothing but a signature."""
    path = tmp_path / "c.h5"
    path.write_bytes(content)
    with pytest.raises(FormatError, match=r"c\.h5"):
        read_campaign(path)


def test_a_file_that_is_not_there_is_called_so(tmp_path: Path) -> None:
    """The name may be wrong; the message does not mention the format."""
    with pytest.raises(BadData, match="No such file"):
        read_campaign(tmp_path / "c.h5")


def test_a_whole_campaign_is_read_as_it_was_written(tmp_path: Path) -> None:
    """Samples, conditions and nominal parameters."""
    path = tmp_path / "c.h5"
    whole(path)
    read = read_campaign(path)
    assert (read.name, read.sample_rate, read.preload_reference) == ("c", RATE, 5000.0)
    for i in range(3):
        written = sample(i).astype(np.float32)
        assert np.array_equal(read.force[i], written[0])
        assert np.array_equal(read.response[i], written[1:])
    assert read.level.tolist() == list(LEVELS)
    assert read.preload.tolist() == list(PRELOADS)
    assert read.hit.tolist() == [0, 1, 0]
    assert read.hit.dtype.kind == "i"
    assert read.order.tolist() == [0.0, 1.0, 2.0]
    assert read.model.bodies[1].mass == 4.0


def harmless(file: h5py.File) -> None:
    """Write what the format leaves open in other ways than usual."""
    del file.attrs["preload_ref_N"]
    file.attrs["fs_hz"] = np.array([RATE])
    file.attrs["remark"] = "nothing to see"
    file.attrs["schema"] = np.bytes_(b"two-body-campaign/1")
    file.attrs["nominal"] = json.dumps({**NOMINAL, "m2": 4, "maker": "us"})
    record = file["records/r01"]
    record.attrs["hit_dof"] = 1.0
    record.attrs["order"] = -3
    record.attrs["level_N"] = np.float32(1e-3)
    dataset("force", np.ones(SAMPLES, dtype=np.int16))(file)
    del record["accel"]
    record.create_dataset("accel", data=np.ones((2, SAMPLES)), compression="gzip")


def test_what_the_format_leaves_open_is_no_reason_to_refuse(tmp_path: Path) -> None:
    """Other number types, packed samples, notes, and no reference preload."""
    read = read_changed(tmp_path, harmless)
    assert read.preload_reference == DEFAULT_PRELOAD
    assert read.sample_rate == RATE
    assert (read.hit[1], read.order[1]) == (1, -3.0)
    assert np.all(read.force[1] == 1.0)
    assert read.model.bodies[1].mass == 4.0
