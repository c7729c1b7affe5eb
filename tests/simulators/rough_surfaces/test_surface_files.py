"""What the writers write, the readers read: vendor files of simulated surfaces."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.simulators.rough_surfaces.rough_surface import rough_map, rough_profile
from jointbench.simulators.rough_surfaces.surface_files import (
    ENCODINGS,
    write_dektak,
    write_keyence_csv,
    write_surfcom,
    write_utf16_table,
    write_wyko,
)

MAP = rough_map(12, 20, spacing=0.25e-6, dimension=1.5, roughness=1e-9, seed=1)
LINE = rough_profile(400, spacing=0.15625e-6, dimension=1.4, roughness=1e-9, seed=2)


def holed(areal):
    """Return the map with a tenth of its points missing."""
    valid = np.random.default_rng(1).random(areal.heights.shape) > 0.1
    return replace(areal, heights=np.where(valid, areal.heights, 0.0), valid=valid)


@pytest.mark.parametrize("delimiter", [",", ";"])
def test_a_map_in_four_languages_reads_back_bit_equal(tmp_path, delimiter):
    """Heights, mask and pitch of all four are the same numbers."""
    seen = []
    for language in ENCODINGS:
        path = tmp_path / f"{language}.csv"
        write_keyence_csv(holed(MAP), path, language=language, delimiter=delimiter)
        seen.append(read_surface(path))
        said = dict(seen[-1].provenance[1].detail)
        assert said["format"] == f"Keyence image CSV, {language}"
        assert said["encoding"] == ENCODINGS[language]
    for other in seen[1:]:
        assert_array_equal(other.heights, seen[0].heights)
        assert_array_equal(other.valid, seen[0].valid)
        assert other.spacing == seen[0].spacing
    assert_allclose(seen[0].heights, holed(MAP).heights, atol=0.6e-10)


def test_a_height_that_lost_its_point_is_refused(tmp_path):
    """It exceeds the maximum that the header states."""
    path = tmp_path / "k.csv"
    write_keyence_csv(MAP, path)
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    lines[-1] = lines[-1].replace("0.", "", 1)
    path.write_text("\n".join(lines), encoding="utf-8-sig")
    with pytest.raises(FormatError, match="beyond its"):
        read_surface(path)


def test_wyko_keeps_missing_points_and_both_pitches(tmp_path):
    """The word "Bad" is a gap; each line of the file is a row."""
    areal = replace(holed(MAP), spacing=(0.5e-6, 0.25e-6))
    write_wyko(areal, tmp_path / "w.asc")
    found = read_surface(tmp_path / "w.asc")
    assert_array_equal(found.valid, areal.valid)
    assert_allclose(found.heights, areal.heights, atol=1e-13)
    assert_allclose(found.spacing, areal.spacing, rtol=1e-8)


def test_a_wyko_text_agrees_with_the_public_reader(tmp_path):
    """SurfaceTopography finds the same heights and pixels."""
    reader = pytest.importorskip("SurfaceTopography")
    write_wyko(MAP, tmp_path / "w.asc")
    topography = reader.read_topography(str(tmp_path / "w.asc"))
    found = read_surface(tmp_path / "w.asc")
    assert topography.unit == "nm"
    assert_allclose(topography.heights().T * 1e-9, found.heights, rtol=1e-9)
    sizes = np.array(topography.physical_sizes) * 1e-9 / topography.nb_grid_pts
    assert_allclose(found.spacing[::-1], sizes, rtol=1e-9)


@pytest.mark.parametrize("kind", ["surfcom", "dektak", "utf16"])
def test_a_profile_reads_back(tmp_path, kind):
    """Heights to the printed digit, the pitch to its own."""
    path = tmp_path / {"surfcom": "p.tx1", "dektak": "p.csv", "utf16": "p.txt"}[kind]
    if kind == "surfcom":
        write_surfcom(LINE, path)
    elif kind == "dektak":
        write_dektak(LINE, path, stylus_radius=2e-6)
    else:
        write_utf16_table(LINE, path)
    found = read_surface(path)
    assert_allclose(found.heights, LINE.heights, atol=0.6e-10)
    assert_allclose(found.spacing, LINE.spacing, rtol=2e-3)


def zygo(phase, *, xyz=False):
    """Return a Zygo text with 2 columns and 2 rows, pixel 1.5 um."""
    head = [
        "Zygo XYZ Data File - Format 1" if xyz else "Zygo ASCII Data File - Format 2"
    ]
    head += ['0 0 0 0 "date"', "0 0 0 0 0 0", "0 0 2 2", '""', '""', '""']
    head += ["0 0.5 6.328e-07 0 1 0 1.5e-06 0", "0 0 0 0 0 0", "0 0", "1 1 20", "0 0"]
    return "\n".join([*head, "1 0", '""', "#", *phase, "#"]) + "\n"


def test_zygo_phases_become_heights(tmp_path):
    """Scale x wavelength x obliquity / 32768 of a count; invalid ones are gaps."""
    path = tmp_path / "z.asc"
    path.write_text(zygo(["#", "32768 0 -32768", "2147483640"]))
    found = read_surface(path)
    assert_allclose(found.heights, [[0.5 * 632.8e-9, 0], [-0.5 * 632.8e-9, 0]])
    assert_array_equal(found.valid, [[True, True], [True, False]])
    assert found.spacing == (1.5e-6, 1.5e-6)


def test_zygo_points_without_data_are_gaps(tmp_path):
    """Column, row and micrometres."""
    path = tmp_path / "z.xyz"
    path.write_text(zygo(["0 0 0.25", "1 0 No Data", "0 1 -1.5", "1 1 2"], xyz=True))
    found = read_surface(path)
    assert_allclose(found.heights, [[0.25e-6, 0], [-1.5e-6, 2e-6]])
    assert_array_equal(found.valid, [[True, False], [True, True]])


@pytest.mark.parametrize("kept", [0.05, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("writer", [write_keyence_csv, write_wyko])
def test_a_map_cut_short_is_refused_in_one_line(tmp_path, writer, kept):
    """Wherever the copy broke off inside a row."""
    path = tmp_path / "m.asc"
    writer(MAP, path)
    whole = path.read_bytes()
    cut = int(kept * len(whole))
    while whole[cut - 1 : cut] in {b"\n", b"\r", b'"', b"\t"}:
        cut -= 1
    path.write_bytes(whole[: cut - 1])
    with pytest.raises(BadData) as caught:
        read_surface(path)
    assert "\n" not in str(caught.value)
