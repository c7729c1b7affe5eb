"""Surfaces from the texts and binaries of instruments."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import (
    FormatError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.heights.vendor_binaries import is_vendor_name
from jointbench.acquisition.records.surfaces import Profile

SURFACES = Path(__file__).parents[4] / "shared" / "data" / "surfaces"
shared = pytest.mark.skipif(not SURFACES.is_dir(), reason=f"no shared data: {SURFACES}")

HEIGHTS = np.round(np.random.default_rng(11).normal(size=(4, 5)), 3)  # [um]


def detail(surface):
    return {key: value for step in surface.provenance for key, value in step.detail}


def written(path, text, encoding="utf-8-sig"):
    path.write_bytes(text.encode(encoding))
    return path


# --- Surfcom ---


def surfcom(heights, *, length="10.00000", count=None):
    rows = [length, str(count or len(heights)), *(f"{z:.4f}" for z in heights)]
    return "\r\n".join(rows) + "\r\n"


@pytest.mark.parametrize("name", ["a.tx1", "a.TX2", "a.txt"])
def test_a_surfcom_profile_is_read_without_given_units(tmp_path, name):
    """Both units belong to the format; the count shows it without a suffix."""
    path = written(tmp_path / name, surfcom(HEIGHTS.ravel()), "ascii")
    surface = read_surface(path)
    assert isinstance(surface, Profile)
    assert_allclose(surface.heights, HEIGHTS.ravel() * 1e-6, rtol=1e-14)
    assert_allclose(surface.length, 10e-3, rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (surfcom(HEIGHTS.ravel(), count=21), "declares 21 points and holds 20"),
        (surfcom(HEIGHTS.ravel(), length="x"), "line 1"),
        (surfcom(HEIGHTS.ravel(), count="many"), "line 2"),
        ("10\n3\n1.0\nx7\n2.0\n", "line 4.*'x7'"),
        ("10\n", "line 2"),
    ],
)
def test_a_surfcom_profile_that_is_not_whole_is_refused(tmp_path, text, says):
    """A cut copy has fewer heights than declared."""
    with pytest.raises(FormatError, match=says):
        read_surface(written(tmp_path / "a.tx1", text, "ascii"))


@shared
def test_real_surfcom_traces_are_read():
    """28,087 points on 10 mm."""
    for path in sorted((SURFACES / "surfcom").glob("*.tx1")):
        surface = read_surface(path)
        assert surface.heights.shape == (28087,)
        assert_allclose(surface.spacing, 10e-3 / 28086, rtol=1e-12)


@shared
def test_surfcom_settings_beside_a_trace_are_kept():
    """TX3 of the same name states the cut-offs, in Spanish."""
    surface = read_surface(SURFACES / "surfcom" / "GI-EI.tx1")
    assert surface.instrument.cutoff_long == pytest.approx(2.5e-3)
    assert surface.instrument.cutoff_short == pytest.approx(25e-6)


@shared
@pytest.mark.parametrize(
    "name", ["plu-1.plu", "x3p-2.x3p", "opdx-3.opdx", "sdf-1.sdf", "metropro-1.dat"]
)
def test_a_vendor_file_agrees_with_the_public_reader(name):
    """Heights and pitch; SurfaceTopography counts x first and whole cells."""
    reader = pytest.importorskip("SurfaceTopography")
    topography = reader.read_topography(str(SURFACES / "various" / name))
    metres = {"µm": 1e-6, "um": 1e-6, "mm": 1e-3, "m": 1.0, "nm": 1e-9}
    scale = metres[topography.unit]
    surface = read_surface(SURFACES / "various" / name)
    assert_allclose(surface.heights, topography.heights().T * scale, rtol=1e-12)
    pitch = np.array(topography.physical_sizes) / topography.nb_grid_pts * scale
    assert_allclose(np.ravel(surface.spacing)[::-1], pitch, rtol=1e-9)


@shared
def test_a_public_reader_that_is_wrong_by_a_million_is_not_believed():
    """NMS: 160 m wide by the public reader, 160 um by the file's own header."""
    pytest.importorskip("SurfaceTopography")
    with pytest.raises(FormatError, match="scale is wrong"):
        read_surface(SURFACES / "various" / "nms-1.nms")


@shared
def test_a_dektak_trace_has_even_steps_and_its_stylus():
    """X is printed to 0.1 um; 1499.8 um over 9599 steps."""
    surface = read_surface(SURFACES / "various" / "dektak-1.csv")
    assert isinstance(surface, Profile)
    assert surface.spacing == pytest.approx(0.15625e-6, rel=2e-5)
    assert surface.heights[0] == pytest.approx(-0.00933e-6)
    assert surface.instrument.stylus_radius == pytest.approx(2.5e-6)


# --- Mitutoyo SJ and Mahr -------------------------------------------------------

PITCH = "z:um@0.5um"


def mitutoyo(heights, *, count=None):
    """Return profile points as the manual of the SJ-301 shows them."""
    left = ["DATE2025/03/21,TIME 11:43:55", "JIS1994", "profile=R"]
    left += [""] * (len(heights) - len(left))
    left[0] = f'"{left[0]}"'
    rows = [f'"plate 1",{count or len(heights)}']
    rows += [f"{cell},{z:.2f}" for cell, z in zip(left, heights, strict=True)]
    return "\r\n".join(rows) + "\r\n"


def mahr(counts, *, resolution="0.00025"):
    """Return a profile as whole numbers below a resolution in um."""
    head = ["MarSurf M300", "D-PROFILE", f"RES={resolution}"]
    return "\r\n".join([*head, *(str(n) for n in counts)]) + "\r\n"


def test_mitutoyo_points_need_their_unit_and_distance(tmp_path):
    """The manual shows neither in the file: asked for, then taken as given."""
    path = written(tmp_path / "a.csv", mitutoyo(HEIGHTS.ravel()), "ascii")
    with pytest.raises(UnitError, match=r"does not say the unit.*z:um@0\.5um"):
        read_surface(path)
    surface = read_surface(path, columns=PITCH)
    assert isinstance(surface, Profile)
    assert_allclose(surface.heights, np.round(HEIGHTS.ravel(), 2) * 1e-6, atol=6e-9)
    assert surface.spacing == pytest.approx(0.5e-6)
    assert "profile=R" in detail(surface)["told"]


def test_mitutoyo_points_that_are_cut_short_are_refused(tmp_path):
    """Twenty of 8000 declared."""
    text = mitutoyo(HEIGHTS.ravel(), count=8000)
    with pytest.raises(FormatError, match="declares 8000 points and holds 20"):
        read_surface(written(tmp_path / "a.csv", text, "ascii"), columns=PITCH)


def test_mahr_counts_become_heights_by_the_resolution(tmp_path):
    """RES is in um a count; the distance is asked for."""
    path = written(tmp_path / "P000_001.TXT", mahr([4, -8, 12]), "ascii")
    with pytest.raises(UnitError, match="does not say the distance"):
        read_surface(path)
    surface = read_surface(path, columns=PITCH)
    assert_allclose(surface.heights, [1e-9, -2e-9, 3e-9])


def test_mahr_counts_broken_by_a_line_are_refused(tmp_path):
    """Not read from the break on."""
    text = mahr([4, 8, 12, "x", 5, 6, 7])
    with pytest.raises(FormatError, match="broken by line 7"):
        read_surface(written(tmp_path / "a.txt", text, "ascii"), columns=PITCH)


def test_heights_alone_are_a_profile_at_the_distance_given(tmp_path):
    """A single column, 0.5 um apart; a distance beside x is refused."""
    path = tmp_path / "z.txt"
    path.write_text("1.0\n2.0\n4.0\n")
    surface = read_surface(path, columns=PITCH)
    assert isinstance(surface, Profile)
    assert_allclose(surface.heights, [1e-6, 2e-6, 4e-6])
    assert surface.spacing == pytest.approx(0.5e-6)
    with pytest.raises(UsageError, match="leave one out"):
        read_surface(path, columns="x:um,z:um@0.5um")


def test_a_netcdf_map_of_the_public_library_is_read_with_its_gaps(tmp_path):
    """X counts first there, and a masked height is missing."""
    library = pytest.importorskip("SurfaceTopography")
    heights = np.ma.masked_greater(np.arange(12.0).reshape(3, 4) / 100, 0.105)
    made = library.Topography(heights, (3.0, 4.0), unit="um")
    made.to_netcdf(str(tmp_path / "map.nc"))
    found = read_surface(tmp_path / "map.nc")
    assert found.heights.shape == (4, 3)
    assert found.heights[2, 1] == pytest.approx(6e-8)
    assert found.valid.sum() == 11
    assert not found.valid[3, 2]


@pytest.mark.parametrize("ending", "tmd bcrf di ibw nid stp top mi nc".split())
def test_endings_of_makers_are_theirs(ending):
    assert is_vendor_name(Path(f"map.{ending}"))


@pytest.mark.parametrize(
    ("head", "columns"), [("", "x:um,z:um,valid"), ("x [um],z [um],valid\n", None)]
)
def test_a_column_of_validity_is_a_mask(tmp_path, head, columns):
    """A height of a point that is not there is no height, whatever it reads."""
    rows = [
        f"{k},{1e6 if k == 7 else 0.1 * (k % 3):.1f},{int(k != 7)}" for k in range(20)
    ]
    file = written(tmp_path / "a.csv", head + "\n".join(rows) + "\n")
    found = read_surface(file, columns=columns)
    assert np.flatnonzero(~found.valid).tolist() == [7]
    assert found.heights.max() == pytest.approx(2e-7)


def test_a_column_of_validity_holds_nothing_but_0_and_1(tmp_path):
    rows = [f"{k},{0.1 * (k % 3):.1f},{k}" for k in range(20)]
    file = written(tmp_path / "a.csv", "\n".join(rows) + "\n")
    with pytest.raises(FormatError, match="neither 0 nor 1"):
        read_surface(file, columns="x:um,z:um,valid")
