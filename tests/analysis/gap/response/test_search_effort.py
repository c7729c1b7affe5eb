# SPDX-License-Identifier: MIT
"""A search ends at its effort limit, reports it, and is reproducible."""

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

FEW = [
    entry
    for entry in LINEAR
    if entry.effect.name in {"delay", "cross_talk", "gain_error", "added_mass"}
]
TWO = [("delay", "channel:a1", [4e-5]), ("cross_talk", "channel:a0", [0.02])]


def test_time_integration_costs_more_than_a_linear_response() -> None:
    """Integration steps are counted."""
    with counted() as effort:
        spend(100, 0)
        linear = effort.spent
        spend(100, 4)
    assert effort.spent - linear > 4 * linear


def test_effort_beyond_the_limit_ends_the_search() -> None:
    """Below the limit or without one the search continues."""
    with counted() as effort:
        with limited(effort, 150.0):
            spend(100, 0)
            with pytest.raises(SearchExhausted):
                spend(100, 0)
        spend(10**9, 8)
    spend(10**9, 8)


def test_without_effort_for_a_second_effect_the_verdict_is_unknown() -> None:
    """Two faults are named; with no effort allowed for the second, none is."""
    campaign = made.made_campaign(TWO)
    found = diagnose(campaign, entries=FEW)
    assert found.verdict is Finding.NAMED
    assert {e.name for e in found.effects} == {"delay", "cross_talk"}
    policy = replace(STANDARD, most_samples=1.0)
    found = diagnose(campaign, entries=FEW, policy=policy)
    assert found.verdict is Finding.UNKNOWN
    assert "reached its effort limit" in found.reason
    assert found.effects == ()
