"""Surfaces from instrument files and plain tables."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jointbench.acquisition.errors import (
    BadData,
    FormatError,
    SamplingError,
    UnitError,
    UsageError,
)
from jointbench.acquisition.import_surfaces import read_surface
from jointbench.acquisition.surfaces import Areal, Profile

SURFACES = Path(__file__).parents[3] / "shared" / "data" / "surfaces"
shared = pytest.mark.skipif(not SURFACES.is_dir(), reason=f"no shared data: {SURFACES}")

HEIGHTS = np.round(np.random.default_rng(11).normal(size=(4, 5)), 3)  # [um]
MAP = "x:mm,y:mm,z:um"


def detail(surface):
    return {key: value for step in surface.provenance for key, value in step.detail}


# --- Keyence ---------------------------------------------------------------------


def keyence(
    heights=HEIGHTS,
    *,
    unit="um",
    pitch=("276.923", "nm"),
    rows=None,
    separator=",",
    label="Height",
    extra=(),
):
    """Return the text of an image CSV as the English analyser writes it."""
    cells = [["" if np.isnan(z) else f"{z:.3f}" for z in row] for row in heights]
    table = [
        ["Measured date", "2025-03-21 11:43:55"],
        ["Model", "VK-X3000 Series"],
        ["Data type\r\n", "ImageDataCsv"],
        *extra,
        ["XY Calibration", *pitch],
        ["Output image data", label],
        ["Horizontal", str(heights.shape[1])],
        ["Vertical", str(rows or heights.shape[0])],
        ["Unit", unit],
        ["Reference data name", ""],
    ]
    lines = [separator.join(f'"{cell}"' for cell in row) for row in table]
    lines += ["", '"Height"']
    lines += [separator.join(f'"{cell}"' for cell in row) for row in cells]
    return "\r\n".join(lines) + "\r\n"


def written(path, text, encoding="utf-8-sig"):
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_keyence_image_is_read(tmp_path, encoding, separator):
    """A key with a line break in its cell, a byte-order mark, any separator."""
    path = written(tmp_path / "k.csv", keyence(separator=separator), encoding)
    surface = read_surface(path)
    assert isinstance(surface, Areal)
    assert_allclose(surface.heights, HEIGHTS * 1e-6, rtol=1e-14)
    assert_allclose(surface.spacing, (276.923e-9, 276.923e-9), rtol=1e-14)
    assert surface.valid.all()
    assert surface.instrument.name == "VK-X3000 Series"
    assert detail(surface)["format"] == "Keyence image CSV, English"


@pytest.mark.parametrize(("unit", "factor"), [("um", 1e-6), ("nm", 1e-9), ("mm", 1e-3)])
def test_the_unit_of_keyence_heights_is_the_one_in_the_header(tmp_path, unit, factor):
    """VK writes um or nm, VR writes mm and a pitch in um."""
    text = keyence(unit=unit, pitch=("7.5", "um"))
    surface = read_surface(written(tmp_path / "k.csv", text))
    assert_allclose(surface.heights, HEIGHTS * factor, rtol=1e-14)
    assert_allclose(surface.spacing[0], 7.5e-6, rtol=1e-14)


def test_empty_cells_become_a_mask_in_their_own_place(tmp_path):
    """Not zeros, not shifted columns; exact zeros stay points."""
    heights = HEIGHTS.copy()
    heights[1, 2] = heights[3, 4] = np.nan
    heights[0, 0] = 0.0
    surface = read_surface(written(tmp_path / "k.csv", keyence(heights)))
    assert_array_equal(surface.valid, ~np.isnan(heights))
    assert_allclose(surface.heights, np.nan_to_num(heights) * 1e-6, rtol=1e-14)
    assert detail(surface)["missing_points"] == 2


def test_header_rows_that_other_models_add_do_not_matter(tmp_path):
    """The label row is found by its content."""
    extra = [["Resolution", "1024x768"], ["Measurement Mode", "Surface profile"]]
    surface = read_surface(written(tmp_path / "k.csv", keyence(extra=extra)))
    assert surface.heights.shape == HEIGHTS.shape
    assert detail(surface)["measurement_mode"] == "Surface profile"


def test_fewer_rows_than_declared_are_said_in_the_provenance(tmp_path):
    """A public file declares 15 rows and has 13."""
    surface = read_surface(written(tmp_path / "k.csv", keyence(rows=6)))
    assert surface.heights.shape == (4, 5)
    assert detail(surface)["completeness"] == "declares 6 rows, holds 4"


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        (lambda t: t.replace(".", ","), FormatError, "decimal comma"),
        (
            lambda t: t.replace(f'"{HEIGHTS[0, 0]:.3f}"', '"0,5"'),
            FormatError,
            "line 13",
        ),
        (lambda t: t[:-20], FormatError, "cut short|do not close"),
        (lambda t: t[: t.index('\r\n"Height"')], FormatError, "ends before a row"),
        (lambda t: t.replace('"um"', '"parsec"'), UnitError, "k.csv.*length"),
        (lambda t: t.replace('"um"', '""'), FormatError, "no value for the unit"),
        (lambda t: t.replace(',"nm"', ""), UnitError, "k.csv.*length"),
        (lambda t: t.replace('data","Height', 'data","Color'), FormatError, "'Color'"),
        (lambda t: t.replace('"Vertical","4"', '"Vertical","2"'), FormatError, "more"),
        (
            lambda t: t.replace("XY Calibration", "Calibrazione XY"),
            FormatError,
            "not readable as English, German, Japanese, Chinese",
        ),
        (lambda t: t.replace("276.923", "0"), FormatError, "above zero"),
        (
            lambda t: t.replace('"Vertical","4"', '"Vertical","4e99"'),
            BadData,
            "at most",
        ),
    ],
)
def test_a_keyence_image_that_is_not_whole_is_refused(tmp_path, change, error, says):
    """One line each that says what is wrong."""
    path = written(tmp_path / "k.csv", change(keyence()))
    with pytest.raises(error, match=says) as caught:
        read_surface(path)
    assert "\n" not in str(caught.value)


@shared
@pytest.mark.parametrize(
    ("name", "language", "encoding"),
    [
        ("de_cp1252", "German", "cp1252"),
        ("de_semicolon", "German", "cp1252"),
        ("ja_cp932", "Japanese", "cp932"),
    ],
)
def test_other_languages_hold_the_same_map(name, language, encoding):
    """Bit for bit what the English file holds."""
    english = read_surface(SURFACES / "formats" / "SYNTHETIC_vk_en_utf8.csv")
    other = read_surface(SURFACES / "formats" / f"SYNTHETIC_vk_{name}.csv")
    assert_array_equal(other.heights, english.heights)
    assert other.spacing == english.spacing
    assert detail(other)["format"] == f"Keyence image CSV, {language}"
    assert detail(other)["encoding"] == encoding


# --- Surfcom -----------------------------------------------------------------------


def surfcom(heights, *, length="10.00000", count=None):
    rows = [length, str(count or len(heights)), *(f"{z:.4f}" for z in heights)]
    return "\r\n".join(rows) + "\r\n"


@pytest.mark.parametrize("name", ["a.tx1", "a.TX2", "a.txt"])
def test_a_surfcom_profile_is_read_without_being_told_units(tmp_path, name):
    """Both units belong to the format; the count tells it where the ending does not."""
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


# --- plain tables --------------------------------------------------------------------


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
    """Scattered points are not laid on a grid by force."""
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


@shared
def test_real_scans_of_x_y_z_lines_become_maps():
    """101 by 101 points, 5 um apart."""
    surface = read_surface(SURFACES / "nanovea" / "test1.txt", columns=MAP)
    assert surface.heights.shape == (101, 101)
    assert_allclose(surface.spacing, (5e-6, 5e-6), rtol=1e-12)
    assert_allclose(surface.heights[1, 2], 479.3868e-6, rtol=0.02)


@pytest.mark.parametrize("code", [-25400, -9999, 1e30])
def test_a_known_code_far_outside_is_a_missing_point(tmp_path, code):
    """Masked without a word from the user, where even a single one stands far out."""
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


@shared
def test_surfcom_settings_beside_a_trace_are_kept():
    """TX3 of the same name states the cut-offs, in Spanish."""
    surface = read_surface(SURFACES / "surfcom" / "GI-EI.tx1")
    assert surface.instrument.cutoff_long == pytest.approx(2.5e-3)
    assert surface.instrument.cutoff_short == pytest.approx(25e-6)


# --- numbers no surface has ------------------------------------------------------


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
