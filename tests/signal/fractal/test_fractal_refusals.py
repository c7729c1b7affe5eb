# SPDX-License-Identifier: MIT
"""What is no fractal surface is refused with a reason, made or real."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit, SurfaceVerdict
from jointbench.signal.surface.structure_function import structure_function
from jointbench.simulators.rough_surfaces.brownian import brownian_lines

DATA = Path(__file__).parents[4] / "shared" / "data" / "surfaces"
SPACING = 0.5e-6
STEP = 1e-8


def brownian(points: int, dimension: float, seed: int) -> FloatArray:
    """Return exact fractional Brownian heights with steps of `STEP`."""
    rng = np.random.default_rng(seed)
    return STEP * brownian_lines(1, points, 2 - dimension, rng)[0]


def noise(points: int, size: float, seed: int) -> FloatArray:
    """Return white noise of a given standard deviation."""
    return size * np.random.default_rng([seed, 99]).standard_normal(points)


def fit(heights: FloatArray) -> FractalFit:
    """Fit a profile."""
    surface = Profile("p", heights, SPACING, all_valid(heights))
    return fit_fractal(structure_function(surface))


def bent(short: float, long: float, seed: int) -> FloatArray:
    """Return heights whose spectrum turns from one D to another at 40 samples."""
    rng = np.random.default_rng(seed)
    frequency = np.fft.rfftfreq(100_000)[1:] * 2 * np.pi * 40
    slope = np.where(frequency > 1, 5 - 2 * short, 5 - 2 * long)
    waves = rng.standard_normal((2, frequency.size))
    heights = np.fft.irfft(
        np.append(0, frequency ** (-slope / 2) * (waves[0] + 1j * waves[1]))
    )[:12_000]
    return STEP * heights / np.std(np.diff(heights))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_fine_jagged_texture_on_a_coarse_smooth_one_is_not_fractal(seed: int):
    """D = 1.85 and 1.15 added, equal at 60 samples: never one power law."""
    jagged = brownian(12_000, 1.85, seed)
    smooth = brownian(12_000, 1.15, seed + 100)
    found = fit(jagged + smooth * 60**-0.7)
    assert found.verdict in {SurfaceVerdict.BAND, SurfaceVerdict.NONE}
    if found.fit_band is not None:
        assert found.fit_band[1] < 60 * SPACING


@pytest.mark.parametrize(("short", "long"), [(1.2, 1.75), (1.75, 1.2)])
def test_a_spectrum_with_two_slopes_is_not_one_power_law(short: float, long: float):
    """Four surfaces each way: none is called fractal over all lags."""
    verdicts = [fit(bent(short, long, seed)).verdict for seed in range(4)]
    assert SurfaceVerdict.FRACTAL not in verdicts


def test_a_surface_hidden_by_the_steps_of_its_heights_is_instrument_limited():
    """Steps of 60 times the roughness of a sample leave no decade."""
    quantum = 60 * STEP
    heights = quantum * np.round(brownian(4000, 1.5, 22) / quantum)
    found = fit(heights + 0.0)
    assert found.verdict is not SurfaceVerdict.FRACTAL
    assert found.dimension is None


X = np.arange(6000.0)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("noise", lambda: noise(6000, 1e-9, 1)),
        ("parabola", lambda: 1e-5 * (X / 6000) ** 2),
        ("sine", lambda: 1e-6 * np.sin(X / 40)),
        ("turning marks", lambda: 1e-6 * np.abs(np.sin(X / 30)) + noise(6000, 1e-8, 2)),
        ("one step", lambda: 1e-6 * (X > 2500)),
        ("step with noise", lambda: 1e-6 * (X > 2500) + noise(6000, 1e-8, 3)),
        ("smooth", lambda: 1e-7 * gaussian_filter1d(noise(6000, 1.0, 4), 20)),
        (
            "short correlation",
            lambda: lfilter([1.0], [1.0, -0.8], noise(6000, 1e-8, 5)),
        ),
        ("blocks", lambda: np.repeat(noise(300, 1e-7, 6), 20)),
        ("flat", lambda: np.zeros(200)),
        ("short", lambda: brownian(60, 1.5, 1)),
    ],
)
def test_other_shapes_are_not_called_fractal(
    name: str, shape: Callable[[], FloatArray]
):
    """Each gets a reason with numbers or a way out, and no dimension."""
    found = fit(shape())
    assert found.verdict in {SurfaceVerdict.NONE, SurfaceVerdict.INSTRUMENT}
    assert found.dimension is None
    assert found.fit_band is None
    assert len(found.reason) > 20
    assert "\n" not in found.reason


def test_noise_alone_is_the_instruments():
    """White noise of 1 nm is called so, with its size."""
    found = fit(noise(6000, 1e-9, 1))
    assert found.verdict is SurfaceVerdict.INSTRUMENT
    assert "white noise of 1 nm" in found.reason or "0.99" in found.reason


def test_a_surface_buried_in_noise_is_instrument_limited():
    """Where noise rules up to 100 samples no decade is left of 4,000 points."""
    found = fit(brownian(4000, 1.5, 9) + noise(4000, 8 * STEP, 9))
    assert found.verdict is SurfaceVerdict.INSTRUMENT
    assert "noise of" in found.reason


@pytest.mark.parametrize("name", ["GII-EII"])
def test_a_real_stylus_trace_gets_a_reason(name: str):
    """Smooth below 5 um and bent above: no power law, and the slopes show it."""
    path = DATA / "surfcom" / f"{name}.tx1"
    if not path.exists():
        pytest.skip(f"{path} is not beside the checkout")
    length, count, *values = path.read_text(encoding="latin-1").split()
    heights = np.array(values[: int(count)], dtype=float) * 1e-6
    spacing = float(length) * 1e-3 / (int(count) - 1)
    surface = Profile(name, heights, spacing, all_valid(heights))
    found = fit_fractal(structure_function(surface))
    assert found.verdict is SurfaceVerdict.NONE
    assert found.local_slope.slope[0] == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize("name", ["test1", "test2"])
def test_a_real_map_gets_a_verdict(name: str):
    """A coarse areal scan with spikes: any verdict, with a reason, no exception."""
    path = DATA / "nanovea" / f"{name}.txt"
    if not path.exists():
        pytest.skip(f"{path} is not beside the checkout")
    heights = np.loadtxt(path, delimiter=",")[:, 2].reshape(101, 101) * 1e-6
    surface = Areal(name, heights, (5e-6, 5e-6), all_valid(heights))
    found = fit_fractal(structure_function(surface))
    assert found.verdict in SurfaceVerdict
    assert len(found.reason) > 20


def test_the_real_keyence_map_has_no_scaling_range():
    """Its slope rises from noise to nearly a form and falls to a plateau.

    A quarter of the rows shows all of it.
    """
    paths = sorted((DATA / "keyence").glob("*.vk6"))
    if not paths:
        pytest.skip(f"{DATA / 'keyence'} is not beside the checkout")
    reader = pytest.importorskip("SurfaceTopography")
    topography = reader.open_topography(str(paths[0])).topography(0)
    assert topography.unit == "pm"
    heights = np.ascontiguousarray(topography.heights().T)[:192] * 1e-12
    spacing = topography.physical_sizes[0] * 1e-12 / topography.nb_grid_pts[0]
    surface = Areal("vk6", heights, (spacing, spacing), all_valid(heights))
    found = fit_fractal(structure_function(surface))
    assert found.verdict is SurfaceVerdict.NONE
    assert found.local_slope.slope.max() > 1.5
    assert found.local_slope.slope[-1] < 0.5
