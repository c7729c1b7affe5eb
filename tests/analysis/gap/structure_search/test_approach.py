# SPDX-License-Identifier: MIT
"""Records on which a base approaches all of them, and what it should reach there."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.approach import explaining_cost
from jointbench.analysis.gap.structure_search.records_of_search import (
    one_of_each,
    records_of_base,
    torques_in_turn,
)
from jointbench.analysis.gap.structure_search.structure_fits import chi2_per_dof
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome


def test_torques_take_turns_beside_an_uncertain_table(
    found: StructureOutcome, uncertain: StructureBench
) -> None:
    """Each hit of a point has the same error of such a table, at any torque."""
    exact, hits = found.base_bench, uncertain.campaign.hits
    assert np.array_equal(records_of_base(exact), one_of_each(exact.campaign.hits))
    turn = records_of_base(uncertain)
    assert np.array_equal(turn, torques_in_turn(hits))
    assert turn.size < one_of_each(hits).size
    assert set(hits.torque[turn]) == set(hits.torque)


def test_a_base_should_reach_the_limit_of_chi2(
    found: StructureOutcome, uncertain: StructureBench
) -> None:
    """Beside an exact table, it is fitted as far as a descent takes it."""
    assert explaining_cost(found.base_bench) is None
    cost = explaining_cost(uncertain)
    assert cost is not None
    rows = uncertain.blocks.dof
    at_limit = replace(found.outcome.base, residual=np.full(rows, np.sqrt(cost)))
    limit = uncertain.policy.floor_chi2
    assert chi2_per_dof(uncertain, at_limit) == pytest.approx(limit)
