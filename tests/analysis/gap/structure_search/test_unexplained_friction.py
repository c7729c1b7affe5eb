# SPDX-License-Identifier: MIT
"""Friction that no law explains ends without fits that cannot help."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_search import whole_records
from jointbench.analysis.gap.structure_search.continued_laws import one_of_each_law
from jointbench.analysis.gap.structure_search.records_of_search import one_of_each
from jointbench.analysis.gap.structure_search.second_effects import that_take
from jointbench.analysis.gap.structure_search.short_windows import LONGER
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
    allowed_chi2,
)
from jointbench.analysis.gap.structure_search.structure_fits import met_at, settled
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    far_beyond_limit,
    in_whole_records,
)


def at_site(found: StructureOutcome, name: str, site: str) -> Candidate:
    """Return an effect at a site."""
    return next(
        c
        for c in found.bench.candidates
        if c.effect.name == name and str(c.site) == site
    )


def fit_of(found: StructureOutcome, cost: float, *candidates: Candidate) -> Fit:
    """Return a fit of effects with a cost."""
    return replace(found.outcome.base, candidates=candidates, cost=cost)


def test_a_second_effect_is_sought_beside_one_shape_of_a_law(
    found: StructureOutcome,
) -> None:
    """Micro-slip and macro-slip of the same bolts are one law with two shapes."""
    macro, micro, single, bolt = (
        fit_of(found, 1.0, at_site(found, name, site))
        for name, site in (
            ("macroslip", "bolts:all"),
            ("microslip", "bolts:all"),
            ("macroslip", "bolt:1"),
            ("loose_bolt", "bolt:1"),
        )
    )
    kept = one_of_each_law([macro, micro, single, bolt])
    assert [f.candidates for f in kept] == [f.candidates for f in (macro, single, bolt)]


def test_a_law_is_far_beyond_its_limit_by_what_it_leaves(
    found: StructureOutcome,
) -> None:
    """Linear effects, whose steps cost little, are fitted however far they are."""
    bench, base = found.bench, found.outcome.base
    law = at_site(found, "microslip", "bolts:all")
    bolt = at_site(found, "loose_bolt", "bolt:1")
    judged = accept_structure(bench, base, base)
    rms = np.sqrt(allowed_chi2(bench, base) / bench.coherence)
    near = np.full(base.residual.size, 1.1 * rms)
    for size, far in ((1.0, False), (1.2, True)):
        left = replace(base, residual=size * near, candidates=(law,))
        assert far_beyond_limit(JudgedFit(bench, left, judged)) is far
        linear = replace(left, candidates=(bolt,))
        assert not far_beyond_limit(JudgedFit(bench, linear, judged))


def test_such_a_law_is_judged_where_it_is(found: StructureOutcome) -> None:
    """Hits are met where they landed, and the chi2 is that of a fit from there."""
    bench = found.base_bench.at_rest()
    x = found.outcome.base.x
    whole, there = met_at(bench, x, ())
    assert np.array_equal(there.x, x)
    _, fitted = settled(bench, x, (), near=True)
    assert there.chi2 == pytest.approx(fitted.chi2, rel=0.05)
    assert not there.jacobian.size
    assert whole.landing == pytest.approx(bench.landing, abs=1e-4)


def test_a_pair_that_takes_nothing_is_not_carried_on(found: StructureOutcome) -> None:
    """A bolt as tight as the others leaves what the friction left."""
    law = at_site(found, "macroslip", "bolts:all")
    bolt = at_site(found, "loose_bolt", "bolt:1")
    single = fit_of(found, 100.0, law)
    idle, helpful = (fit_of(found, cost, law, bolt) for cost in (70.0, 20.0))
    assert that_take([helpful, idle], [single]) == [helpful]


def test_a_law_far_beyond_its_limit_is_not_fitted_to_all_records(
    found: StructureOutcome, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Micro-slip does not explain a channel that reads twice as much."""
    hits = found.base_bench.campaign.hits
    response = hits.response.copy()
    response[:, 1] *= 2.0
    bench = make_structure_bench(
        replace(found.base_bench.campaign, hits=replace(hits, response=response))
    )
    bench, base = settled(bench, np.zeros(bench.base_sd.size), (), near=True)
    few = bench.chosen(one_of_each(bench.campaign.hits))
    law = at_site(found, "microslip", "bolts:all")
    start = np.append(base.x, [0.1, 0.0, -1.0, 0.5, -0.1])
    fit = minimise(make_problem(few, (law,)), start, LONGER, iterations=1)

    def unwanted(*arguments: object, **options: object) -> None:
        pytest.fail("the law was fitted to all records")

    monkeypatch.setattr(whole_records, "settled", unwanted)
    (only,) = in_whole_records(bench, few, base, [fit], lambda line: None)
    assert only.fit.candidates == (law,)
    assert not only.acceptance.passed
    assert not only.fit.jacobian.size
    assert np.all(np.diag(only.fit.covariance) >= 0.0)
    assert len(only.bench.landing) == len(hits.names)
