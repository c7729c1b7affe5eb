# SPDX-License-Identifier: MIT
import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.analysis.contact.asperity import (
    asperity_load,
    asperity_stiffness,
    interference,
    interference_ratio,
    log_critical_area,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import Interaction

MATERIAL = ContactMaterial(69.3e9, 2.265e9, 0.25)
PROFILE = FractalSurface(np.array(1.5), np.array(1e-9), np.array(2.265e9))
AREAL = FractalSurface(np.array(2.5), np.array(1e-9), np.array(2.265e9))


def at_ratio(model, surface, ratio):
    """Return ln of the area whose interference is `ratio` times the critical one."""
    e = float(surface.dimension) % 1
    return log_critical_area(model, surface, MATERIAL) - math.log(ratio) / e


def test_interference_of_a_profile_asperity_is_the_printed_power_of_its_area():
    """The power law delta = G^(D-1) a^((2-D)/2), eq. (15) of the 2023 paper."""
    found = interference(contact_model("ke_2d"), PROFILE, np.array(4e-12))
    assert_allclose(found, 1e-9**0.5 * 4e-12**0.25, rtol=1e-13)


def test_interference_of_a_surface_asperity_is_the_printed_power_of_its_area():
    """Eq. (38) of the 2023 paper, exponent of 2 restored to (11 - 3 D)/2."""
    found = interference(contact_model("ke_3d"), AREAL, np.array(4e-12))
    constant = 2**1.75 * math.log(1.5) ** 0.5 * math.pi**-0.25
    assert_allclose(found, constant * 1e-9**0.5 * 4e-12**0.25, rtol=1e-13)


@pytest.mark.parametrize(("ratio", "jump"), [(1.0, 1.03), (6.0, 1.017)])
def test_load_jumps_between_stages_by_what_kogut_and_etsion_left(ratio, jump):
    """1.03 at first yield by definition; 1.40/1.03 6^(1.263-1.425) at the second."""
    model = contact_model("ke_2d")
    edge = at_ratio(model, PROFILE, ratio)
    softer = asperity_load(model, PROFILE, MATERIAL, edge - 1e-9)
    stiffer = asperity_load(model, PROFILE, MATERIAL, edge + 1e-9)
    assert_allclose(softer / stiffer, jump, rtol=1e-3)


def test_full_plasticity_of_a_profile_nearly_meets_the_second_stage():
    """With kappa = pi H/(2 E) H a is 3 pi/(2.8 * 110^0.263) = 0.978 of the stage."""
    model = contact_model("modified_2d")
    edge = at_ratio(model, PROFILE, 110.0)
    plastic = asperity_load(model, PROFILE, MATERIAL, edge - 1e-9)
    second = asperity_load(model, PROFILE, MATERIAL, edge + 1e-9)
    wanted = 3 * math.pi / (2.8 * 110**0.263)
    assert_allclose(plastic / second, wanted, rtol=1e-6)


@pytest.mark.parametrize("ratio", [0.3, 3.0, 40.0])
@pytest.mark.parametrize("name", ["ke_2d", "ke_3d"])
def test_stiffness_is_the_slope_of_the_load_at_fixed_radius(name, ratio):
    """Hertz and the two stages: dP/d delta by a difference of the law itself."""
    model = contact_model(name)
    surface = PROFILE if name == "ke_2d" else AREAL
    log_area = at_ratio(model, surface, ratio)
    area, delta = np.exp(log_area), interference(model, surface, np.exp(log_area))
    radius = area / (model.topography.shape * delta)
    critical = delta / interference_ratio(model, surface, MATERIAL, log_area)
    law = {0.3: (1.0, 1.5), 3.0: (1.03, 1.425), 40.0: (1.40, 1.263)}[ratio]

    def load(depth):
        yielding = 4 / 3 * 69.3e9 * radius**0.5 * critical**1.5
        return law[0] * yielding * (depth / critical) ** law[1]

    slope = (load(delta * 1.0001) - load(delta * 0.9999)) / (2e-4 * delta)
    found = asperity_stiffness(model, surface, MATERIAL, log_area)
    assert_allclose(asperity_load(model, surface, MATERIAL, log_area), load(delta))
    assert_allclose(found, slope, rtol=1e-7)


def test_interaction_softens_an_elastic_contact_of_given_area():
    """0.5599 E sqrt(a) instead of Hertz's 1.1284 E sqrt(a) in the surface geometry."""
    model = contact_model("ke_3d_modified")
    log_area = at_ratio(model, AREAL, 0.1)
    unit = 69.3e9 * np.exp(log_area / 2)
    with_it = asperity_stiffness(model, AREAL, MATERIAL, log_area) / unit
    model = replace(model, interaction=Interaction.NONE)
    without = asperity_stiffness(model, AREAL, MATERIAL, log_area) / unit
    assert_allclose((with_it, without), (0.5599, 2 / math.sqrt(math.pi)), rtol=1e-4)
