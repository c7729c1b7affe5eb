# SPDX-License-Identifier: MIT
"""Further laws of real joints: forces, range, and their place beside simpler laws."""

from dataclasses import replace

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE, with_real_joints
from jointbench.analysis.gap.catalogue.effect_checks import fault_of
from jointbench.analysis.gap.catalogue.real_joint_effects import (
    IWAN_SEGALMAN,
    REAL_JOINTS,
)
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import Law, LumpedEffect
from jointbench.analysis.gap.response.law_loops import force_along
from jointbench.analysis.gap.second_method.verify import verify_response

TRAVEL = 1.8e-5  # [m], elongation of the joint under the hardest hit
STIFFNESS = made.NOMINAL["kj"]
VALUES = {
    "bouc_wen_free": [0.3 * STIFFNESS, TRAVEL, 1.0, 1.727],
    "iwan_segalman": [0.3 * STIFFNESS, 0.6 * TRAVEL, 1.5, 0.8],
    "clearance": [0.3 * STIFFNESS, 0.4 * TRAVEL, 0.5],
    "quadratic_cubic": [0.3 * STIFFNESS / TRAVEL**2, 0.4 * TRAVEL],
    "cubic_quintic": [0.3 * STIFFNESS / TRAVEL**2, 0.5 / TRAVEL**2],
    "power_damping": [40.0, 1.5],
}


@pytest.mark.parametrize(
    "entry", [e for e in REAL_JOINTS if e is not IWAN_SEGALMAN], ids=lambda e: e.name
)
def test_a_law_agrees_with_its_equation_in_continuous_time(entry: LumpedEffect) -> None:
    """Bound 3e-4 of the peak, as for laws with corners.

    The four-parameter Iwan element is tested by its closed forms below: 33 sharp
    sliders take an adaptive integrator minutes.
    """
    campaign = made.quiet_campaign(samples=288)
    rows = ("force", "response", "hit", "level", "preload", "order")
    one = replace(campaign, **{name: getattr(campaign, name)[[2]] for name in rows})
    bench, model = make_bench(one), campaign.model
    action = Action(entry, "link", 1, np.array(VALUES[entry.name]))
    apart = verify_response(
        model, model.nominal, bench.excitation, [action], tolerance=1e-8
    )
    assert apart.over_peak.max() < 3e-4


def test_a_preloaded_clearance_agrees_as_an_open_one() -> None:
    """Closed at rest the law is 0 until the joint opens."""
    entry = next(e for e in REAL_JOINTS if e.name == "clearance")
    r = np.array([0.0, 1.0, 2.0, 3.0, -1.0, -2.0, -3.0, -6.0]) * 1e-6
    closed = force_along(_law(entry, 1e6, 2e-6, 2.0), r)
    # Stops at 2 and 6 um: contact below 2 um, none between, contact above 6 um.
    assert closed == pytest.approx([0, 0, 0, -1.0, 0, 0, 0, 0], abs=1e-12)
    between = force_along(_law(entry, 1e6, 2e-6, 0.5), r)
    assert between == pytest.approx([0, 0, 0, 0, 0, -1.0, -2.0, -5.0], abs=1e-12)


def _law(entry: LumpedEffect, *values: float) -> Law:
    assert entry.law is not None
    return entry.law(np.array(values))


@pytest.mark.parametrize(("chi", "beta"), [(-0.5, 0.5), (-0.2, 5.0)])
@pytest.mark.parametrize("amplitude", [0.05, 0.3, 1.4])
def test_the_four_parameter_iwan_has_its_closed_forms(
    chi: float, beta: float, amplitude: float
) -> None:
    """Force within 0.1 % and dissipation within 1 % of Segalman's integrals."""
    law = _law(IWAN_SEGALMAN, 1.0, 1.0, chi + 2.0, beta)
    turn = np.linspace(0.0, 2.0 * np.pi, 801)
    r = amplitude * np.concatenate([np.linspace(0.0, 1.0, 200)[:-1], np.cos(turn)])
    force = (force_along(law, r) + r)[199:]
    density, a = (chi + 1.0) / (1.0 + beta), min(amplitude, 1.0)
    expected = density * a ** (chi + 2) / (chi + 2) + a * beta / (1 + beta)
    expected += amplitude * density * (1 - a ** (chi + 1)) / (chi + 1)
    lost = amplitude * a ** (chi + 2) / (chi + 2) - a ** (chi + 3) / (chi + 3)
    lost = 4 * density * lost + 4 * max(amplitude - 1, 0.0) * beta / (1 + beta)
    assert force[0] == pytest.approx(expected, rel=1e-3)
    assert _area(r[199:], force) == pytest.approx(lost, rel=1e-2)


def _area(r: FloatArray, force: FloatArray) -> float:
    return float(abs(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(r))))


@pytest.mark.parametrize("entry", REAL_JOINTS, ids=lambda e: e.name)
def test_a_further_law_has_no_fault_and_names_its_special_cases(
    entry: LumpedEffect,
) -> None:
    """Special cases are in the default catalogue, in the same family."""
    assert fault_of(entry) == ""
    families = {e.name: e.effect.family for e in CATALOGUE}
    for name in entry.effect.generalises:
        assert families[name] == entry.effect.family


def test_further_laws_join_a_catalogue_by_name_once() -> None:
    """All by one word; a wrong name is refused with near matches."""
    one = with_real_joints(CATALOGUE, ["clearance"])
    assert [e.name for e in one[len(CATALOGUE) :]] == ["clearance"]
    assert with_real_joints(one, ["real_joints"])[: len(one)] == one
    assert len(with_real_joints(one, ["real_joints"])) == len(CATALOGUE) + 6
    with pytest.raises(UsageError, match="did you mean clearance"):
        with_real_joints(CATALOGUE, ["clearence"])
