"""Keyence height images, in every language and layout."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    UnitError,
)
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.surfaces import Areal

SURFACES = Path(__file__).parents[4] / "shared" / "data" / "surfaces"
shared = pytest.mark.skipif(not SURFACES.is_dir(), reason=f"no shared data: {SURFACES}")

HEIGHTS = np.round(np.random.default_rng(11).normal(size=(4, 5)), 3)  # [um]


def detail(surface):
    return {key: value for step in surface.provenance for key, value in step.detail}


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
    """One line each with the error."""
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
