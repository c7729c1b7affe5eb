"""From heights to a verdict: D where there is a scaling range, a reason where not."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit, SurfaceVerdict
from jointbench.signal.surface.structure_function import combine, structure_function
from jointbench.simulators.rough_surfaces.rough_surface import (
    rough_profile,
    structure_of_line,
)

SPACING = 0.25e-6
POINTS = 8000
FRACTAL = {SurfaceVerdict.FRACTAL, SurfaceVerdict.BAND}


def fit(heights: FloatArray) -> FractalFit:
    """Fit a profile of these heights."""
    return fit_fractal(
        structure_function(Profile("p", heights, SPACING, all_valid(heights)))
    )


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_dimension_and_roughness_of_a_known_profile_are_found(dimension: float) -> None:
    """D within 0.03 and three standard deviations; G inside its interval or near."""
    truth = rough_profile(
        POINTS, spacing=SPACING, dimension=dimension, roughness=1e-10, seed=3
    )
    found = fit_fractal(structure_function(truth))
    assert found.verdict in FRACTAL
    assert found.scaling is not None
    error = found.scaling.dimension - dimension
    assert abs(error) < 0.03
    assert abs(error) < 3 * found.scaling.dimension_sd
    low, high = found.scaling.roughness_interval
    assert low / 3 < 1e-10 < high * 3


def test_the_structure_function_of_a_known_profile_is_its_power_law() -> None:
    """At short lags, where thousands of pairs average, within 5 %."""
    truth = rough_profile(
        POINTS, spacing=SPACING, dimension=1.5, roughness=1e-10, seed=4
    )
    estimate = structure_function(truth, lags=[1, 2, 5, 10])
    expected = structure_of_line(estimate.lag, dimension=1.5, roughness=1e-10)
    np.testing.assert_allclose(estimate.value, expected, rtol=0.05)


def test_missing_points_do_not_move_the_dimension() -> None:
    """A mask, not zeros: D with 1 % missing stays within a standard deviation."""
    truth = rough_profile(
        POINTS, spacing=SPACING, dimension=1.5, roughness=1e-10, seed=5
    )
    gone = np.random.default_rng(5).random(POINTS) < 0.01
    holed = replace(
        truth, heights=np.where(gone, 0.0, truth.heights), valid=truth.valid & ~gone
    )
    whole = fit_fractal(structure_function(truth)).scaling
    holes = fit_fractal(structure_function(holed)).scaling
    assert whole is not None
    assert holes is not None
    assert abs(whole.dimension - holes.dimension) < whole.dimension_sd


@pytest.mark.parametrize("name", ["white noise", "parabola", "sine", "steps"])
def test_what_does_not_scale_is_not_called_fractal(name: str) -> None:
    """Noise, form, waves and steps get a reason instead of a dimension."""
    x = np.arange(POINTS)
    rng = np.random.default_rng(6)
    heights = {
        "white noise": rng.normal(size=POINTS),
        "parabola": ((x - 3000) / POINTS) ** 2,
        "sine": np.sin(2 * np.pi * x / 200),
        "steps": np.where((x // 400) % 2 == 0, 0.0, 1.0),
    }[name]
    found = fit(1e-6 * heights + 1e-10 * rng.normal(size=POINTS))
    assert found.verdict not in FRACTAL
    assert len(found.reason) > 10


def test_two_faces_add_their_structure_functions() -> None:
    """S_e = S_a + S_b, and two equal surfaces keep the dimension of one."""
    faces = [
        structure_function(
            rough_profile(
                POINTS, spacing=SPACING, dimension=1.5, roughness=1e-10, seed=seed
            )
        )
        for seed in (7, 8)
    ]
    both = combine(*faces)
    np.testing.assert_allclose(both.value, faces[0].value + faces[1].value, rtol=1e-12)
    scaling = fit_fractal(both).scaling
    assert scaling is not None
    assert abs(scaling.dimension - 1.5) < 0.03
