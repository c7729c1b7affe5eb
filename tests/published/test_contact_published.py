# SPDX-License-Identifier: MIT
"""Joint contact numbers: printed in the two papers, or frozen from a second program."""

import math
from dataclasses import replace

import numpy as np
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.analysis.contact.asperity_laws import REGIMES, PowerLaw, Regime
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import (
    ContactMaterial,
    YieldCriterion,
    effective_modulus,
)
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import Interaction
from jointbench.analysis.contact.predict import predict_contact
from jointbench.analysis.contact.torque_to_preload import preload_from_torque

# The stiffness (sqrt 3 / 2) E sqrt(a) of eq. (5) as a share of Hertz's 2 E sqrt(a/pi).
PRINTED_ELASTIC = PowerLaw(math.sqrt(3 * math.pi) / 4, 1.5)


@pytest.mark.parametrize(
    ("model", "dimension", "roughness", "modulus", "hardness", "load", "stiffness"),
    [
        ("modified_2d", 1.4, 1e-10, 69.3e9, 2.265e9, 1e4, 2.891751718150069e11),
        ("ke_2d", 1.7, 1e-9, 69.3e9, 2.265e9, 1e3, 1.040296352066882e11),
        ("ke_3d_modified", 2.54, 1e-9, 29.333333e9, 1.5e9, 1e3, 3.784376529408323e10),
    ],
)
def test_three_joint_stiffnesses_stay_as_a_second_program_found_them(
    model, dimension, roughness, modulus, hardness, load, stiffness
):
    """Values of an independent implementation by direct summation, Poisson 0.25."""
    found = predict_contact(
        joint_case(
            model,
            dimension=dimension,
            roughness=roughness,
            material=ContactMaterial(modulus, hardness, 0.25),
            preload=load,
        )
    )
    assert_allclose(found.normal_stiffness, stiffness, rtol=1e-9)


@pytest.mark.parametrize(
    ("load", "largest_area", "stiffness"),
    [
        (1e2, 6.764581658292505e-08, 11600035775.59 + 3695295408.96 + 2784283250.21),
        (1e3, 1.0087844823796597e-06, 115340853452.08 + 36742863080.12 + 27854005322.6),
    ],
)
def test_kogut_etsion_profile_joint_without_interaction(load, largest_area, stiffness):
    """D 1.7, G 1 nm, E 69.3 GPa, H 231 HB, yield by hardness: a frozen evaluation."""
    model = replace(contact_model("modified_2d"), interaction=Interaction.NONE)
    found = predict_contact(
        joint_case(
            model,
            dimension=1.7,
            roughness=1e-9,
            material=ContactMaterial(69.3e9, 2265336150.0, 0.25),
            preload=load,
        )
    )
    assert_allclose(found.largest_area, largest_area, rtol=1e-9)
    assert_allclose(found.normal_stiffness, stiffness, rtol=1e-9)


@pytest.mark.parametrize("dimension", [2.3, 2.4, 2.5404, 2.7])
def test_the_printed_stiffness_formula_of_2025_follows_from_its_own_terms(dimension):
    """Appl. Sci. 2025, 15, 9040, eq. (8): its three terms, four-digit coefficients."""
    modulus, hardness, roughness, gamma, factor = 69.3e9, 2.265e9, 1e-9, 1.5, 0.5565
    model = replace(
        contact_model("ke_3d_modified"),
        elastic=PRINTED_ELASTIC,
        second=PowerLaw(1.40, 1.236),
        interaction=Interaction.NONE,
        population=0.5,
    )
    surface = FractalSurface(
        np.array(dimension), np.array(roughness), np.array(hardness), gamma
    )
    material = ContactMaterial(modulus, hardness, 0.25)
    large = np.log(1.0)  # far above every critical area here: no segment is empty
    sums = joint_sums(model, surface, material, large)
    D, E, G, H, ac, lg = (
        dimension,
        modulus,
        roughness,
        hardness,
        float(sums.critical_area),
        math.log(gamma),
    )
    elastic = 0.433 * E * (D - 1) / (2 - D) * (1 - ac ** ((2 - D) / 2))
    # The flattened print has lost the fraction bar: pi^(0.075 D + 0.2), the logarithm
    # and D - 2 belong below it, as the dimensions and the derivation require.
    first = (
        0.4894
        * 2 ** (0.225 * D + 0.45)
        * (E**0.85 * G ** (0.3 - 0.15 * D) * H**0.15 * ac ** (0.85 - 0.425 * D))
        * factor**0.15
        * (D - 1)
        / math.pi ** (0.075 * D + 0.2)
        * lg**-0.075
        / (D - 2)
    )
    second = (
        0.2301
        * 2 ** (0.792 * D + 0.568)
        * (E**0.472 * G ** (1.056 - 0.528 * D) * H**0.528 * ac ** (0.472 - 0.236 * D))
        * factor**0.528
        * math.pi ** (0.556 - 0.264 * D)
        * (D - 1)
        * lg**-0.264
        / (D - 2)
    )
    found = dict(zip(REGIMES, sums.stiffness, strict=True))
    assert_allclose(found[Regime.ELASTIC], elastic, rtol=1e-4)
    assert_allclose(found[Regime.ELASTIC_PLASTIC_1], first, rtol=1e-4)
    assert_allclose(found[Regime.ELASTIC_PLASTIC_2], second, rtol=4e-4)


def test_composite_modulus_of_the_2023_figures():
    """Two parts of 130 GPa, Poisson 0.25, make the 69.3 GPa of figure 7."""
    assert_allclose(effective_modulus(130e9, 0.25, 130e9, 0.25), 69.33e9, rtol=1e-3)


def test_preload_of_the_marble_plates():
    """Four bolts of 16 mm at 20 N m carry the 25 kN of the 2025 paper's rig."""
    found = preload_from_torque(20.0, diameter=0.016, bolts=4, nut_factor=0.2)
    assert_allclose(found.value, 25e3, rtol=1e-12)


def test_critical_area_of_the_2023_profile_model():
    """Eq. (23), a_c = G^2 / (k phi / 2)^(2/(D-1)), evaluated as printed."""
    model = contact_model("modified_2d")
    assert model.yielding is YieldCriterion.HARDNESS
    found = predict_contact(
        joint_case(
            model,
            dimension=1.5,
            roughness=1e-10,
            material=ContactMaterial(69.3e9, 2.265e9, 0.25),
            preload=1e3,
        )
    )
    printed = 1e-20 / (2.265e9 / 69.3e9 / 2) ** (2 / 0.5)
    assert_allclose(found.critical_area, printed, rtol=1e-12)
