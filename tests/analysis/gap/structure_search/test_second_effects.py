# SPDX-License-Identifier: MIT
"""A second effect is sought beside the best single one, and no further than needed."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.records_of_search import one_of_each
from jointbench.analysis.gap.structure_search.second_effects import (
    leaves_much,
    second_effects,
)
from jointbench.analysis.gap.structure_search.short_windows import LONGER
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import search_structure
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit


def struck(
    found: StructureOutcome, hidden: dict[str, list[float]]
) -> tuple[StructureBench, list[Term]]:
    """Return the bench where effects are hidden, and these."""
    bench = found.base_bench
    known = {c.label: c for c in bench.candidates}
    terms = [Term(known[label], np.array(x)) for label, x in hidden.items()]
    base = np.zeros(bench.base_sd.size)
    hits = replace(bench.campaign.hits, response=bench.response(base, terms, None))
    return make_structure_bench(replace(bench.campaign, hits=hits)), terms


def test_a_second_effect_is_sought_beside_the_two_best(
    found: StructureOutcome,
) -> None:
    """A stiff spring at a point and a gain of 20 %: rivals of a pair count as well."""
    hidden = {"added_stiffness@point:P1 normal": [3.0], "gain_error@channel:A1": [0.2]}
    lines: list[str] = []
    outcome = search_structure(struck(found, hidden)[0], lines.append).outcome
    assert outcome.acceptance.passed
    sizes = {t.candidate.label: t.coordinates.tolist() for t in outcome.best.terms}
    assert sizes.keys() == hidden.keys()
    for label, size in hidden.items():
        assert sizes[label] == pytest.approx(size, rel=0.02)
    assert sum("directed tests beside" in line for line in lines) == 2


def test_an_accepted_pair_with_a_law_ends_the_search(found: StructureOutcome) -> None:
    """Each test beside a law integrates it."""
    hidden = {"gain_error@channel:A1": [1.0], "quadratic@bolt:0": [1.5]}
    bench, terms = struck(found, hidden)
    bench, base = settled(bench, np.zeros(bench.base_sd.size), (), near=True)
    few = bench.chosen(one_of_each(bench.campaign.hits))
    singles = [
        minimise(
            make_problem(few, (term.candidate,)),
            np.append(np.zeros(few.base_sd.size), term.coordinates),
            LONGER,
            iterations=2,
        )
        for term in terms
    ]
    lines: list[str] = []
    left = JudgedFit(bench, base, accept_structure(bench, base, base))
    best, *_ = second_effects(bench, few, base, singles, left, lines.append)
    assert {c.label for c in best.fit.candidates} == set(hidden)
    beside = [line for line in lines if "directed tests beside" in line]
    assert beside == ["directed tests beside gain_error@channel:A1"]


@pytest.mark.parametrize(
    ("excess", "sought"), [(-0.5, False), (0.2, False), (2.0, True)]
)
def test_an_accepted_effect_that_leaves_more_than_the_base_may_is_searched_beside(
    found: StructureOutcome, excess: float, sought: bool
) -> None:
    """A strong effect has a wide limit, into which a weak one fits."""
    bench, base = found.base_bench, found.outcome.base
    accepted = replace(
        found.outcome.acceptance, passed=True, excess=excess, allowed=5.0
    )
    assert leaves_much(JudgedFit(bench, base, accepted)) is sought
