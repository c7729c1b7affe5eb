"""Surfaces from plain tables of x and z, or x, y and z."""

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
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.surfaces import Areal, Profile

SURFACES = Path(__file__).parents[4] / "shared" / "data" / "surfaces"
shared = pytest.mark.skipif(not SURFACES.is_dir(), reason=f"no shared data: {SURFACES}")

HEIGHTS = np.round(np.random.default_rng(11).normal(size=(4, 5)), 3)  # [um]
MAP = "x:mm,y:mm,z:um"


def detail(surface):
    return {key: value for step in surface.provenance for key, value in step.detail}


def written(path, text, encoding="utf-8-sig"):
    path.write_bytes(text.encode(encoding))
    return path


def points(order, heights=HEIGHTS, drop=()):
    """Return x,y,z lines of a grid of 5 um by 10 um, in a scan order."""
    rows, columns = heights.shape
    places = [(j, i) for j in range(rows) for i in range(columns)]
    if order == "columns":
        places.sort(key=lambda place: (place[1], place[0]))
    elif order == "serpentine":
        places.sort(key=lambda place: (place[0], place[1] * (-1) ** place[0]))
    elif order == "shuffled":
        np.random.default_rng(5).shuffle(places)
    return "".join(
        f"{0.005 * i:.4f},{0.010 * j:.4f},{heights[j, i]:.3f}\n"
        for j, i in places
        if (j, i) not in drop
    )


@pytest.mark.parametrize("order", ["rows", "columns", "serpentine", "shuffled"])
def test_points_on_a_grid_become_a_map_in_any_scan_order(tmp_path, order):
    """The columns of the map run along x, its rows along y."""
    path = written(tmp_path / "a.txt", points(order), "ascii")
    surface = read_surface(path, columns=MAP)
    assert isinstance(surface, Areal)
    assert_allclose(surface.heights, HEIGHTS * 1e-6, rtol=1e-14)
    assert_allclose(surface.spacing, (10e-6, 5e-6), rtol=1e-12)


def test_points_that_were_not_written_become_missing(tmp_path):
    """Cells of the grid without a line are masked."""
    path = written(tmp_path / "a.txt", points("rows", drop={(0, 3), (2, 1)}), "ascii")
    surface = read_surface(path, columns=MAP)
    assert sorted(zip(*np.nonzero(~surface.valid), strict=True)) == [(0, 3), (2, 1)]
    assert surface.heights[2, 1] == 0
    assert_allclose(surface.heights[2, 2], HEIGHTS[2, 2] * 1e-6, rtol=1e-14)


def test_coordinates_that_wobble_stay_on_their_grid(tmp_path):
    """An encoder's noise of 5 % of the step makes no new grid lines."""
    rng = np.random.default_rng(8)
    j, i = np.divmod(np.arange(20), 5)
    x, y = (i + rng.uniform(-0.05, 0.05, 20), j + rng.uniform(-0.05, 0.05, 20))
    np.save(tmp_path / "a.npy", np.stack((x, y, HEIGHTS.ravel())))
    surface = read_surface(tmp_path / "a.npy", columns="x:um,y:um,z:um")
    assert_allclose(surface.heights, HEIGHTS * 1e-6, rtol=1e-14)
    assert_allclose(surface.spacing, (1e-6, 1e-6), rtol=0.03)


def test_points_that_form_no_grid_are_refused(tmp_path):
    """Scattered points are not forced onto a grid."""
    np.save(tmp_path / "a.npy", np.random.default_rng(2).uniform(size=(3, 200)))
    with pytest.raises(FormatError, match="grid"):
        read_surface(tmp_path / "a.npy", columns=MAP)


def test_a_point_written_twice_is_refused_by_both_lines(tmp_path):
    """Which of two heights is right is not for the importer to choose."""
    text = points("rows") + "0.0000,0.0000,1.0\n"
    with pytest.raises(FormatError, match="line 21 repeats the point of line 1"):
        read_surface(written(tmp_path / "a.txt", text, "ascii"), columns=MAP)


def test_rounded_x_is_laid_on_even_spacing_over_the_whole_length(tmp_path):
    """1500 um in 9600 points, x printed to 0.1 um: the spacing is L / (n - 1)."""
    x = np.linspace(0, 1500, 9600)
    z = np.sin(x)
    text = "x um,z um\n" + "".join(
        f"{a:.1f},{b:.5f}\n" for a, b in zip(x, z, strict=True)
    )
    path = written(tmp_path / "a.csv", text, "ascii")
    surface = read_surface(path, columns="x:um,z:um")
    assert isinstance(surface, Profile)
    assert_allclose(surface.spacing, 1500e-6 / 9599, rtol=1e-12)


def test_a_profile_traced_backwards_is_turned_round(tmp_path):
    """Heights follow their x."""
    path = written(tmp_path / "a.csv", "3,30\n2,20\n1,\n0,0\n", "ascii")
    surface = read_surface(path, columns="x:um,z:um")
    assert_allclose(surface.heights, [0, 0, 20e-6, 30e-6], rtol=1e-14)
    assert_array_equal(surface.valid, [True, False, True, True])


def test_a_gap_in_x_is_refused_by_its_line(tmp_path):
    """A profile that was cut out of the middle is not even."""
    text = "".join(f"{x},{x * x}\n" for x in [0, 1, 2, 3, 4, 7, 8, 9, 10, 11])
    with pytest.raises(SamplingError, match="line 6: x goes from 4 to 7 um"):
        read_surface(written(tmp_path / "a.csv", text, "ascii"), columns="x:um,z:um")


def test_a_code_for_missing_points_becomes_a_mask_once_it_is_said(tmp_path):
    """Unsaid it is refused with what to type, and what it says works."""
    z = [1.0, 2.0, -7777, 1.5, -7777, 1.2, 1.1, 1.9]
    text = "".join(f"{x},{h}\n" for x, h in enumerate(z))
    path = written(tmp_path / "a.csv", text, "ascii")
    with pytest.raises(FormatError, match="z:um!-7777,") as caught:
        read_surface(path, columns="x:um,z:um")
    for item, missing in (("z:um!-7777", 2), ("z:um!nan", 0)):
        assert item in str(caught.value)
        surface = read_surface(path, columns=f"x:um,{item}")
        assert np.sum(~surface.valid) == missing


def test_a_table_without_units_is_refused_with_what_to_type(tmp_path):
    """What it suggests is accepted."""
    path = written(tmp_path / "a.txt", points("rows"), "ascii")
    with pytest.raises(UnitError, match="--columns") as caught:
        read_surface(path)
    suggestion = str(caught.value).split("'")[-2]
    assert isinstance(read_surface(path, columns=suggestion), Areal)


@pytest.mark.parametrize(
    ("columns", "error"),
    [
        ("x:um,z:um", FormatError),
        ("x:um,y:um,z:N", UnitError),
        ("x:um,y:um,-", UsageError),
        ("y:um,z:um,-", UsageError),
        ("time:s,force:N,-", UsageError),
        ("x:um,x:um,z:um", UsageError),
    ],
)
def test_columns_that_make_no_surface_are_refused(tmp_path, columns, error):
    """Both z and x are needed, y may be there, and all are lengths."""
    path = written(tmp_path / "a.txt", points("rows"), "ascii")
    with pytest.raises(error) as caught:
        read_surface(path, columns=columns)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("data", [b"", b"\x00\x01" * 300, b"abc\n", bytes(range(256))])
def test_what_is_no_surface_is_refused(tmp_path, data):
    """Nothing, binary junk, prose."""
    path = tmp_path / "a.csv"
    path.write_bytes(data)
    with pytest.raises(BadData) as caught:
        read_surface(path, columns=MAP)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("code", [-25400, -9999, 1e30])
def test_a_known_code_far_outside_is_a_missing_point(tmp_path, code):
    """Masked without an option, where even a single one stands far out."""
    z = [1.0, 2.0, code, 1.5, 1.7, 1.2, 1.1, 1.9]
    path = written(tmp_path / "a.csv", "".join(f"{x},{h}\n" for x, h in enumerate(z)))
    surface = read_surface(path, columns="x:um,z:um")
    assert_array_equal(surface.valid, np.arange(8) != 2)
    assert surface.heights[2] == 0


def test_the_same_number_among_its_like_is_a_height(tmp_path):
    """A trench at -25400 nm is a trench."""
    z = [-25000.0, -25400.0, -25300.0, -25100.0]
    path = written(tmp_path / "a.csv", "".join(f"{x},{h}\n" for x, h in enumerate(z)))
    assert read_surface(path, columns="x:um,z:nm").valid.all()


def test_units_above_the_columns_are_taken(tmp_path):
    """UTF-16 with a counter and two lengths: x and height."""
    text = "index,x in µm,y in µm\r\n0,0.5,-1.5\r\n1,0.75,-1.25\r\n2,1.0,\r\n"
    surface = read_surface(written(tmp_path / "u.csv", text, "utf-16"))
    assert surface.spacing == pytest.approx(0.25e-6)
    assert_allclose(surface.heights[:2], [-1.5e-6, -1.25e-6])
    assert_array_equal(surface.valid, [True, True, False])


def test_a_height_beyond_all_instruments_is_refused_by_its_line(tmp_path):
    """Its square would overflow."""
    path = tmp_path / "p.csv"
    path.write_text("0,1e300\n1,2e300\n2,1.5e300\n")
    with pytest.raises(FormatError, match=r"p\.csv.*line 1: height is 1e\+300"):
        read_surface(path, columns="x:mm,z:um")


def test_a_large_code_of_missing_points_is_no_height(tmp_path):
    """Programs write 1e38 where there is no point."""
    path = tmp_path / "p.csv"
    path.write_text("0,1\n1,1e38\n2,3\n")
    surface = read_surface(path, columns="x:mm,z:um!1e38")
    assert_array_equal(surface.valid, [True, False, True])


@pytest.mark.parametrize(
    ("text", "columns", "place"),
    [
        ("0,\n1,\n2,\n", "x:mm,z:um", 2),
        ("0,nan\n1,nan\n2,nan\n", "x:mm,z:um", 2),
        ("0,,5\n1,,5\n2,,5\n", "x:mm,z:um,-", 2),
    ],
)
def test_heights_that_are_all_missing_are_called_so(tmp_path, text, columns, place):
    """Not a file with too few columns."""
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(FormatError, match=f"column {place} .*'z'.* holds no value"):
        read_surface(path, columns=columns)


@shared
def test_real_scans_of_x_y_z_lines_become_maps():
    """101 by 101 points, 5 um apart."""
    surface = read_surface(SURFACES / "nanovea" / "test1.txt", columns=MAP)
    assert surface.heights.shape == (101, 101)
    assert_allclose(surface.spacing, (5e-6, 5e-6), rtol=1e-12)
    assert_allclose(surface.heights[1, 2], 479.3868e-6, rtol=0.02)
