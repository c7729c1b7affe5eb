"""Torques that could be next, and what identified states say of the law."""

import json
from pathlib import Path

import numpy as np
from numpy.testing import assert_allclose

import jointbench as jb
from jointbench.analysis.structures.design.torque_exponents import (
    MeasuredLevels,
    fitted_exponents,
)
from jointbench.station.design.design_records import DesignRequest
from jointbench.station.design.run_design import designed_test
from jointbench.station.design.torque_next import torque_options


def test_options_are_allowed_torques_and_those_between() -> None:
    """Half and twice where none is allowed; a measured one is no option."""
    assert torque_options([40.0], []) == [20.0, 80.0]
    assert torque_options([40.0], [20.0, 40.2]) == [20.0, 28.3]
    assert torque_options([20.0, 80.0], []) == [10.0, 40.0, 160.0]


def test_exponents_are_a_line_through_levels_and_the_prior() -> None:
    """Exact levels of a power of 0.8; a level that is not known leaves the prior."""
    x = np.log([1.0, 2.0, 4.0])
    levels = MeasuredLevels(
        x,
        np.column_stack([0.8 * x + 3.0, 5.0 * x]),
        np.array([[1e-3, np.inf]] * 3),
    )
    found = fitted_exponents(levels, np.array([False, False]), 0.0)
    assert_allclose(found, [0.8, 2.0 / 3.0], rtol=1e-4)


def identified(path: Path) -> Path:
    """States of one day at 10 and 20 kN, as ``identify --json`` writes them."""
    kinds = ("normal", "tangential_1", "tangential_2")
    parameters = {}
    for load in (1.0, 2.0):
        for name, value in zip(kinds, (3e8, 1e8, 8e7), strict=True):
            for kind, level in (("stiffness", value), ("damping", 1e-5 * value)):
                parameters[f"day1@{load}e+04N:bed.{name}_{kind}"] = {
                    "value": level * load**0.5,
                    "sd": 0.01 * level,
                    "unit": "N/m",
                    "identifiable": True,
                    "interval_95": [None, None],
                }
    covariance = 1e-4 * np.eye(len(parameters))
    content = {"parameters": parameters, "log_covariance": covariance.tolist()}
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def test_a_third_torque_says_less_of_the_law_than_a_second(
    measured_block: Path, tmp_path: Path
) -> None:
    """Preloads in labels give torques; a third point halves the sd of a line."""
    values = identified(tmp_path / "joint.json")
    one = designed_test(measured_block, DesignRequest(measured=True))
    two = designed_test(
        measured_block, DesignRequest(values, "day1@1.0e+04N", measured=True)
    )
    assert (one.known_torques, two.known_torques) == (1, 2)
    assert [each.torque for each in one.torques] == [10.0, 40.0]
    assert [each.torque for each in two.torques] == [10.0, 28.3, 80.0]
    widths = [
        min(each.step.law_width for each in found.torques) for found in (one, two)
    ]
    # Errors of 0.3 %, departures of 2 %: a third point at twice the distance.
    assert widths[0] < 0.2
    assert_allclose(widths[1], 0.5, atol=0.03)


def test_no_torque_is_no_step(measured_block: Path) -> None:
    """Without the torque of the plan there is no law to place another one on."""
    text = measured_block.read_text(encoding="utf-8")
    measured_block.write_text(text.replace('torque = "20 N m"\n', ""), encoding="utf-8")
    found = designed_test(measured_block, DesignRequest(measured=True))
    assert found.torques == ()
    assert {one.kind for one in found.steps} == {"hit point", "sensor", "repeat"}


def test_the_library_gives_the_next_step_as_text(measured_block: Path) -> None:
    """The best step of each kind, and what the best torque says of the law."""
    found = jb.design(measured_block, measured=True, torques=[60.0])
    assert (found.sensors, found.hits) == (("a1",), ("1",))
    assert [one["torque"] for one in found.to_dict()["torques"]] == [34.6, 60.0]
    assert "60 N m says most of the law over the torque" in str(found)
