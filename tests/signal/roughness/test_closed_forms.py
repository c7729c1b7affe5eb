"""Texture parameters of surfaces whose parameters are known exactly, within 0.1 %."""

import numpy as np
import pytest
from scipy.special import ellipe, ndtr, ndtri

from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import Texture, TextureSettings
from jointbench.signal.surface.gaussian_filter import transmission

PITCH = 0.5e-6
PLAIN = TextureSettings(None, None)
WITHIN = 1e-3


def near(value):
    return pytest.approx(value, rel=WITHIN, abs=1e-9)


def parameters(heights, spacing, sections=5):
    """Return parameters of heights as they are, without filters."""
    valid = all_valid(heights)
    texture = Texture(heights, valid, spacing, 0 * heights, PLAIN, sections)
    return texture_parameters(texture).values


def test_a_sine_through_the_filters_of_sc3():
    """Amplitude of a wave of 100 um times the transmissions of both filters."""
    place = PITCH * np.arange(11200)
    wave = Profile("sine", 1e-6 * np.sin(2 * np.pi * place / 1e-4), PITCH, place >= 0)
    settings = TextureSettings(2.5e-6, 0.8e-3, setting_class="Sc3")
    found = surface_texture(wave, settings)
    omega = np.array(2 * np.pi / 1e-4)
    a = 1e-6 * float(transmission(omega, 2.5e-6) * (1 - transmission(omega, 0.8e-3)))
    values = texture_parameters(found).values
    assert found.sections == 5
    assert found.remarks == ()
    assert values["Ra"] == near(2 * a / np.pi)
    assert values["Rq"] == near(a / np.sqrt(2))
    assert values["Rz"] == near(2 * a)
    assert values["Rt"] == near(2 * a)
    assert values["Rku"] == near(1.5)
    assert values["Rsm"] == near(1e-4)
    assert values["Rc"] == near(2 * a)
    assert values["Rdq"] == near(2 * np.pi * a / 1e-4 / np.sqrt(2))
    assert abs(values["Rsk"]) < WITHIN


def test_a_triangle_has_a_straight_material_ratio_curve():
    share = (np.arange(8000) + 0.5) / 1000 % 1
    found = parameters(4e-6 * np.abs(share - 0.5) - 1e-6, (PITCH,))
    assert found["Ra"] == near(0.5e-6)
    assert found["Rq"] == near(1e-6 / np.sqrt(3))
    assert found["Rku"] == near(1.8)
    assert found["Rk"] == near(2e-6)
    assert found["Rmrk2"] - found["Rmrk1"] == near(1.0)


def test_two_waves_have_the_moments_of_their_sum():
    """Of a sin kx + b cos 2kx: skewness and kurtosis by trigonometry."""
    a, b, k = 1e-6, 0.4e-6, 2 * np.pi / 2e-4
    x = PITCH * np.arange(8000)
    found = parameters(a * np.sin(k * x) + b * np.cos(2 * k * x), (PITCH,))
    second = (a**2 + b**2) / 2
    assert found["Rq"] == near(np.sqrt(second))
    assert found["Rsk"] == near(-0.75 * a**2 * b / second**1.5)
    fourth = 0.375 * (a**4 + b**4) + 1.5 * a**2 * b**2
    assert found["Rku"] == near(fourth / second**2)
    assert found["Rdq"] == near(k * np.sqrt((a**2 + 4 * b**2) / 2))


@pytest.mark.parametrize("tilt", [0.0, 0.05e-6])
def test_a_plateau_with_grooves(tilt):
    """Plateaus of 80 %, grooves of 2 um with straight sides: lines in closed form."""
    depth, points = 2e-6, 20_000
    share = (np.arange(points) + 0.5) / points
    heights = np.where(
        share < 0.8, tilt * (1 - share / 0.8), -depth * (share - 0.8) / 0.2
    )
    found = parameters(np.random.default_rng(3).permutation(heights), (PITCH,))
    bottom = tilt - tilt / 0.8
    second = 0.8 - 0.2 * bottom / depth
    assert found["Rk"] == near(tilt / 0.8)
    assert found["Rmrk2"] == near(second)
    assert found["Rvk"] == near(depth + bottom)
    assert found["Rpk"] == pytest.approx(0, abs=1e-10)


def test_a_cylinder_is_removed_as_form():
    """A sine on a cylinder of 50 mm radius keeps its Ra; alone it has Pq and Pt."""
    x = PITCH * (np.arange(8000) - 3999.5)
    bend = 50e-3 - np.sqrt(50e-3**2 - x**2)
    heights = bend + 1e-6 * np.sin(2 * np.pi * x / 1e-4)
    both = Profile("cylinder", heights, PITCH, all_valid(x))
    flat = surface_texture(both, TextureSettings(None, None, form=2))
    assert texture_parameters(flat).values["Ra"] == near(2e-6 / np.pi)
    alone = surface_texture(Profile("bend", bend, PITCH, all_valid(x)), PLAIN)
    values = texture_parameters(alone).values
    size = (8000 * PITCH) ** 2 / 100e-3
    assert values["Rq"] == near(size / (6 * np.sqrt(5)))
    assert values["Rt"] == near(size / 4)
    assert values["Ra"] == near(size * 8 / (36 * np.sqrt(12)))


def test_gradient_and_area_of_a_steep_wave():
    """Sdr of a sine is an elliptic integral."""
    x = 1e-6 * np.arange(6406)
    slope = 2 * np.pi * 8e-6 / 64e-6
    heights = np.tile(8e-6 * np.sin(2 * np.pi * x / 64e-6), (20, 1))
    found = parameters(heights, (1e-6, 1e-6))
    share = slope**2 / (1 + slope**2)
    area = 2 / np.pi * np.sqrt(1 + slope**2) * ellipe(share) - 1
    assert found["Sdr"] == near(area)
    assert found["Sdq"] == near(slope / np.sqrt(2))
    assert found["Sal"] == near(np.arccos(0.2) / (2 * np.pi) * 64e-6)
    assert found["Str"] is None


def test_a_random_field_of_known_spectrum_and_distribution():
    """Waves of random phase give Sq and Sdq, normal quantiles the other heights."""
    rng = np.random.default_rng(4)
    rows, columns = np.mgrid[:256, :256]
    heights = np.zeros((256, 256))
    for _ in range(40):
        m, n = rng.integers(-20, 21, 2)
        size = rng.uniform(0.1e-6, 1e-6) * ((m, n) != (0, 0))
        phase = 2 * np.pi * (m * rows + n * columns) / 256 + rng.uniform(0, 7)
        heights += size * np.cos(phase)
    spectrum = np.abs(np.fft.fft2(heights)) ** 2 / heights.size**2
    wave = 2 * np.pi * np.fft.fftfreq(256, 1e-6)
    square = float(spectrum.sum())
    steep = float((spectrum * (wave[:, None] ** 2 + wave**2)).sum())
    assert parameters(heights, (1e-6, 1e-6))["Sq"] == near(np.sqrt(square))
    # The gradient has no value at the three outer points.
    wide = np.pad(heights, 3, mode="wrap")
    assert parameters(wide, (1e-6, 1e-6))["Sdq"] == near(np.sqrt(steep))
    normal = rng.permutation(ndtri((np.arange(90_000) + 0.5) / 90_000))
    found = parameters(1e-6 * normal.reshape(300, 300), (1e-6, 1e-6))
    assert found["Sa"] == near(1e-6 * np.sqrt(2 / np.pi))
    assert found["Sku"] == near(3)
    assert found["Sxp"] == near(1e-6 * ndtri(0.975))
    high, low = ndtri(0.9), ndtri(0.8)
    density = np.exp(-(high**2) / 2) / np.sqrt(2 * np.pi)
    assert found["Vmp"] == near(1e-6 * (density - 0.1 * high))
    density = np.exp(-(low**2) / 2) / np.sqrt(2 * np.pi)
    assert found["Vvv"] == near(1e-6 * (density - 0.2 * low))


def test_decay_lengths_of_crossed_waves():
    """Way to 0.2 of the autocorrelation over a finite map, integrated in closed form.

    Two points a lag t apart are both in the map over its side less t; the waves do not
    fill that length with whole periods, which moves the way by 0.3 % of an endless map.
    """
    rows, columns = np.mgrid[:900, :900] + 0.5
    k, m = 2 * np.pi / 20, 2 * np.pi / 30
    heights = np.sin(k * columns) + np.sin(m * rows)
    found = parameters(1e-6 * heights, (1e-6, 1e-6))

    def product(k, lag):
        length = 900 - lag
        ends = np.sin(2 * k * length + k * lag) - np.sin(k * lag)
        return (np.cos(k * lag) - ends / (2 * k * length)) / 2

    def mean(k, lag, start):
        length = 900 - lag
        return (np.cos(k * start) - np.cos(k * (start + length))) / (k * length)

    angle = np.linspace(0, np.pi / 2, 181)[:, None]
    r = np.linspace(0, 20, 4001)
    x, y = r * np.cos(angle), r * np.sin(angle)
    acf = product(k, x) + product(m, y)
    acf += mean(k, x, 0) * mean(m, y, y) + mean(k, x, x) * mean(m, y, 0)
    lengths = r[(acf < 0.2).argmax(axis=1)]
    assert found["Sal"] == near(1e-6 * lengths.min())
    assert found["Str"] == near(lengths.min() / lengths.max())


def test_the_core_of_normal_heights():
    """The equivalent line of the normal quantiles, its ends and its triangles."""
    share = np.linspace(0.3, 0.7, 40_001)
    central = -ndtri(share)
    core = -np.polyfit(share, central, 1)[0]
    first = ndtr(-core / 2)
    peak = np.exp(-(core**2) / 8) / np.sqrt(2 * np.pi) - first * core / 2
    normal = ndtri((np.arange(90_000) + 0.5) / 90_000)
    found = parameters(np.random.default_rng(3).permutation(1e-6 * normal), (PITCH,))
    assert found["Rk"] == near(1e-6 * core)
    assert found["Rmrk1"] == near(first)
    assert found["Rmrk2"] == near(1 - first)
    assert found["Rpk"] == near(2e-6 * peak / first)
    assert found["Rvk"] == near(2e-6 * peak / first)


def test_small_waves_belong_to_the_element_of_their_neighbour():
    """Waves of 1, 0.5 and 0.05 um in turn: the third is below 10 % of Rp."""
    wave = (np.arange(12_000) + 0.37) / 200
    size = np.array([1.0, 0.5, 0.05])[np.floor(wave).astype(int) % 3]
    found = parameters(1e-6 * size * np.sin(2 * np.pi * wave), (PITCH,))
    # 20 narrow and 19 wide elements from each end, and the cut one at neither.
    assert found["Rsm"] == near(1e-6 * (100 * 20 + 200 * 19) / 39)
    assert found["Rc"] == near(1.5e-6)


@pytest.mark.parametrize("shape", [(3000,), (60, 90)])
def test_a_plane_has_no_shape_of_its_distribution(shape):
    """What is left of equal heights is rounding, not texture."""
    heights = np.full(shape, 3e-6)
    valid = all_valid(heights)
    surface = (
        Profile("flat", heights, PITCH, valid)
        if len(shape) == 1
        else Areal("flat", heights, (1e-6, 1e-6), valid)
    )
    settings = TextureSettings(5e-6, None)
    values = texture_parameters(surface_texture(surface, settings)).values
    letter = "R" if len(shape) == 1 else "S"
    assert values[f"{letter}q"] == 0
    for name in ("sk", "ku", "mrk1", "mrk2"):
        assert values[letter + name] is None


@pytest.mark.parametrize("degrees", [0, 30, 90, 135])
def test_the_texture_direction_is_that_of_the_lay(degrees):
    rows, columns = np.mgrid[:256, :256]
    across = np.radians(degrees + 90)
    place = columns * np.cos(across) + rows * np.sin(across)
    found = parameters(1e-6 * np.sin(2 * np.pi * place / 15), (1e-6, 1e-6))
    apart = (np.degrees(found["Std"]) - degrees + 90) % 180 - 90
    assert abs(apart) < 0.2


def test_missing_points_do_not_move_a_map():
    """Three percent of the points are missing; parameters stay within 0.5 %."""
    rng = np.random.default_rng(5)
    x = np.arange(640) * 1e-6
    heights = np.tile(1e-6 * np.sin(2 * np.pi * x / 64e-6), (300, 1))
    valid = rng.random(heights.shape) > 0.03
    gaps = Areal("gaps", np.where(valid, heights, 0), (1e-6, 1e-6), valid)
    whole = Areal("whole", heights, (1e-6, 1e-6), all_valid(heights))
    settings = TextureSettings(5e-6, None)
    one, two = (
        texture_parameters(surface_texture(s, settings)).values for s in (gaps, whole)
    )
    for name in ("Sa", "Sq", "Sal", "Sdq", "Sk", "Sz"):
        assert one[name] == pytest.approx(two[name], rel=5e-3), name


@pytest.mark.parametrize("seed", range(6))
def test_a_small_map_has_a_lay_though_bins_of_direction_are_empty(seed):
    noise = 1e-22 * np.random.default_rng(seed).normal(size=(24, 36))
    assert parameters(noise, (1e-6, 1e-6))["Std"] is not None
