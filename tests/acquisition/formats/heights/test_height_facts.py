"""Facts of height files that contradict each other, or nature, are refused or said."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.formats.heights.height_facts import cautions, checked
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.heights.stated_lengths import half_digit
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.simulators.rough_surfaces.surface_files import (
    write_dektak,
    write_keyence_csv,
    write_surfcom,
)

POINTS = 400
HEIGHTS = 1e-6 * np.random.default_rng(5).standard_normal(POINTS)


def profile(heights=HEIGHTS, spacing=0.5e-6):
    """Return a profile made in memory."""
    return Profile("p", np.array(heights), spacing, all_valid(np.array(heights)))


def areal(rows=12, columns=10, pitch=1e-6):
    """Return a map made in memory."""
    heights = 1e-6 * np.random.default_rng(6).standard_normal((rows, columns))
    return Areal("m", heights, (pitch, pitch), all_valid(heights))


def surfcom(path, heights=HEIGHTS, length="10.00000"):
    """Write heights [m] below a nominal length [mm]."""
    rows = [length, str(len(heights)), *(f"{1e6 * z:.4f}" for z in heights)]
    path.write_text("\r\n".join(rows) + "\r\n", encoding="ascii")
    return path


def settings(path, **values):
    """Write the TX3 beside a trace, in Spanish as the real ones are."""
    keys = {
        "measured": "Longitud medición",
        "range": "Rango de medida",
        "evaluated": "Longitud evaluación",
    }
    rows = [f"{keys[name]}\t{value}" for name, value in values.items()]
    rows.append("Método cálculo de curva BC\tLongitud evaluación")
    path.with_suffix(".tx3").write_bytes("\r\n".join(rows).encode("latin-1"))


def said(surface):
    """Return all cautions of a surface as one text."""
    return " | ".join(cautions(surface.provenance))


def edited(path, change):
    """Change the text of a file."""
    text = path.read_bytes().decode("cp1252")
    path.write_bytes(change(text).encode("cp1252"))
    return path


# --- Surfcom -----------------------------------------------------------------------


@pytest.mark.parametrize(
    "key", ["Longitud evaluación", "Evaluation length", "Auswertelänge"]
)
def test_a_trace_that_ended_early_has_the_pitch_of_its_evaluated_length(tmp_path, key):
    """Line 1 still reads 10 mm; over 5.0 mm the pitch is half of what it says."""
    path = surfcom(tmp_path / "a.tx1")
    path.with_suffix(".tx3").write_bytes(f"{key}\t5.0mm\r\n".encode("latin-1"))
    surface = read_surface(path)
    assert surface.spacing == pytest.approx(5e-3 / (POINTS - 1), rel=1e-12)
    assert "the trace ended early: 400 heights over the 5 mm" in said(surface)


def test_a_whole_trace_with_its_settings_is_read_without_a_word(tmp_path):
    """10.0 mm evaluated and 10.00000 mm nominal are one length."""
    path = surfcom(tmp_path / "a.tx1")
    settings(path, measured="10.0mm", range="+/-128.0um", evaluated="10.0mm")
    surface = read_surface(path)
    assert surface.spacing == pytest.approx(10e-3 / (POINTS - 1), rel=1e-12)
    assert said(surface) == ""


def test_a_trace_without_settings_says_what_its_pitch_rests_on(tmp_path):
    """No other file shows whether the trace ended early."""
    surface = read_surface(surfcom(tmp_path / "a.tx1"))
    assert "the pitch rests on line 1, the nominal length of 10.00000 mm" in said(
        surface
    )


@pytest.mark.parametrize(
    "values",
    [
        {"evaluated": "12.5mm"},
        {"measured": "4.0mm", "evaluated": "4.0mm"},
    ],
)
def test_settings_of_another_trace_are_refused(tmp_path, values):
    """An evaluated length beyond line 1, or a nominal one that is another."""
    path = surfcom(tmp_path / "a.tx1")
    settings(path, **values)
    with pytest.raises(FormatError, match="the settings of another trace"):
        read_surface(path)


def test_a_trace_that_ends_at_the_limit_of_its_range_is_said_to(tmp_path):
    """The stylus left its range of +/- 128 um at the end, or in the middle."""
    ramp = np.linspace(-20e-6, 127.9e-6, POINTS) + 1e-8 * HEIGHTS / 1e-6
    path = surfcom(tmp_path / "a.tx1", ramp)
    settings(path, range="+/-128.0um", evaluated="7.2mm")
    assert "the trace ends at 127.9 um, the limit of its range" in said(
        read_surface(path)
    )
    bump = np.where(np.arange(POINTS) == 200, -128e-6, HEIGHTS)
    path = surfcom(tmp_path / "b.tx1", bump)
    settings(path, range="+/-128.0um", evaluated="10.0mm")
    assert "1 heights lie at the limit of the range" in said(read_surface(path))


def test_a_surfcom_trace_cut_within_its_last_height_is_refused(tmp_path):
    """As many heights as declared, the last one of fewer decimals."""
    path = surfcom(tmp_path / "a.tx1")
    path.write_bytes(path.read_bytes()[:-4])
    with pytest.raises(FormatError, match="ends within its last height"):
        read_surface(path)


# --- Dektak, Gwyddion, Keyence ------------------------------------------------------


def dektak(tmp_path):
    """Write a whole Dektak trace."""
    path = tmp_path / "a.csv"
    write_dektak(profile(spacing=0.5e-6), path, stylus_radius=2.5e-6)
    return path


def test_a_whole_dektak_trace_is_read_without_a_word(tmp_path):
    """Length, resolution and x agree."""
    assert said(read_surface(dektak(tmp_path))) == ""


@pytest.mark.parametrize("kept", [POINTS - 2, POINTS // 2])
def test_a_dektak_trace_short_of_points_is_said_to_be(tmp_path, kept):
    """The pitch holds, for x stands beside each height."""
    lost = POINTS - kept
    path = edited(
        dektak(tmp_path), lambda t: "\r\n".join(t.splitlines()[:-lost]) + "\r\n"
    )
    surface = read_surface(path)
    assert surface.spacing == pytest.approx(0.5e-6)
    assert f"and the file holds {kept} over" in said(surface)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("Length,199.5 um", "Length,99.5 um", "'Length' says '99.5 um'"),
        ("0.500 um/sample", "0.156 um/sample", "'Resolution' says '0.156 um/sample'"),
    ],
)
def test_a_dektak_header_of_another_scan_is_refused(tmp_path, old, new, says):
    """Its length or its resolution is not that of the points."""
    path = edited(dektak(tmp_path), lambda text: text.replace(old, new))
    with pytest.raises(FormatError, match=says):
        read_surface(path)


def test_a_dektak_file_cut_within_its_last_height_is_refused(tmp_path):
    """A height of 0.12345 cut to 0.1 is another height."""
    path = edited(dektak(tmp_path), lambda text: text[:-7])
    with pytest.raises(FormatError, match="ends within its last line"):
        read_surface(path)


def test_a_dektak_trace_at_the_limit_of_its_range_is_said_to_be(tmp_path):
    """Of hills and valleys half of the range lies to either side."""
    path = tmp_path / "a.csv"
    ramp = np.linspace(0, 262e-6, POINTS)
    write_dektak(profile(ramp, spacing=5e-6), path, stylus_radius=2.5e-6)
    more = "Measurement Range,524 um\r\nProfile,Hills&Valleys\r\nLength"
    path = edited(path, lambda text: text.replace("Length", more, 1))
    assert "the trace ends at 262 um" in said(read_surface(path))


def gwyddion(path, rows, *, size="20.0 um"):
    """Write a map of 20 columns, scanned over a square of `size`."""
    values = np.random.default_rng(1).standard_normal((rows, 20))
    head = ["# Channel: a", f"# Width: {size}", f"# Height: {size}"]
    body = [" ".join(f"{1e-8 * z:.5e}" for z in row) for row in values]
    path.write_text("\n".join([*head, "# Value units: m", *body, ""]), "ascii")
    return path


def test_a_gwyddion_map_that_lost_rows_says_that_its_pitch_may_be_wrong(tmp_path):
    """The header has no number of rows: pixels that are not square show the loss."""
    assert said(read_surface(gwyddion(tmp_path / "a.txt", 20))) == ""
    surface = read_surface(gwyddion(tmp_path / "b.txt", 15))
    assert surface.spacing[1] == pytest.approx(1e-6)
    assert "the file has lost 5 of 20 rows" in said(surface)
    assert "the file has lost 1 of 20 rows" in said(
        read_surface(gwyddion(tmp_path / "c.txt", 19))
    )


def test_a_keyence_map_short_of_a_row_is_said_to_be(tmp_path):
    """Declared 12 rows, holds 11; real files do that too, so it is read."""
    path = tmp_path / "a.csv"
    write_keyence_csv(areal(), path)
    assert said(read_surface(path)) == ""
    path = edited(path, lambda t: "\r\n".join(t.rstrip().splitlines()[:-1]) + "\r\n")
    surface = read_surface(path)
    assert surface.heights.shape == (11, 10)
    assert "declares 12 rows and the file holds 11" in said(surface)


# --- sense, in every format ---------------------------------------------------------


def huge_surfcom(path):
    """A nominal length of 1e9 mm."""
    return surfcom(path.with_suffix(".tx1"), length="1e9")


def huge_gwyddion(path):
    """A width and a height of 1e9 mm."""
    return gwyddion(path.with_suffix(".txt"), 20, size="1e9 mm")


def huge_keyence(path):
    """A pixel of a metre."""
    write_keyence_csv(areal(pitch=1.0), path.with_suffix(".csv"))
    return path.with_suffix(".csv")


def huge_dektak(path):
    """Steps of a metre."""
    write_dektak(profile(spacing=1.0), path.with_suffix(".csv"), stylus_radius=1e-6)
    return path.with_suffix(".csv")


def huge_table(path):
    """Millimetres written as kilometres."""
    rows = [f"{1e3 * i},{z:.3e}" for i, z in enumerate(HEIGHTS)]
    path.with_suffix(".csv").write_text("\n".join(["x in m,z in m", *rows]), "ascii")
    return path.with_suffix(".csv")


def tiny_surfcom(path):
    """A nominal length of 1e-9 mm."""
    return surfcom(path.with_suffix(".tx1"), length="1e-9")


@pytest.mark.parametrize(
    "write",
    [
        huge_surfcom,
        huge_gwyddion,
        huge_keyence,
        huge_dektak,
        huge_table,
        tiny_surfcom,
    ],
)
def test_an_impossible_length_is_refused(tmp_path, write):
    """A fit band in kilometres, or in fractions of an atom, is none."""
    with pytest.raises(FormatError, match=r"m apart; a length up to 100? m|to 1 m and"):
        read_surface(write(tmp_path / "a"))


def test_heights_of_kilometres_are_refused(tmp_path):
    """Surfcom text holds micrometres: 1e12 of them are no height."""
    heights = np.where(np.arange(POINTS) == 7, 1e6, HEIGHTS)
    with pytest.raises(FormatError, match=r"height of 1e\+06 m"):
        read_surface(surfcom(tmp_path / "a.tx1", heights))


def test_heights_greater_than_the_trace_is_long_are_doubted():
    """2 mm of height over 0.2 mm of length: millimetres taken for micrometres."""
    found = checked(profile(1e3 * HEIGHTS), "a")
    assert "is a unit wrong?" in said(found)
    assert said(checked(profile(), "a")) == ""


def test_a_trace_that_ends_flat_at_its_extreme_is_said_to():
    """Whatever the format: ten equal heights at the top are no surface."""
    heights = np.append(HEIGHTS, np.full(10, 9e-6))
    assert "ends in 10 equal heights at its extreme" in said(
        checked(profile(heights), "a")
    )
    inside = np.append(HEIGHTS, np.full(10, 0.0))
    assert said(checked(profile(inside), "a")) == ""


def test_writing_and_reading_a_surfcom_trace_keeps_its_length(tmp_path):
    """Heights and pitch come back, with the caution that no TX3 stands beside."""
    write_surfcom(profile(), tmp_path / "a.tx1")
    found = read_surface(tmp_path / "a.tx1")
    assert found.spacing == pytest.approx(0.5e-6, rel=1e-4)


@pytest.mark.parametrize(
    ("cell", "half"), [("10.0", 0.05), ("10", 0.5), ("1e9", 5e8), ("2.50e-3", 5e-6)]
)
def test_half_of_the_last_digit_is_read_off_the_print(cell, half):
    """Exponents count."""
    assert half_digit(cell) == pytest.approx(half)


def table(path, end="\n", rows=40):
    """Write a table of x and z whose numbers have as many digits as they need."""
    lines = [f"{k},{z!r}" for k, z in enumerate((1e6 * HEIGHTS[:rows]).tolist())]
    path.write_bytes(("\r\n".join(lines) + end).encode())
    return path


def test_a_table_that_ends_in_its_last_row_is_said(tmp_path):
    """Its last height may lack digits; a whole line end leaves nothing to say."""
    path = tmp_path / "table.txt"
    for end, said in (("", "digits"), ("\r", "rows are lost"), ("\r\n", None)):
        found = cautions(read_surface(table(path, end), columns="x:um,z:um").provenance)
        assert found == () if said is None else said in found[0]


@pytest.mark.parametrize(("points", "said"), [(45, True), (31, True), (40, False)])
def test_a_map_that_ends_within_a_line_is_said(tmp_path, points, said):
    """Ten points to a line: 45 end in the fifth, 31 after the first of the fourth."""
    path = tmp_path / "map.xyz"
    rows = [f"{k % 10},{k // 10},{z:.4f}" for k, z in enumerate(1e6 * HEIGHTS)]
    path.write_text("\n".join(rows[:points]) + "\n", encoding="ascii")
    found = cautions(read_surface(path, columns="x:um,y:um,z:um").provenance)
    assert bool(found) == said
    assert not said or "of 10 points" in found[0]
