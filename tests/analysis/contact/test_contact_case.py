# SPDX-License-Identifier: MIT
"""The record of a physical case."""

from dataclasses import replace

import pytest
from contact_cases import joint_case

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.contact.damping import DampingChoice
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.spread import ContactSpread
from jointbench.analysis.contact.torque_to_preload import Preload

IRON = ContactMaterial(69.3e9, 2.265e9, 0.25)
SPREAD = ContactSpread(0.01, 0.2, -0.5, preload=40.0, hardness=5e7, friction=0.02)
NUMBERS = {"roughness": 1e-9, "material": IRON, "preload": 1e3}


def test_the_spread_of_a_case_is_gathered_from_surface_preload_and_conditions() -> None:
    """Each part knows its own standard deviation."""
    case = joint_case("ke_3d", dimension=2.5, spread=SPREAD, **NUMBERS)
    assert case.spread == SPREAD
    other = replace(case, preload=Preload(2e3, 7.0))
    assert other.spread == replace(SPREAD, preload=7.0)


def test_a_line_dimension_reaches_a_profile_model_to_the_last_digit() -> None:
    """20/17 is where a printed formula has no value; one digit off it has one."""
    case = joint_case("modified_2d", dimension=20 / 17, **NUMBERS)
    assert case.dimension == 20 / 17
    assert float(case.fractal.dimension) == 20 / 17


def test_a_case_without_damping_differs_in_nothing_else() -> None:
    """For intervals of a state that has no damping."""
    plate = DampingChoice(mass=10.0)
    case = joint_case("ke_3d", dimension=2.5, damping=plate, **NUMBERS)
    assert case.without_damping() == joint_case("ke_3d", dimension=2.5, **NUMBERS)


def test_a_negative_standard_deviation_is_refused_where_it_is_used() -> None:
    """The message names the input."""
    case = joint_case("ke_3d", dimension=2.5, **NUMBERS)
    with pytest.raises(UsageError, match=r"spread of preload is -1\.0"):
        _ = replace(case, preload=Preload(1e3, -1.0)).spread
