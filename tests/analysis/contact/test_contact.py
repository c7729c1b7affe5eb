# SPDX-License-Identifier: MIT
from dataclasses import replace

import numpy as np
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.contact.asperity_laws import Regime
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import (
    ContactMaterial,
    YieldCriterion,
    yield_ratio,
)
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS, contact_model
from jointbench.analysis.contact.models import Interaction, interaction_share
from jointbench.analysis.contact.predict import ContactVerdict, predict_contact

IRON = ContactMaterial(69.3e9, 2.265e9, 0.25)


def lowest(name):
    return contact_model(name).topography.lowest_dimension


@pytest.mark.parametrize("model", CONTACT_MODELS)
def test_stiffness_rises_with_preload(model):
    """Every model, three decades of preload, where contacts have any stiffness."""
    sums = contact_curve(
        model,
        dimension=lowest(model) + 0.5,
        roughness=1e-9,
        material=IRON,
        preload=np.logspace(1, 4, 30),
    )
    assert np.all(np.diff(sums.stiffness.sum(axis=0)) > 0)


@pytest.mark.parametrize("model", CONTACT_MODELS)
def test_stiffness_falls_with_roughness(model):
    """Every model, from G of 0.1 pm to 10 nm."""
    sums = contact_curve(
        model,
        dimension=lowest(model) + 0.5,
        roughness=np.logspace(-13, -8, 30),
        material=IRON,
        preload=1e3,
    )
    assert np.all(np.diff(sums.stiffness.sum(axis=0)) < 0)


def test_stiffness_has_its_greatest_value_inside_the_range_of_dimension():
    """It does not always rise with D, as the papers state: it falls near the end."""
    offset = np.linspace(0.4, 0.98, 200)
    sums = contact_curve(
        "modified_2d", dimension=1 + offset, roughness=1e-9, material=IRON, preload=1e3
    )
    best = 1 + offset[np.argmax(sums.stiffness.sum(axis=0))]
    assert 1.78 < best < 1.86


def test_interaction_stiffens_a_joint_of_given_load():
    """Each contact bears less, so the largest grows: more stiffness at equal load."""
    options = {
        "dimension": 2.54,
        "roughness": 1e-9,
        "material": IRON,
        "preload": 5e3,
    }
    with_it = predict_contact(joint_case("ke_3d_modified", **options)).normal_stiffness
    without = predict_contact(joint_case("ke_3d", **options)).normal_stiffness
    assert 1.1 < with_it / without < 1.35


def test_interaction_changes_nothing_while_no_contact_is_elastic():
    """A very rough surface: the largest contact is below the critical area."""
    options = {"dimension": 2.54, "roughness": 5e-5, "material": IRON, "preload": 50.0}
    with_it = predict_contact(joint_case("ke_3d_modified", **options))
    without = predict_contact(joint_case("ke_3d", **options))
    assert_allclose(with_it.normal_stiffness, without.normal_stiffness, rtol=1e-12)
    assert with_it.tangential_stiffness == 0
    assert any("no contact is elastic" in reason for reason in with_it.reasons)


def test_parts_by_regime_add_up_to_the_preload_and_the_stiffness():
    """What the regimes carry is what was put on the joint."""
    state = predict_contact(
        joint_case(
            "friction_3d", dimension=2.6, roughness=1e-9, material=IRON, preload=777.0
        )
    )
    assert_allclose(sum(state.load_parts.values()), 777.0, rtol=1e-12)
    assert_allclose(sum(state.stiffness_parts.values()), state.normal_stiffness)


def test_tangential_to_normal_stiffness_is_mindlins_ratio_in_hertz_geometry():
    """2 (1 - nu)/(2 - nu) = 6/7 at Poisson 0.25, elastic contacts, no slip."""
    state = predict_contact(
        joint_case("ke_3d", dimension=2.5, roughness=1e-10, material=IRON, preload=1e3)
    )
    elastic = state.stiffness_parts[Regime.ELASTIC]
    assert_allclose(state.tangential_stiffness / elastic, 6 / 7, rtol=1e-12)


def test_tangential_stiffness_of_given_contacts_ignores_normal_interaction():
    """It depends on the contact radii: rescaled by the largest area's growth only."""
    options = {"dimension": 2.5, "roughness": 1e-10, "material": IRON}
    state = predict_contact(joint_case("ke_3d_modified", preload=1e3, **options))
    model = replace(contact_model("ke_3d_modified"), interaction=Interaction.NONE)
    # The load at which the model without interaction has the same largest area.
    loads = np.logspace(2, 5, 2000)
    sums = contact_curve(model, preload=loads, **options)
    same = float(np.interp(state.largest_area, sums.largest_area, loads))
    other = predict_contact(joint_case(model, preload=same, **options))
    assert_allclose(other.largest_area, state.largest_area, rtol=1e-5)
    assert_allclose(state.tangential_stiffness, other.tangential_stiffness, rtol=1e-5)


def test_a_joint_of_plastic_contacts_has_no_stiffness_and_says_so():
    """Dimension near its lower end: every contact is beyond the second stage."""
    state = predict_contact(
        joint_case(
            "modified_2d", dimension=1.1, roughness=1e-9, material=IRON, preload=1e3
        )
    )
    assert state.normal_stiffness == 0
    assert state.verdict is ContactVerdict.FULLY_PLASTIC
    assert "fully plastic" in state.reasons[-1]


def test_a_real_area_above_the_nominal_one_is_a_verdict():
    """The model does not know the joint's size; the guard does."""
    options = {"dimension": 1.5, "roughness": 1e-9, "material": IRON, "preload": 1e3}
    fine = predict_contact(joint_case("ke_2d", nominal_area=1e-2, **options))
    over = predict_contact(joint_case("ke_2d", nominal_area=1e-7, **options))
    assert fine.verdict is ContactVerdict.USABLE
    assert over.verdict is ContactVerdict.OVER_NOMINAL


def test_a_real_area_far_above_the_largest_contact_is_remarked():
    """Near the upper end of the dimension a_r / a_l diverges."""
    state = predict_contact(
        joint_case("ke_2d", dimension=1.99, roughness=1e-9, material=IRON, preload=1e3)
    )
    assert any("times the largest contact" in reason for reason in state.reasons)


@pytest.mark.parametrize(
    ("model", "dimension", "hint"),
    [("ke_3d", 1.54, "2.54"), ("ke_2d", 2.3, "1.3"), ("ke_2d", 3.7, "local slope")],
)
def test_a_dimension_of_the_other_kind_is_refused_with_the_way_out(
    model, dimension, hint
):
    """Profile and surface dimensions differ by one: the message suggests the other."""
    with pytest.raises(BadData, match=hint):
        predict_contact(
            joint_case(
                model, dimension=dimension, roughness=1e-9, material=IRON, preload=1e3
            )
        )


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("roughness", 0.0),
        ("roughness", float("nan")),
        ("preload", 0.0),
        ("preload", -5.0),
        ("gamma", 1.0),
    ],
)
def test_a_number_no_joint_can_have_is_refused(name, value):
    """The message names the quantity."""
    options = {"dimension": 1.5, "roughness": 1e-9, "preload": 1e3, name: value}
    with pytest.raises(BadData, match=name):
        predict_contact(joint_case("ke_2d", material=IRON, **options))


def test_an_unknown_model_answers_with_the_nearest_name():
    """A slip of the pen finds its model."""
    with pytest.raises(UsageError, match="did you mean 'ke_3d_modified'"):
        contact_model("ke3d_modified")


@pytest.mark.parametrize(
    ("model", "share"), [("ke_3d_modified", 0.62675), ("modified_2d", 0.73342)]
)
def test_the_share_of_an_interacting_asperity_balances_both_expressions(model, share):
    """Hertz and the sinking of the mean surface bear the same load at x."""
    record = contact_model(model)
    x = interaction_share(record)
    assert_allclose(16 / (9 * record.topography.shape) * x**3, (1 - x) ** 2)
    assert_allclose(x, share, atol=5e-6)


def test_hardness_and_friction_criteria_are_those_of_the_2023_paper():
    """Pi H/(2 E), and 33 pi/40 k_mu sigma_y/E with a yield strength of its own."""
    material = replace(IRON, yield_strength=3e8, friction_factor=0.9)
    hard = np.array(IRON.hardness)
    found = yield_ratio(YieldCriterion.HARDNESS, material, hard)
    assert_allclose(found, np.pi * 2.265 / (2 * 69.3))
    found = yield_ratio(YieldCriterion.FRICTION, material, hard)
    assert_allclose(found, 33 * np.pi / 40 * 0.9 * 0.3 / 69.3)


def test_a_material_that_cannot_exist_is_refused():
    """Poisson ratios end at one half."""
    with pytest.raises(UsageError, match="poisson"):
        ContactMaterial(69e9, 2e9, 0.6)


@pytest.mark.parametrize(
    ("changed", "match"),
    [
        ({"preload": 1e300}, "preload is 1e"),
        ({"roughness": 1e-300}, "roughness is 1e-300"),
        ({"roughness": 50.0}, "roughness is 50"),
        ({"gamma": 1e300}, "gamma"),
        ({"nominal_area": np.nan}, "nominal area"),
    ],
)
def test_a_number_beyond_every_joint_is_refused(changed, match):
    """Not answered with infinite areas that call themselves usable."""
    usual = {"dimension": 1.5, "roughness": 1e-9, "preload": 4e3}
    with pytest.raises(BadData, match=match) as caught:
        predict_contact(joint_case("modified_2d", material=IRON, **usual | changed))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("modulus", [1e-300, 1e300])
def test_a_modulus_no_solid_has_is_refused(modulus):
    """It would be a number in the wrong unit."""
    with pytest.raises(BadData, match=r"effective_modulus.*Pa"):
        ContactMaterial(modulus, 2e9)


@pytest.mark.parametrize("model", CONTACT_MODELS)
@pytest.mark.parametrize("offset", [1e-9, 0.02, 0.5, 0.98, 1 - 1e-9])
@pytest.mark.parametrize("corner", list(np.ndindex(2, 2, 2, 2)))
def test_every_corner_of_the_ranges_is_finite_or_refused(model, offset, corner):
    """No prediction holds a number that is not finite."""
    preload = (1e-9, 1e12)[corner[0]]
    roughness = (1e-60, 1.0)[corner[1]]
    material = ContactMaterial((1e3, 1e13)[corner[2]], (1e3, 1e13)[corner[3]])
    try:
        sums = contact_curve(
            model,
            dimension=lowest(model) + offset,
            roughness=roughness,
            material=material,
            preload=preload,
        )
    except BadData as error:
        assert "not finite" in str(error)
    else:
        assert np.all(np.isfinite([sums.largest_area, sums.real_area]))
        assert np.all(np.isfinite(sums.stiffness))
