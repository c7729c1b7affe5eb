"""The options of `surface`: form, outliers, directions, profiles as one, waves."""

import json

import numpy as np
import pytest
from weierstrass_surfaces import weierstrass_map, weierstrass_profile

from jointbench.simulators.rough_surfaces.rough_surface import rough_map, rough_profile
from jointbench.simulators.rough_surfaces.surface_files import write_keyence_csv
from jointbench.station.main import app, exit_code

SPACING, POINTS = 0.5e-6, 3000


def write_table(path, heights):
    """Write heights at half a micrometre as a table that states its units."""
    along = 1e6 * SPACING * np.arange(heights.size)
    np.savetxt(
        path,
        np.column_stack([along, 1e6 * heights]),
        fmt=["%.1f", "%.7f"],
        delimiter=",",
        header="x [um],z [um]",
        comments="",
    )


def rough(seed):
    """Return the heights of a surface of D = 1.5."""
    made = rough_profile(
        POINTS, spacing=SPACING, dimension=1.5, roughness=1e-10, seed=seed
    )
    return made.heights


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Profiles (rough, bent with two spikes, waves) and maps (even, with a lay)."""
    folder = tmp_path_factory.mktemp("surfaces")
    for seed in range(3):
        write_table(folder / f"p{seed}.csv", rough(seed))
    bent = rough(1) + 2e-5 * np.linspace(-1, 1, POINTS) ** 2
    bent[[500, 1200]] += 1e-5
    write_table(folder / "bent.csv", bent)
    waves = weierstrass_profile(
        4096, spacing=SPACING, dimension=1.4, roughness=1e-10, seed=1
    )
    write_table(folder / "waves.csv", waves.heights)
    even = rough_map(120, 160, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=1)
    write_keyence_csv(even, folder / "even.csv")
    lay = weierstrass_map(
        160,
        160,
        spacing=1e-6,
        areal_dimension=2.4,
        roughness=1e-9,
        ridges=2,
        seed=1,
    )
    write_keyence_csv(lay, folder / "lay.csv")
    return folder


@pytest.fixture(scope="module")
def run_before():
    """What `surface` wrote by its words: JSON and screen, kept for the whole module."""
    return {}


@pytest.fixture
def surface(files, run_before, monkeypatch, capsys, tmp_path):
    """Run `surface` on files by name; return what it wrote as JSON, and the screen.

    The same words are run once; several tests compare with a plain run.
    """

    def run(*words):
        if words not in run_before:
            run_before[words] = fresh(*words)
        written, shown = run_before[words]
        return json.loads(written), shown

    def fresh(*words):
        monkeypatch.setenv("COLUMNS", "250")
        target = tmp_path / "found.json"
        given = [files / word if str(word).endswith(".csv") else word for word in words]
        line = ["jointbench", "surface", *map(str, given), "--json", str(target)]
        monkeypatch.setattr("sys.argv", line)
        assert exit_code(app, debug=False) == 0
        return target.read_text(encoding="utf-8"), capsys.readouterr().out

    return run


@pytest.fixture
def refusal(files, monkeypatch, capsys):
    """Run `surface` on one file with options that it refuses; return its line."""

    def run(name, *options):
        line = ["jointbench", "surface", str(files / name), *options]
        monkeypatch.setattr("sys.argv", line)
        assert exit_code(app, debug=False) != 0
        (said,) = capsys.readouterr().err.strip().splitlines()
        return said

    return run


def test_without_options_nothing_is_added(surface):
    """No further key and no further line."""
    found, shown = surface("p1.csv")
    assert set(found) == {"files"}
    assert not {"direction", "directions", "weierstrass"} & set(found["files"][0])
    assert shown.count("p1: ") == 4


def test_form_and_outliers_are_removed_and_stated(surface):
    """A bow of 20 um and two spikes hide D; without them it is that of the surface.

    The bow 2e-5 x^2 has a root mean square of 2e-5 sqrt(4 / 45) = 5.96 um; what the
    surface itself has of the second degree is part of the 2 % allowed.
    """
    assert surface("bent.csv")[0]["files"][0]["dimension"] is None
    found, shown = surface("bent.csv", "--form", "2", "--outliers", "6")
    one = found["files"][0]
    assert abs(one["dimension"] - 1.5) < 3 * one["dimension_sd"]
    steps = {step["step"]: step for step in one["provenance"]}
    assert steps["mask_outliers"]["masked"] == 2
    assert steps["remove_form"]["rms_taken_m"] == pytest.approx(5.96e-6, rel=0.02)
    assert "bent: 2 of 3000 points masked as outliers" in shown
    assert "bent: form of degree 2 removed, 5.9" in shown


def test_a_refusal_names_the_option_that_helps(surface):
    """Bent and spiky: without options the line names both, and D as they give it."""
    one = surface("bent.csv")[0]["files"][0]
    assert one["verdict"] == "no scaling range"
    assert one["remedy"].startswith("--outliers 6 --form 2 helps: fractal")
    assert surface("p1.csv")[0]["files"][0]["remedy"] is None


def test_a_filter_and_a_structure_map_have_their_door(surface, tmp_path):
    """Waves over 50 um go: S stops growing; the map file has S at lag 1 as the fit."""
    plain = surface("p1.csv")[0]["files"][0]
    path = tmp_path / "map.csv"
    found, shown = surface("p1.csv", "--filter", ":50 um", "--structure-map", path)
    one = found["files"][0]
    assert "waves longer than 50 µm filtered out, 50 points cut off" in shown
    density = [
        np.interp(1e-4, *(np.array(each["spectrum"][k])[::-1] for k in keys))
        for each in (plain, one)
        for keys in [("wavelength_m", "density_m3")]
    ]
    assert density[1] < 0.1 * density[0]
    lag, value = np.loadtxt(path, delimiter=",", skiprows=1)[:2].T
    assert lag == pytest.approx([0, 0.5])
    assert value[0] == 0 < value[1]


def test_steps_of_the_instrument_are_read_before_the_form_is_removed(surface, files):
    """A line removed from heights in steps of 0.2 um: D differs by rounding only.

    Lags whose differences are within half a step take no part; were the steps
    looked for in what is left after the line, D would be 0.02 higher.
    """
    coarse = 2e-7 * np.round((rough(1) + 2e-6 * np.linspace(-1, 1, POINTS)) / 2e-7)
    write_table(files / "coarse.csv", coarse)
    plain, formed = (
        surface("coarse.csv", *options)[0]["files"][0]
        for options in ((), ("--form", "1"))
    )
    assert formed["verdict"] == plain["verdict"]
    assert formed["fit_band_m"] == plain["fit_band_m"]
    assert formed["dimension"] == pytest.approx(plain["dimension"], abs=1e-6)


def test_profiles_of_one_surface_are_fitted_as_one(surface):
    """Three profiles: each by itself as before, all with 1 / sqrt(3) of its sd."""
    found, shown = surface("p0.csv", "p1.csv", "p2.csv", "--pool")
    alone, pooled = found["files"], found["pooled"]
    assert alone[0] == surface("p0.csv")[0]["files"][0]
    assert pooled["profiles"] == ["p0", "p1", "p2"]
    assert abs(pooled["dimension"] - 1.5) < 3 * pooled["dimension_sd"]
    ratio = pooled["dimension_sd"] / np.mean([one["dimension_sd"] for one in alone])
    assert ratio == pytest.approx(3**-0.5, rel=0.1)
    own = [one["dimension"] for one in alone]
    assert pooled["dimension_scatter"] == pytest.approx(np.std(own, ddof=1))
    assert len(pooled["value_m2"]) == len(pooled["lag_m"])
    assert pooled["value_sd_m2"] is None
    assert "3 profiles: 3 of 3 profiles have a D of their own, which scatters" in shown


def test_eight_profiles_show_how_their_structure_functions_scatter(surface, files):
    """From eight on S has a standard error: at lag 1, 1e-2 of S within a factor 2.

    The squares of 3000 differences of neighbours, independent at D = 1.5, have a
    relative standard deviation of sqrt(2 / 3000), their mean of eight 0.9 %.
    """
    names = [f"e{seed}.csv" for seed in range(8)]
    for seed, name in enumerate(names):
        write_table(files / name, rough(seed))
    pooled = surface(*names, "--pool")[0]["pooled"]
    share = pooled["value_sd_m2"][0] / pooled["value_m2"][0]
    assert 0.0045 < share < 0.018


def test_the_lines_of_a_map_along_a_direction_are_fitted(surface):
    """At 45 degrees the points lie sqrt(2) um apart; at 0 it is the fit of the map."""
    found, shown = surface("even.csv", "--direction", "45")
    one = found["files"][0]
    assert one["direction"]["met_deg"] == pytest.approx(45)
    assert one["direction"]["spacing_m"] == pytest.approx(2**0.5 * 1e-6)
    assert abs(one["dimension"] - 1.5) < 3 * one["dimension_sd"]
    assert "even: along 45.0 degrees from the rows (45 asked): " in shown
    rows, plain = (
        surface("even.csv", *options)[0]["files"][0]
        for options in (("--direction", "0"), ())
    )
    assert rows["dimension"] == plain["dimension"]
    assert rows["dimension_sd"] == plain["dimension_sd"]


def test_the_directions_of_a_map_are_compared(surface):
    """Two ridges make a lay, fractional Brownian heights make none."""
    found, shown = surface("even.csv", "lay.csv", "--directions")
    even, lay = (one["directions"] for one in found["files"])
    assert even["isotropic"]
    assert not lay["isotropic"]
    assert "even: isotropic: S is largest at " in shown
    assert "lay: anisotropic, with a lay: S is largest at 135 degrees" in shown
    assert lay["angle_deg"] == pytest.approx([0, 45, 90, 135])
    assert np.shape(lay["value_m2"]) == (4, len(lay["lag_m"]))
    logs = np.log(lay["value_m2"])
    means = np.exp(np.mean(logs - logs.mean(axis=0), axis=1))
    assert lay["ratio"] == pytest.approx(means)


def test_a_weierstrass_profile_is_fitted_beside(surface):
    """D = 1.4 and G = 0.1 nm are in the intervals; the fit of the surface stays."""
    found, shown = surface("waves.csv", "--weierstrass", "1.5")
    one = found["files"][0]
    waves = one.pop("weierstrass")
    assert abs(waves["dimension"] - 1.4) < 0.02
    assert waves["roughness_interval_m"][0] < 1e-10 < waves["roughness_interval_m"][1]
    assert waves["gamma"] == 1.5
    assert not waves["dimension_at_limit"]
    assert one == surface("waves.csv")[0]["files"][0]
    assert "waves: Weierstrass-Mandelbrot profile of ratio 1.5: D = 1.39" in shown


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("even.csv", ["--pool"], "--pool takes profiles only"),
        ("even.csv", ["--weierstrass", "1.5"], "--weierstrass takes profiles only"),
        ("p0.csv", ["--direction", "30"], "--direction takes maps only"),
        ("p0.csv", ["--directions"], "--directions takes maps only"),
        ("p0.csv", ["--pool"], "pooling takes two or more"),
        ("p0.csv", ["--form", "20"], "a form has 1 to 8"),
        ("p0.csv", ["--outliers", "0.5"], "it must be above 1"),
        ("p0.csv", ["--weierstrass", "1"], "it must be above 1"),
        ("p0.csv", ["--filter", "2.5 um"], "give lambda_s and lambda_c"),
        ("p0.csv", ["--filter", "2 um:1 s"], "'s'"),
    ],
)
def test_an_option_that_does_not_suit_is_refused(refusal, name, options, said):
    """One line that states what the option takes."""
    assert said in refusal(name, *options)
