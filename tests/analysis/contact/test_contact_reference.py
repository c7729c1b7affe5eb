# SPDX-License-Identifier: MIT
"""Every row of an independent implementation's table of joint states."""

import json
from pathlib import Path

import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.predict import predict_contact

TABLE = Path(__file__).parents[4] / "shared" / "design" / "contact_reference.json"
ROWS = [
    (model, state)
    for model in (
        "mb_2d",
        "modified_2d",
        "friction_3d",
        "ke_2d",
        "ke_3d",
        "ke_3d_modified",
    )
    for state in "ABC"
]


@pytest.mark.parametrize(("model", "state"), ROWS)
def test_a_joint_state_equals_the_independent_implementation(model, state):
    """Areas, load and stiffness of each regime agree to 1e-9."""
    if not TABLE.exists():
        pytest.skip("the reference table is not beside this checkout")
    rows = {(row["model"], row["state"]): row for row in json.loads(TABLE.read_text())}
    row = rows[model, state]
    inputs = row["inputs"]
    found = predict_contact(
        joint_case(
            model,
            dimension=inputs["D"],
            roughness=inputs["G"],
            material=ContactMaterial(inputs["E"], inputs["H"], inputs["nu"]),
            preload=inputs["load"],
        )
    )
    areas = (found.critical_area, found.largest_area, found.real_area)
    wanted = (row["critical_area"], row["largest_area"], row["real_area"])
    assert_allclose(areas, wanted, rtol=1e-9)
    assert_allclose(found.normal_stiffness, row["stiffness"], rtol=1e-9)
    for regime, load in row["load_parts"].items():
        assert_allclose(found.load_parts[regime], load, rtol=1e-9)
        assert_allclose(
            found.stiffness_parts[regime], row["stiffness_parts"][regime], rtol=1e-9
        )
