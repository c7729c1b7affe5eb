"""Form and outliers are taken off, and said; directions keep measured points."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from weierstrass_surfaces import weierstrass_map

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.form_removal import mask_outliers, remove_form
from jointbench.signal.surface.lattice_profiles import profiles_along
from jointbench.signal.surface.structure_along import structure_along
from jointbench.signal.surface.structure_function import structure_function
from jointbench.signal.surface.structure_map import isotropy, structure_map
from jointbench.simulators.rough_surfaces.rough_surface import rough_map, rough_profile


def profile(heights):
    return Profile("p", heights, 1e-6, all_valid(heights))


def areal(heights, spacing=(1e-6, 1e-6)):
    return Areal("m", heights, spacing, all_valid(heights))


def test_a_parabola_is_taken_whole_and_said():
    """Nothing is left of it to 1e-12, and the provenance has its size."""
    x = np.linspace(-1, 1, 301)
    flat = remove_form(profile(1e-5 * x**2), degree=2)
    assert np.max(np.abs(flat.heights)) < 1e-17
    name, detail = flat.provenance[-1].name, dict(flat.provenance[-1].detail)
    assert name == "remove_form"
    assert float(detail["rms_taken_m"]) == pytest.approx(1e-5 * np.std(x**2), rel=1e-9)


def test_a_sphere_is_taken_off_a_map_with_gaps():
    """A quadratic bowl of a map with a hole; the hole stays a hole."""
    y, x = np.mgrid[-1:1:40j, -1:1:30j]
    heights = 1e-6 * (x**2 + y**2 + 0.3 * x * y)
    valid = np.ones(heights.shape, dtype=bool)
    valid[3:6, 4:9] = False
    surface = Areal("m", np.where(valid, heights, 0.0), (1e-6, 1e-6), valid)
    flat = remove_form(surface)
    assert np.max(np.abs(flat.heights)) < 1e-17
    assert_array_equal(flat.valid, valid)


def test_a_degree_that_takes_roughness_is_refused():
    """Degree 20 is no form."""
    with pytest.raises(UsageError, match="1 to 8"):
        remove_form(profile(np.arange(100.0)), degree=20)


def test_outliers_are_masked_and_counted():
    """Three spikes of a hundred steps go; no other point of a rough profile does."""
    truth = rough_profile(5000, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=1)
    heights = truth.heights.copy()
    spikes = [100, 2000, 4001]
    heights[spikes] += 100 * np.std(np.diff(heights))
    cleaned = mask_outliers(profile(heights))
    gone = np.flatnonzero(~cleaned.valid)
    assert set(spikes) <= set(gone)
    assert gone.size <= 4
    assert dict(cleaned.provenance[-1].detail)["masked"] == gone.size


def test_a_point_between_gaps_of_a_tilted_profile_is_no_outlier():
    """Gaps are filled from their nearest points, so that a tilt makes no outlier."""
    truth = rough_profile(2000, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=1)
    tilted = truth.heights + 1e-3 * np.linspace(-1, 1, 2000)
    valid = np.ones(2000, dtype=bool)
    valid[[300, 301, 303, 304, 1500, 1501, 1503, 1504]] = False
    cleaned = mask_outliers(Profile("p", np.where(valid, tilted, 0.0), 1e-6, valid))
    assert_array_equal(cleaned.valid, valid)


def test_the_scatter_along_a_diagonal_is_what_is_stated():
    """Twelve isotropic maps at 45 degrees: errors of D over their stated deviations.

    The sum of their squares is below 32.9 in 99.9 % (chi-squared, 12 degrees of
    freedom); with the lines taken as independent profiles it is 99, one map left out.
    """
    fits = [
        fit_fractal(structure_along(one, np.pi / 4))
        for one in (
            rough_map(200, 300, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=s)
            for s in range(12)
        )
    ]
    assert all(fit.dimension is not None for fit in fits)
    errors = [(fit.dimension - 1.5) / fit.dimension_sd for fit in fits]
    assert np.sum(np.square(errors)) < 32.9


@pytest.mark.parametrize(("angle", "direction"), [(0.0, "x"), (np.pi / 2, "y")])
def test_along_rows_and_columns_it_is_the_structure_function_of_the_map(
    angle, direction
):
    """To the last digit: the lines of the grid are its rows and columns there."""
    surface = rough_map(60, 80, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=3)
    along, known = (
        structure_along(surface, angle),
        structure_function(surface, direction=direction),
    )
    assert_array_equal(along.value, known.value)
    assert along.samplings[0].row_distance == known.samplings[0].row_distance


def test_all_lags_of_a_profile_agree_with_direct_sums_beside_an_offset():
    """A smooth profile a millimetre high: to 1e-9, which plain transforms miss."""
    truth = rough_profile(4000, spacing=1e-6, dimension=1.2, roughness=1e-10, seed=2)
    lifted = profile(truth.heights + 1e-3)
    found, direct = structure_map(lifted, reach=0.3), structure_function(lifted)
    lags = np.rint(direct.lag / 1e-6).astype(int)
    lags = lags[lags < found.value.size]
    assert_allclose(found.value[lags], direct.value[: lags.size], rtol=1e-9)


def test_all_lags_of_a_map_skip_missing_points():
    """Along the rows and down the columns, as the direct sums with a tenth missing."""
    truth = rough_map(60, 80, spacing=1e-6, dimension=1.5, roughness=1e-9, seed=3)
    valid = np.random.default_rng(3).uniform(size=(60, 80)) > 0.1
    surface = Areal("m", np.where(valid, truth.heights, 0.0), (1e-6, 1e-6), valid)
    found = structure_map(surface, reach=0.2)
    rows = structure_function(surface, lags=range(1, 9))
    columns = structure_function(surface, lags=range(1, 9), direction="y")
    middle = found.value.shape[1] // 2
    assert_allclose(found.value[0, middle + 1 : middle + 9], rows.value, rtol=1e-9)
    assert_allclose(found.value[1:9, middle], columns.value, rtol=1e-9)


def test_two_ridges_make_a_lay_and_twenty_do_not():
    """The published figure's two ridges differ between axes and diagonals."""

    def made(ridges):
        return weierstrass_map(
            160,
            160,
            spacing=1e-6,
            areal_dimension=2.4,
            roughness=1e-9,
            ridges=ridges,
            seed=1,
        )

    assert not isotropy(made(2)).isotropic
    assert isotropy(made(20)).isotropic


@pytest.mark.parametrize(("angle", "step"), [(0.0, 1.0), (0.8, 2**0.5), (1.1, 5**0.5)])
def test_lines_run_through_points_of_the_grid(angle, step):
    """A plane is met exactly, at the spacing of the direction, sloped as its angle."""
    y, x = np.mgrid[:40, :40] * 1.0
    lines = profiles_along(areal(2e-7 * x + 3e-7 * y), angle)
    assert lines[0].spacing == pytest.approx(step * 1e-6)
    rise = {round(float(r), 12) for line in lines for r in np.diff(line.heights)}
    assert len(rise) == 1
    assert sum(line.heights.size for line in lines) > 400


def test_a_map_of_few_rows_has_no_lines_across():
    """Four rows are no profile."""
    with pytest.raises(UsageError, match="at most 4 points"):
        profiles_along(areal(np.zeros((4, 50))), np.pi / 2)
