"""Uncertainty of texture parameters: its causes, one by one, and several places."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.signal.roughness.height_noise import height_noise
from jointbench.signal.roughness.pooled_texture import pooled_texture
from jointbench.signal.roughness.setting_classes import (
    class_of_roughness,
    map_s_index,
    setting_class,
)
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_records import TextureSettings
from jointbench.signal.roughness.texture_uncertainty import measured_texture
from jointbench.signal.roughness.uncertain_parameters import InstrumentErrors

PITCH = 0.5e-6
SETTINGS = TextureSettings(2.5e-6, 0.25e-3, setting_class="Sc2")


def rough(seed, *, points=3400, noise=0.0):
    """Return a Gaussian profile of 0.3 um rms and 6 um correlation length."""
    rng = np.random.default_rng(seed)
    heights = gaussian_filter1d(rng.normal(size=points), 8)
    heights *= 0.3e-6 / heights.std()
    heights = heights + noise * rng.normal(size=points)
    return Profile("rough", heights, PITCH, all_valid(heights))


def test_the_noise_of_heights_is_read_from_the_end_of_the_spectrum():
    assert height_noise(rough(1, noise=20e-9)) == pytest.approx(20e-9, rel=0.1)
    assert height_noise(rough(1)) < 1e-10


def test_height_errors_scale_heights_and_pitch_errors_spacings():
    found = measured_texture(rough(2), SETTINGS, InstrumentErrors(0.02, 0.01, 0.0))
    parts = dict(found.named("Ra").parts)
    assert parts["height"] == pytest.approx(0.02 * found.named("Ra").value)
    assert dict(found.named("Rsk").parts)["height"] == pytest.approx(0, abs=1e-9)
    wave = 1e-6 * np.sin(np.arange(3400) / 10)
    sine = Profile("sine", wave, PITCH, all_valid(wave))
    errors = InstrumentErrors(0.0, 0.01, 0.0)
    steep = measured_texture(sine, SETTINGS, errors).named("Rdq")
    assert dict(steep.parts)["pitch"] == pytest.approx(0.01 * steep.value, rel=0.1)


def test_noise_that_adds_to_gradients_is_in_the_interval():
    """Noise of 10 nm raises Rdq; the interval is that of the profile without noise."""
    truth = measured_texture(rough(3), SETTINGS).named("Rdq").value
    found = measured_texture(rough(3, noise=10e-9), SETTINGS).named("Rdq")
    low, high = found.interval
    assert found.value > 1.005 * truth
    assert low < truth < high


def test_several_places_have_the_scatter_of_their_mean():
    several = [measured_texture(rough(seed), SETTINGS) for seed in range(4, 8)]
    values = [one.named("Rq").value for one in several]
    pooled = next(one for one in pooled_texture(several) if one.name == "Rq")
    assert pooled.value == pytest.approx(np.mean(values))
    repeats = dict(pooled.parts)["repeats"]
    assert repeats == pytest.approx(np.std(values, ddof=1) / 2)
    assert 2.0 < pooled.factor <= 3.19


def test_setting_classes_by_roughness_and_series_of_maps():
    assert class_of_roughness(5e-6).name == "Sc3"
    assert setting_class("sc4").long == 2.5e-3
    assert map_s_index(1e-6) == pytest.approx(5e-6)
    assert map_s_index(1.1e-6) == pytest.approx(8e-6)
    with pytest.raises(UsageError, match="Sc1, Sc2, Sc3, Sc4, Sc5"):
        setting_class("N6")


def test_a_short_profile_keeps_its_ends_and_says_how_many_sections_fit():
    texture = surface_texture(rough(8, points=2100), SETTINGS)
    assert texture.sections == 4
    assert "4 of 5 sections" in " ".join(texture.remarks)
    with pytest.raises(UsageError, match="shorter than one section"):
        surface_texture(rough(8, points=400), SETTINGS)


def test_steps_of_a_parameter_do_not_shift_its_interval():
    """Material ratios step with the central region: noise adds scatter, no shift."""
    found = measured_texture(rough(9, noise=10e-9), SETTINGS)
    for name in ("Rmrk1", "Rmrk2"):
        assert found.named(name).bias == 0
        assert dict(found.named(name).parts)["noise"] > 0
    assert found.named("Rdq").bias > 0
