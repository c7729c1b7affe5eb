"""Verdicts on a joint over its preload, and torques that are held out."""

from dataclasses import replace

import numpy as np
import pytest
from joint_campaigns import LAW, joint

from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
    UNDETERMINED,
    diagnose_contact,
)
from jointbench.analysis.gap.model.diagnosis_record import Finding


def test_nothing_missing_is_none() -> None:
    """A joint that follows its law within priors and scatter lacks nothing."""
    done = diagnose_contact(joint(seed=5), LAW)
    assert done.found.verdict is Finding.NONE
    assert done.before.share_inside > 0.85


def test_a_compliance_in_series_is_named_and_predicts_held_out_torques() -> None:
    """The size is within three sd, and the gap on held-out torques shrinks."""
    done = diagnose_contact(joint("series_compliance", 0.8, seed=6), LAW)
    found = done.found
    assert found.verdict is Finding.NAMED
    effect = found.effects[0]
    assert (effect.name, effect.site) == ("series_compliance", "link:joint")
    assert effect.confidence > 0.95
    assert found.gap_after.value < 0.5 * found.gap_before.value
    assert done.after.share_inside > 0.85 > done.before.share_inside


def test_without_its_effect_a_joint_is_unknown() -> None:
    """A joint whose stiffness falls with other torques than it rises, and no name."""
    data = joint("plastic_flattening", 0.5, seed=7)
    assert diagnose_contact(data, LAW).found.effects[0].name == "plastic_flattening"
    left = diagnose_contact(
        data, LAW, without=frozenset({"plastic_flattening", "falling_torque"})
    ).found
    assert left.verdict is Finding.UNKNOWN
    assert not left.effects


def test_two_levels_cannot_determine_anything() -> None:
    """The reason states how many levels are needed."""
    data = joint("series_compliance", 0.8, seed=8)
    few = np.isin(data.states.torque[data.rows.state], [5.0, 80.0])
    done = diagnose_contact(replace(data, rows=data.rows.chosen(few)), LAW)
    assert done.found.verdict is Finding.UNKNOWN
    assert done.found.reason.startswith(UNDETERMINED)
    assert "2 level(s)" in done.found.reason


@pytest.mark.parametrize("seed", [11, 12])
def test_the_cost_of_the_base_is_chi2_distributed(seed: int) -> None:
    """With priors on every parameter, the cost is near the number of values."""
    done = diagnose_contact(joint(seed=seed, assemblies=3), LAW)
    dof = done.bench.blocks.dof
    assert abs(done.base.cost - dof) < 4.0 * np.sqrt(2.0 * dof)
