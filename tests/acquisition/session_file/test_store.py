"""The session file: exact, atomic, readable elsewhere."""

import dataclasses

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    ShapeError,
    UsageError,
)
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.acquisition.records.session import JointSetup, Session, new_session
from jointbench.acquisition.records.surfaces import Areal, Profile, SurfaceInstrument
from jointbench.acquisition.session_file.store import read_session, write_session

RNG = np.random.default_rng(4)


def recording(name="hit 1", samples=None):
    samples = RNG.normal(size=(2, 1000)) if samples is None else samples
    return Recording(
        name=name,
        samples=samples,
        sample_rate=25600.0,
        channels=(
            Channel("force", Quantity.FORCE, "1", "+z", "lbf", 2.25e-3, 444.0),
            Channel("a1", Quantity.ACCELERATION, "2", "", "g"),
        ),
        start_time=1 / 3,
        hits=(
            Hit(0, 10, 200, "1", 55.5, Verdict.OK, 0.1, "one peak only"),
            Hit(300, 310, 500, "1", 7.5, Verdict.WEAK, 0.05, "below 0.1 of the rest"),
        ),
        provenance=(step("import", file="a.csv", gain=1.5, count=3, raw=True),),
    )


def session():
    mask = RNG.random((6, 7)) > 0.2
    heights = np.where(mask, RNG.normal(size=mask.shape) * 1e-6, 0.0)
    instrument = SurfaceInstrument("VK", stylus_radius=2e-6, cutoff_long=8e-4)
    return new_session(
        source="sim:two-body?seed=1",
        simulated=True,
        operator="Müller",
        notes="first line\nsecond line",
        joint=JointSetup(4000.0, None, {"youngs_modulus": 2.06e11}, {"m1": 9.0}),
        recordings=(recording("z last"), recording("a first")),
        surfaces=(
            Areal("map", heights, (1e-6, 2.5e-7), mask, instrument, (step("import"),)),
            Profile("line", heights[0], 1e-7, mask[0]),
        ),
        provenance=(step("measure", plan="a.toml"),),
    )


def assert_same(one: Session, other: Session) -> None:
    """Every field equal, every array equal to the bit."""
    # repr shows all scalars to the last digit and NaN as nan, which == does not equal.
    assert _scalars(one) == _scalars(other)
    for a, b in zip(_arrays(one), _arrays(other), strict=True):
        assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())


def _scalars(whole):
    fields = [
        repr(getattr(whole, f.name))
        for f in dataclasses.fields(whole)
        if f.name not in {"recordings", "surfaces"}
    ]
    for record in (*whole.recordings, *whole.surfaces):
        fields += [
            repr(getattr(record, f.name))
            for f in dataclasses.fields(record)
            if f.name not in {"samples", "heights", "valid"}
        ]
    return fields


def _arrays(whole):
    for record in whole.recordings:
        yield record.samples
    for surface in whole.surfaces:
        yield surface.heights
        yield surface.valid


def test_a_session_comes_back_to_the_bit(tmp_path):
    """Samples, hits, masks, instruments, setup and provenance, in their order."""
    whole = session()
    write_session(whole, tmp_path / "s.h5")
    assert_same(read_session(tmp_path / "s.h5"), whole)


def test_each_recording_keeps_its_own_preload(tmp_path):
    """And one without is stored as such, as in earlier files."""
    loose, tight, plain = (recording(name) for name in ("loose", "tight", "plain"))
    loose = dataclasses.replace(loose, preload=2000.0)
    tight = dataclasses.replace(tight, preload=8000.0)
    whole = dataclasses.replace(session(), recordings=(loose, tight, plain))
    write_session(whole, tmp_path / "s.h5")
    with h5py.File(tmp_path / "s.h5") as file:
        assert "preload" not in file["stream/plain"].attrs
    read = read_session(tmp_path / "s.h5").recordings
    assert [r.preload for r in read] == [2000.0, 8000.0, None]


def test_an_empty_session_comes_back(tmp_path):
    """No setup is not the same as a setup of which nothing is known."""
    for joint in (None, JointSetup()):
        whole = new_session(source="", simulated=False, joint=joint)
        write_session(whole, tmp_path / "s.h5", overwrite=True)
        assert_same(read_session(tmp_path / "s.h5"), whole)


TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"))
NAME = TEXT.filter(bool)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(1e-9, 1e9)
INDEX = st.integers(0, 2**62)
STEPS = st.lists(
    st.builds(
        Step,
        TEXT,
        st.lists(
            st.tuples(TEXT, st.one_of(TEXT, FINITE, st.integers(), st.booleans()))
        ).map(tuple),
    ),
    max_size=3,
).map(tuple)
HITS = st.lists(
    st.builds(
        Hit,
        INDEX,
        INDEX,
        INDEX,
        TEXT,
        st.floats(),
        st.sampled_from(Verdict),
        st.floats(),
        TEXT,
    ),
    max_size=4,
).map(tuple)


@st.composite
def recordings(draw):
    shape = draw(st.tuples(st.integers(1, 3), st.integers(1, 40)))
    width = draw(st.sampled_from([32, 64]))
    kind = st.floats(allow_nan=False, allow_infinity=False, width=width)
    names = draw(st.lists(TEXT, min_size=shape[0], max_size=shape[0], unique=True))
    return Recording(
        name=draw(NAME),
        samples=draw(arrays.arrays(np.float64, shape, elements=kind)),
        sample_rate=draw(POSITIVE),
        channels=tuple(
            Channel(
                name,
                draw(st.sampled_from(Quantity)),
                *draw(st.tuples(TEXT, TEXT, TEXT)),
                draw(st.none() | FINITE),
                draw(st.none() | FINITE),
            )
            for name in names
        ),
        start_time=draw(FINITE),
        hits=draw(HITS),
        provenance=draw(STEPS),
        preload=draw(st.none() | POSITIVE),
    )


@st.composite
def surfaces(draw):
    dims = draw(st.integers(1, 2))
    shape = draw(arrays.array_shapes(min_dims=dims, max_dims=dims, max_side=8))
    values = arrays.arrays(np.float64, shape, elements=FINITE)
    known = st.none() | FINITE
    common = {
        "name": draw(NAME),
        "heights": draw(values),
        "valid": draw(arrays.arrays(np.bool_, shape)),
        "instrument": SurfaceInstrument(draw(TEXT), *(draw(known) for _ in range(4))),
        "provenance": draw(STEPS),
    }
    if dims == 1:
        return Profile(spacing=draw(POSITIVE), **common)
    return Areal(spacing=(draw(POSITIVE), draw(POSITIVE)), **common)


def unique(records):
    return st.lists(records, max_size=3, unique_by=lambda record: record.name).map(
        tuple
    )


@settings(max_examples=40, deadline=None)
@given(
    whole=st.builds(
        Session,
        *[TEXT] * 3,
        st.booleans(),
        *[TEXT] * 3,
        st.none()
        | st.builds(
            JointSetup,
            st.none() | FINITE,
            st.none() | FINITE,
            st.dictionaries(TEXT, FINITE),
            st.dictionaries(TEXT, POSITIVE),
        ),
        unique(recordings()),
        unique(surfaces()),
        STEPS,
    )
)
def test_any_session_comes_back_to_the_bit(whole, tmp_path_factory):
    """Whatever names, texts, numbers and masks it holds."""
    path = tmp_path_factory.getbasetemp() / "any.h5"
    write_session(whole, path, overwrite=True)
    assert_same(read_session(path), whole)


def test_a_session_that_is_there_is_not_overwritten_unless_asked(tmp_path):
    """Raw data are written once."""
    path = tmp_path / "s.h5"
    write_session(session(), path)
    before = path.read_bytes()
    with pytest.raises(UsageError, match="exists already"):
        write_session(session(), path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["s.h5"]


def test_a_session_that_cannot_be_written_leaves_nothing(tmp_path):
    """A recording without samples, a text with a zero character."""
    empty = recording(samples=np.zeros((2, 0)))
    for bad in (empty, dataclasses.replace(recording(), name="a\0b")):
        whole = dataclasses.replace(session(), recordings=(bad,))
        with pytest.raises(BadData):
            write_session(whole, tmp_path / "s.h5")
    assert list(tmp_path.iterdir()) == []


def test_two_records_of_one_name_are_refused():
    """They could not be distinguished again."""
    with pytest.raises(ShapeError, match="'hit 1' twice"):
        new_session(source="", simulated=False, recordings=[recording(), recording()])


def test_samples_in_single_precision_are_stored_so_only_where_that_is_exact(tmp_path):
    """What a converter delivers as float32 takes half the room."""
    single = RNG.normal(size=(2, 1000)).astype(np.float32).astype(np.float64)
    whole = dataclasses.replace(
        session(), recordings=(recording("single", single), recording("double"))
    )
    write_session(whole, tmp_path / "s.h5")
    with h5py.File(tmp_path / "s.h5") as file:
        assert file["stream/single/samples"].dtype == np.float32
        assert file["stream/double/samples"].dtype == np.float64


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_every_group(tmp_path, engine):
    """A plain time axis in seconds, channel names, verdicts, masks."""
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf" if engine == "h5netcdf" else "netCDF4")
    whole = session()
    path = tmp_path / "s.h5"
    write_session(whole, path)

    def opened(group):
        return xarray.open_dataset(path, group=group, engine=engine)

    with opened("stream/z last") as stream:
        assert_array_equal(stream["samples"], whole.recordings[0].samples)
        np.testing.assert_allclose(
            stream["time"], 1 / 3 + np.arange(1000) / 25600, rtol=1e-14
        )
        assert stream["time"].attrs["units"] == "s"
        assert list(stream["channel_name"].values) == ["force", "a1"]
        assert stream.attrs["sample_rate"] == 25600.0
    with opened("hits/z last") as hits:
        meanings = hits["verdict"].attrs["flag_meanings"].split()
        assert [meanings[code] for code in hits["verdict"].values] == ["ok", "weak"]
        assert hits["peak_force"].attrs["units"] == "N"
    with opened("surfaces/map") as surface:
        assert surface["heights"].dims == ("y", "x")
        assert_array_equal(surface["valid"].values != 0, whole.surfaces[0].valid)
    for group in ("/", "setup", "provenance", "surfaces/line"):
        with opened(group) as dataset:
            dataset.load()


def damaged(path, change):
    write_session(session(), path)
    with h5py.File(path, "r+") as file:
        change(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda f: f["stream/z last"].__delitem__("samples"),
        lambda f: f["stream/z last"].attrs.__delitem__("sample_rate"),
        lambda f: f["stream/z last"].attrs.__setitem__("sample_rate", -1.0),
        lambda f: f["stream/z last"].attrs.__setitem__("preload", -1.0),
        lambda f: f["stream/z last"].attrs.__setitem__("preload", "much"),
        lambda f: f["stream/z last/samples"].__setitem__((0, 0), np.nan),
        lambda f: f["stream/z last/quantity"].__setitem__(0, 99),
        lambda f: f["surfaces/map"].__delitem__("valid"),
        lambda f: f["provenance/detail"].__setitem__((0, 0), b"x"),
        lambda f: f.attrs.__setitem__("schema", "jointbench-session/99"),
        lambda f: f.attrs.__delitem__("schema"),
        lambda f: (f.__delitem__("hits"), f.create_dataset("hits", data=1.0)),
        lambda f: (f.__delitem__("stream"), f.create_dataset("stream", data=1.0)),
    ],
)
def test_a_damaged_session_is_refused_in_one_line(tmp_path, change):
    """Something missing, out of range, or not what it should be."""
    damaged(tmp_path / "s.h5", change)
    with pytest.raises(FormatError, match=r"s\.h5") as caught:
        read_session(tmp_path / "s.h5")
    assert "\n" not in str(caught.value)


def test_a_flipped_bit_in_the_samples_is_noticed(tmp_path):
    """Each chunk carries a checksum."""
    path = tmp_path / "s.h5"
    write_session(session(), path)
    with h5py.File(path) as file:
        chunk = file["stream/z last/samples"].id.get_chunk_info(0)
    data = bytearray(path.read_bytes())
    data[chunk.byte_offset + chunk.size // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(FormatError, match="damaged"):
        read_session(path)


def test_a_session_cut_short_is_refused(tmp_path):
    """A copy that broke off."""
    path = tmp_path / "s.h5"
    write_session(session(), path)
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(FormatError, match="cut short"):
        read_session(path)
