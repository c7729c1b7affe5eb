# SPDX-License-Identifier: MIT
"""A second effect is sought beside the best single one, and no further than needed."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import search_structure


def test_an_accepted_pair_ends_the_search(found: StructureOutcome) -> None:
    """A stiff spring at a point and a gain of 20 %, found beside the first of both."""
    bench = found.base_bench
    labels = "added_stiffness@point:P1 normal", "gain_error@channel:A1"
    spring, gain = (
        next(c for c in bench.candidates if c.label == label) for label in labels
    )
    hidden = (Term(spring, np.array([3.0])), Term(gain, np.array([0.2])))
    base = np.zeros(bench.base_sd.size)
    hits = replace(bench.campaign.hits, response=bench.response(base, hidden, None))
    lines: list[str] = []
    made = make_structure_bench(replace(bench.campaign, hits=hits))
    outcome = search_structure(made, lines.append).outcome
    assert {c.label for c in outcome.best.candidates} == set(labels)
    assert outcome.acceptance.passed
    sizes = {t.candidate.label: float(t.coordinates[0]) for t in outcome.best.terms}
    assert sizes[labels[0]] == pytest.approx(3.0, rel=0.02)
    assert sizes[labels[1]] == pytest.approx(0.2, rel=0.02)
    assert sum("directed tests beside" in line for line in lines) == 1
