"""Campaigns: drawn from a seed, written in the schema, sized by their margin."""

import json
from dataclasses import replace

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.simulators.campaigns.campaign_records import (
    campaign_noise_free,
    make_campaign,
    size_to_margin,
)
from jointbench.simulators.campaigns.write_campaign import (
    read_truth,
    truth_path,
    write_campaign,
)
from jointbench.simulators.detectability.expected_margin import (
    expected_margin,
    margin_scale,
)
from jointbench.simulators.hidden.campaign_design import (
    GRIDS,
    NOMINAL_SIGMA,
    draw_design,
)
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.effect_draws import (
    CATALOGUE,
    FAMILIES,
    OUTSIDE_CATALOGUE,
    draw_effect,
    resize_effect,
    specimen_scales,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

NULL = make_campaign(7, grid="small", noise=0.05)


@pytest.fixture(scope="module")
def scale():
    """A small design, prepared for margins."""
    return margin_scale(draw_design(21, grid="small", noise=0.1))


@pytest.fixture(scope="module")
def few():
    """The same with four hits: three levels, two preloads, both points."""
    design = draw_design(21, grid="small", noise=0.1)
    return margin_scale(replace(design, conditions=design.conditions[::2]))


def test_the_same_seed_makes_the_same_campaign():
    """Bit for bit; another seed another specimen."""
    again = make_campaign(7, grid="small", noise=0.05)
    assert np.array_equal(again.acceleration, NULL.acceleration)
    assert make_campaign(8, grid="small").design.nominal != NULL.design.nominal


def test_an_effect_changes_neither_specimen_nor_hits():
    """A campaign with an effect and without differ by the effect only."""
    effect = HiddenEffect("delay", {"tau": 4e-5, "dof": 1})
    with_delay = make_campaign(7, effects=[effect], grid="small", noise=0.05)
    assert with_delay.design == NULL.design
    assert np.array_equal(with_delay.force, NULL.force)
    assert np.array_equal(with_delay.acceleration[:, 0], NULL.acceleration[:, 0])


def test_the_noise_is_white_and_of_the_stated_size():
    """Deviation from the noise-free records, within 4 sigma; force 0.4 of it."""
    force, acceleration = campaign_noise_free(NULL)
    for noisy, clean, size in (
        (NULL.force, force, 0.02),
        (NULL.acceleration, acceleration, 0.05),
    ):
        noise = (noisy - clean).ravel()
        assert abs(noise.std() / size - 1) < 4 / np.sqrt(2 * noise.size)
        assert abs(np.mean(noise[1:] * noise[:-1])) < 4 * size**2 / np.sqrt(noise.size)


def test_hits_begin_near_sample_128_and_keep_their_levels():
    """Peaks within 10 % of the level, and quiet before sample 110."""
    force, _ = campaign_noise_free(NULL)
    for row, condition in zip(force, NULL.design.conditions, strict=True):
        assert 0.88 < row.max() / condition.level < 1.11
        assert 128 < np.argmax(row) < 142
        assert np.abs(row[:110]).max() < 1e-3 * condition.level


def test_true_values_scatter_by_the_priors():
    """Over 200 designs standardised errors of nominal values have unit variance."""
    for name, sigma in NOMINAL_SIGMA.items():
        errors = [
            np.log(d.physical[name] / d.nominal[name]) / sigma
            for d in map(draw_design, range(200))
        ]
        assert abs(np.std(errors) - 1) < 4 / np.sqrt(2 * 200)


def test_every_grid_has_repeats_both_points_and_several_preloads():
    """Levels span 30x; a condition is measured twice."""
    for grid in GRIDS.values():
        levels = [level for _, level, _ in grid]
        assert len(grid) >= 8
        assert max(levels) / min(levels) > 30
        assert {dof for dof, _, _ in grid} == {0, 1}
        assert len({ratio for _, _, ratio in grid}) >= 2
        assert len(set(grid)) < len(grid)


def test_the_scatter_between_hits_shows_in_the_conditions():
    """A good operator scatters by 0.2 %, none by 0."""
    scattered = draw_design(5, grid="full", hit_scatter=0.002).conditions
    factors = np.array([c.force_factor for c in scattered])
    assert 0.001 < factors.std() < 0.004
    assert all(c.joint_factor == 1 for c in draw_design(5, grid="full").conditions)


def test_an_unknown_grid_is_refused():
    """The message lists the grids."""
    with pytest.raises(UsageError, match="full, middle, small"):
        draw_design(1, grid="huge")


def test_the_file_has_the_schema_of_campaigns(tmp_path):
    """Attributes, shapes and types as the readers expect them."""
    path = tmp_path / "case.h5"
    write_campaign(NULL, path)
    with h5py.File(path) as file:
        assert file.attrs["schema"] == "two-body-campaign/1"
        assert file.attrs["fs_hz"] == 16384.0
        assert set(json.loads(file.attrs["nominal"])) == set(NOMINAL_SIGMA)
        assert json.loads(file.attrs["nominal_rel_sigma"])["kj"] == 0.1
        assert list(file["records"]) == [f"r{i:02d}" for i in range(8)]
        record = file["records/r03"]
        assert record["force"].shape == (2048,)
        assert record["accel"].shape == (2, 2048)
        assert record["accel"].dtype == np.float32
        assert set(record.attrs) == {"level_N", "hit_dof", "preload_N", "order"}
        assert_allclose(record["accel"][:], NULL.acceleration[3], rtol=1e-6)


def test_the_truth_lies_beside_the_file(tmp_path):
    """An outsider is `unknown` to find, and named in the effects."""
    effects = [
        HiddenEffect("quintic_stiffness", {"k5": 1e25}),
        HiddenEffect("gain_error", {"frac": 0.03, "dof": 0}),
    ]
    campaign = make_campaign(3, effects=effects, grid="small")
    path = tmp_path / "case.h5"
    write_campaign(campaign, path)
    truth = read_truth(path)
    assert truth["truth"] == ["unknown", "gain_error"]
    assert truth["effects"]["quintic_stiffness"] == {"k5": 1e25}
    assert truth["sites"]["gain_error"] == "channel:a0"
    assert truth["margins"]["gain_error"]["rho"] > 1


def test_a_null_says_none(tmp_path):
    """Nothing hidden, nothing to find."""
    path = tmp_path / "case.h5"
    write_campaign(NULL, path)
    assert read_truth(path)["truth"] == ["none"]


def test_a_missing_truth_is_refused_with_its_place(tmp_path):
    """One line with the expected place."""
    with pytest.raises(FormatError, match=r"case\.truth\.json"):
        read_truth(tmp_path / "case.h5")
    truth_path(tmp_path / "case.h5").write_text("{")
    with pytest.raises(FormatError, match=r"case\.truth\.json"):
        read_truth(tmp_path / "case.h5")


def test_a_named_effect_reaches_the_margin_it_is_asked_for():
    """Within a factor of 3; the margin travels with the campaign."""
    campaign = make_campaign(11, effects=["maxwell"], margin=300.0, grid="small")
    assert abs(np.log(campaign.margins[0].margin / 300.0)) < np.log(3)
    assert campaign.truth == ("maxwell",)


@pytest.mark.parametrize("name", ["jenkins", "delay", "added_mass", "thermal_drift"])
def test_sizes_follow_the_margin_even_where_rivals_are_close(few, name):
    """From friction to sensors, within a factor of 3."""
    largest = draw_effect(name, few.scales, np.random.default_rng(2))
    sized = size_to_margin(few, largest, 40.0)
    assert abs(np.log(expected_margin(few, sized).margin / 40.0)) < np.log(3)


def test_an_effect_that_cannot_reach_its_margin_is_as_large_as_can_be(few):
    """A clipped mass stays physical."""
    largest = draw_effect("added_mass", few.scales, np.random.default_rng(2))
    assert size_to_margin(few, largest, 1e7) == largest


def test_the_prior_deviation_of_an_added_mass_is_its_logarithm_over_the_prior(scale):
    """The base follows it exactly, so only the prior of the mass is left."""
    mass = scale.view.design.physical["m1"]
    effect = HiddenEffect("added_mass", {"m": 0.01 * mass, "dof": 0})
    rho = expected_margin(scale, effect).rho
    assert_allclose(rho, np.log(1.01) / 0.003, rtol=1e-3)


def test_rho_of_a_small_effect_grows_with_its_size(scale):
    """Twice the stiffness, twice the change."""
    small = HiddenEffect("maxwell", {"k": 2e4, "tau": 2e-4})
    double = resize_effect(small, 2.0)
    ratio = expected_margin(scale, double).rho / expected_margin(scale, small).rho
    assert_allclose(ratio, 2.0, rtol=0.02)


def test_a_short_delay_and_a_low_pass_are_not_distinguished(scale):
    """To first order they are one effect: correlation 1."""
    delay = HiddenEffect("delay", {"tau": 1e-6, "dof": 1})
    margin = expected_margin(scale, delay)
    assert margin.rival == "sensor_lowpass channel:a1"
    assert margin.correlation > 0.999


def test_hum_has_no_rival(scale):
    """No catalogue effect sounds before the hit."""
    hum = HiddenEffect("hum", {"amp": 0.5, "freq": 50.0, "dof": 0})
    margin = expected_margin(scale, hum)
    assert margin.rho > 10
    assert margin.margin > 0.8 * margin.rho**2


def test_every_effect_can_be_drawn_and_changes_the_records(scale):
    """Catalogue and outsiders at 2 % of their largest size."""
    assert len(CATALOGUE) == 22
    assert len(OUTSIDE_CATALOGUE) >= 8
    design, base = scale.view.design, scale.view.responses
    rng = np.random.default_rng(5)
    for name in FAMILIES:
        effect = resize_effect(draw_effect(name, scale.scales, rng), 0.02)
        change = sketch_responses(design, [effect]) - base
        assert np.all(np.isfinite(change))
        assert np.abs(change).max() > 0.1 * design.noise


def test_the_scales_of_a_specimen_are_those_of_its_hits():
    """The largest elongation lies near the impulse over m2 omega2 of the top hit."""
    design = draw_design(4, grid="small")
    scales = specimen_scales(design)
    assert 5e-6 < scales.elongation < 6e-5
    assert 0.5 < scales.rate / (2 * np.pi * scales.frequency[1] * scales.elongation) < 2


def test_an_unknown_name_is_refused():
    """The message lists what can be hidden."""
    with pytest.raises(UsageError, match="added_mass"):
        make_campaign(1, effects=["gremlin"], grid="small")


def test_an_effect_named_twice_is_refused():
    """The truth has one entry for each name."""
    with pytest.raises(UsageError, match="name one twice"):
        make_campaign(1, effects=["delay", "delay"], grid="small")
