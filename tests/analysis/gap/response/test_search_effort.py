# SPDX-License-Identifier: MIT
"""A search that is too long ends, says so, and gives the same answer anywhere."""

from dataclasses import replace

import gap_bench as made
import pytest

from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.response.search_effort import (
    SearchExhausted,
    counted,
    limited,
    spend,
)

TWO = [("delay", "channel:a1", [4e-5]), ("cross_talk", "channel:a0", [0.02])]


def test_time_integration_costs_more_than_a_linear_response() -> None:
    """Steps are counted too."""
    with counted() as effort:
        spend(100, 0)
        linear = effort.spent
        spend(100, 4)
    assert effort.spent - linear > 4 * linear


def test_what_is_spent_beyond_a_limit_ends_the_search() -> None:
    """Within the limit nothing happens, beyond it does, and without one never."""
    with counted() as effort:
        with limited(effort, 150.0):
            spend(100, 0)
            with pytest.raises(SearchExhausted):
                spend(100, 0)
        spend(10**9, 8)
    spend(10**9, 8)


def test_a_second_effect_that_may_not_be_looked_for_is_unknown() -> None:
    """Two faults are named; with no effort allowed for the second, none is."""
    campaign = made.made_campaign(TWO)
    found = diagnose(campaign, entries=LINEAR)
    assert found.verdict is Finding.NAMED
    assert {e.name for e in found.effects} == {"delay", "cross_talk"}
    policy = replace(STANDARD, most_samples=1.0)
    found = diagnose(campaign, entries=LINEAR, policy=policy)
    assert found.verdict is Finding.UNKNOWN
    assert "ended for its length" in found.reason
    assert found.effects == ()
