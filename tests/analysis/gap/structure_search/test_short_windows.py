# SPDX-License-Identifier: MIT
"""Strong effects in short windows, beside a base that they have led far off."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.short_windows import (
    SHORT,
    carried,
)
from jointbench.analysis.gap.structure_search.short_windows import (
    tested as directed_tests,
)


def hidden(bench: StructureBench, label: str, values: dict[str, float]) -> Term:
    """Return a strong effect, in physical units over the scales of the bench."""
    candidate = next(c for c in bench.candidates if c.label == label)
    numbers = [
        p.encode(values[p.name] / (bench.scale(p.scale) if p.scale else 1.0))
        for p in candidate.effect.parameters
    ]
    return Term(candidate, np.array(numbers))


@pytest.mark.parametrize(
    ("label", "values"),
    [
        ("modulus@body:top", {"change": -0.45}),
        ("preload_stiffness@bolts:all", {"n": 0.65}),
        ("hidden_mode@point:P1", {"m": 0.05, "f": 800.0, "zeta": 0.02}),
        ("hidden_mode@point:P2", {"m": 0.05, "f": 900.0, "zeta": 0.02}),
    ],
)
def test_a_strong_effect_comes_first_in_the_longer_window(
    uncertain: StructureBench, label: str, values: dict[str, float]
) -> None:
    """Directed tests from a base far off mislead about it."""
    term, nominal = hidden(uncertain, label, values), np.zeros(uncertain.base_sd.size)
    response = uncertain.response(nominal, [term], None)
    hits = replace(uncertain.campaign.hits, response=response)
    campaign = replace(uncertain.campaign, hits=hits)
    few = replace(uncertain, campaign=campaign, kept={})
    few = few.at(nominal, (), few.landing, few.table_floor)
    near = minimise(make_problem(few, ()), nominal, SHORT, iterations=8)
    best = carried(few, near, directed_tests(few, near), lambda line: None)
    assert best[0].candidates == (term.candidate,)
