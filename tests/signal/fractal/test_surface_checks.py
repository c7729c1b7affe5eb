"""Whittle, the papers' recipe and the Weierstrass-Mandelbrot form by name."""

import numpy as np
import pytest
from papers_recipe import fit_papers_recipe
from weierstrass_surfaces import weierstrass_map, weierstrass_profile
from whittle import fit_whittle

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.weierstrass_fit import band_integral, fit_weierstrass
from jointbench.signal.surface.structure_function import structure_function
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile


@pytest.mark.parametrize(("dimension", "bound"), [(1.3, 0.00732), (1.7, 0.00626)])
def test_the_spectrum_agrees_with_the_structure_function(dimension, bound):
    """Six profiles: the mean of each within 4 bounds over root six of the truth.

    The bound is Whittle's of 20,000 points, sqrt(2.5) times larger. The two means
    differ by less than either may be off.
    """
    profiles = [
        rough_profile(
            8000, spacing=1e-7, dimension=dimension, roughness=1e-10, seed=seed
        )
        for seed in range(6)
    ]
    checked = [fit_whittle(profile) for profile in profiles]
    fitted = [
        fit_fractal(structure_function(profile)).dimension for profile in profiles
    ]
    reach = 4 * bound / np.sqrt(len(profiles))
    by_spectrum = np.mean([one.dimension for one in checked])
    assert abs(by_spectrum - dimension) < reach
    assert abs(by_spectrum - np.mean(np.array(fitted, dtype=float))) < reach
    by_line = np.mean([one.spectral_dimension for one in checked])
    assert abs(by_line - dimension) < 0.1
    assert checked[0].dimension_sd == pytest.approx(bound, rel=0.03)


def test_the_recipe_averages_lines_at_all_lags():
    """The means are those of its lines; its G is one of the printed constant."""
    profiles = [
        rough_profile(2000, spacing=1e-7, dimension=1.5, roughness=1e-10, seed=s)
        for s in (1, 2)
    ]
    found = fit_papers_recipe(profiles)
    assert found.dimension == pytest.approx(
        np.mean([line.dimension for line in found.lines])
    )
    assert found.roughness == pytest.approx(
        np.mean([line.roughness for line in found.lines])
    )
    assert abs(found.dimension - 1.5) < 0.3
    with pytest.raises(UsageError, match="no profile"):
        fit_papers_recipe([])


@pytest.mark.parametrize("dimension", [1.2, 1.4, 1.7])
def test_a_weierstrass_profile_gives_its_dimension_and_roughness(dimension):
    """Mean of eight: D within 0.02; the interval of G covers in each."""
    found = [
        fit_weierstrass(
            structure_function(
                weierstrass_profile(
                    4096, spacing=5e-7, dimension=dimension, roughness=1e-10, seed=s
                ),
                remove="mean",
            )
        )
        for s in range(8)
    ]
    assert abs(np.mean([f.dimension for f in found]) - dimension) < 0.02
    for one in found:
        assert one.roughness_interval[0] < 1e-10 < one.roughness_interval[1]


def test_the_band_integral_is_the_power_law_inside_a_wide_band():
    """At D = 1.5 the integral of (1 - cos 2 pi f t) / f^2 is pi^2 t."""
    lag = np.array([1e-5, 2e-5])
    found = band_integral(lag, 1.5, (1.0, 1e9))
    np.testing.assert_allclose(found, np.pi**2 * lag, rtol=2e-3)


def test_two_ridges_are_not_isotropic_and_sixteen_nearly_are():
    """S along x over S along y of the papers' M = 2 and of M = 16."""
    ratio = []
    for ridges in (2, 16):
        surface = weierstrass_map(
            128,
            128,
            spacing=1e-6,
            areal_dimension=2.5,
            roughness=1e-9,
            ridges=ridges,
            seed=3,
        )
        along, across = (
            structure_function(surface, lags=[1, 2, 4], direction=d).value.sum()
            for d in ("x", "y")
        )
        ratio.append(abs(np.log(along / across)))
    assert ratio[1] < 0.5
    assert ratio[0] > ratio[1]


def test_a_weierstrass_map_shrinks_with_its_dimension():
    """Only as amplitude: (G / L)^(D - 2) falls by (G / L)^0.4 from 2.2 to 2.6."""
    sizes = [
        weierstrass_map(
            32, 32, spacing=1e-6, areal_dimension=d, roughness=1e-12, ridges=10, seed=1
        ).heights.std()
        for d in (2.2, 2.6)
    ]
    assert sizes[1] < 0.01 * sizes[0]
