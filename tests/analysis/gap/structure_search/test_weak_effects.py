# SPDX-License-Identifier: MIT
"""Weak effects beside a base that explains the hits, with errors of bodies."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.body_errors import (
    responses_to_body_errors,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.added_to_bodies import with_added
from jointbench.analysis.gap.structure_response.closed_flexibility import (
    closed_flexibility,
)
from jointbench.analysis.gap.structure_response.table_errors import stiffness_errors
from jointbench.analysis.gap.structure_response.tuned_modes import TunedStiffness
from jointbench.analysis.gap.structure_search.fits_from_base import WINDOW
from jointbench.analysis.gap.structure_search.records_of_search import hardest
from jointbench.analysis.gap.structure_search.retuned_modes import retuned
from jointbench.analysis.gap.structure_search.sensors_from_base import sensors_from_base
from jointbench.analysis.gap.structure_search.slopes_again import with_slopes
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.weak_effects import (
    beyond_noise,
    completed,
    supported_fits,
    weak_effects,
    weighed_by_bodies,
)
from jointbench.analysis.gap.structure_search.weak_settings import WEAK
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit

GAIN = 0.04


def _silent(line: str) -> None:
    """Show no progress."""


def with_responses(bench: StructureBench, response: FloatArray) -> StructureBench:
    """Return a bench whose hits have other responses."""
    hits = replace(bench.campaign.hits, response=response)
    return replace(bench, campaign=replace(bench.campaign, hits=hits), kept={})


def body_rows(bench: StructureBench) -> FloatArray:
    """Return whole responses to errors of the bodies."""
    x = np.zeros(bench.base_sd.size)
    return responses_to_body_errors(bench.model(x, (), None), bench.landing)


@pytest.fixture(scope="module")
def drawn(uncertain: StructureBench) -> StructureBench:
    """Return hits on bodies that are off their table as bodies are."""
    rows = body_rows(uncertain)
    size = np.random.default_rng(513).normal(size=rows.shape[1])
    off = np.einsum("e,rect->rct", size, rows)
    return with_responses(uncertain, uncertain.campaign.hits.response + off)


def accepted(bench: StructureBench, fit: Fit) -> Acceptance:
    """Return an acceptance that passed."""
    return replace(accept_structure(bench, fit, fit), passed=True, reason="")


def base_of(bench: StructureBench) -> tuple[StructureBench, Fit]:
    """Return the base fitted to all records."""
    return settled(bench, np.zeros(bench.base_sd.size), (), near=True)


def test_responses_to_errors_of_bodies_are_derivatives(
    uncertain: StructureBench,
) -> None:
    """A thousandth of an error, added to the stiffness and solved exactly."""
    rows = body_rows(uncertain)
    campaign, share = uncertain.campaign, 1e-3
    x = np.zeros(uncertain.base_sd.size)
    model = uncertain.model(x, (), None)
    beside, diagonal = stiffness_errors(campaign, campaign.bodies)
    pairs = list(zip(*np.nonzero(np.triu(beside, 1)), strict=True))
    alone = np.flatnonzero(diagonal)
    chosen = [0, len(pairs) // 2, len(pairs), len(pairs) + alone.size - 1]
    for k in chosen:
        i, j = pairs[k] if k < len(pairs) else (alone[k - len(pairs)],) * 2
        between = np.zeros((2, 2))
        if i == j:
            between[0, 0] = share * np.sqrt(diagonal[i])
        else:
            between[0, 1] = between[1, 0] = share * np.sqrt(beside[i, j])
        unit = np.eye(campaign.bodies.omega.size)[[i, j]]
        added = TunedStiffness(unit, between, np.zeros((0, 2), int), np.zeros(0))
        one = model.closures[0]
        state = replace(model.state, tuned=added, attached=())
        flexibility = closed_flexibility(
            campaign.bodies, replace(model.state, attached=()), model.frame.s
        )
        assert flexibility is not None
        sensors = np.concatenate([state.sensors_of(campaign.bodies), unit])
        columns = np.concatenate([one.columns, unit])
        response = (sensors @ flexibility.modes.transpose(2, 0, 1)) @ columns.T
        moved = with_added(campaign.bodies, state, model.frame.s, response)
        changed = replace(model, closures=(replace(one, response=moved),))
        found = (changed.response() - model.response()) / share
        np.testing.assert_allclose(
            rows[:, k], found, rtol=0, atol=0.02 * np.abs(found).max()
        )


def test_residuals_whitened_together_are_those_of_each(drawn: StructureBench) -> None:
    """Of errors of bodies, sets of effects share the directions that are removed."""
    own = weighed_by_bodies(drawn, np.zeros(drawn.base_sd.size))
    assert own is not None
    names = ("gain_error", "delay", "added_mass")
    chosen = [
        next(c for c in own.candidates if c.effect.name == name) for name in names
    ]
    sets = [(Term(c, np.full(len(c.effect.parameters), 0.01)),) for c in chosen]
    base = np.full(own.base_sd.size, 1e-3)
    together = own.residuals(base, [(), *sets], WINDOW)
    for terms, row in zip([(), *sets], together, strict=True):
        alone = own.residual(base, terms, WINDOW)
        np.testing.assert_allclose(row, alone, rtol=0, atol=1e-9 * np.abs(alone).max())


def test_a_small_gain_is_found_beside_errors_of_bodies(drawn: StructureBench) -> None:
    """It is known better than beside errors of residues; without it, none is fitted."""
    whole, base = base_of(drawn)
    nothing = weak_effects(whole, base, _silent)
    assert nothing is not None
    assert nothing.complete
    assert not nothing.fits
    larger = drawn.campaign.hits.response.copy()
    larger[:, 1] *= 1.0 + GAIN
    whole, base = base_of(with_responses(drawn, larger))
    beside, *_ = sensors_from_base(whole, base, _silent)
    beside = with_slopes(beside.bench, beside.fit)
    weak = weak_effects(whole, base, _silent)
    assert weak is not None
    (best, *_) = weak.fits
    (candidate,) = best.fit.candidates
    assert candidate.label == f"gain_error@channel:{drawn.campaign.bodies.channels[1]}"
    sd = np.sqrt(best.fit.covariance[-1, -1])
    assert abs(best.fit.x[-1] - GAIN) < 3.0 * sd
    assert sd < 0.7 * np.sqrt(beside.covariance[-1, -1])


def test_a_name_is_supported_where_it_takes_what_the_base_leaves(
    drawn: StructureBench,
) -> None:
    """A gain of 30 % does; a delay of another channel does not."""
    larger = drawn.campaign.hits.response.copy()
    larger[:, 1] *= 1.3
    _, base = base_of(drawn)
    whole = with_responses(drawn, larger)
    weak = weak_effects(whole, base, _silent)
    assert weak is not None
    assert weak.left > WEAK.left
    true, other = (
        next(c for c in whole.candidates if c.label == f"{name}@channel:{channel}")
        for name, channel in (
            ("gain_error", whole.campaign.bodies.channels[1]),
            ("delay", whole.campaign.bodies.channels[0]),
        )
    )
    right = replace(base, candidates=(true,), x=np.append(base.x, 0.2))
    wrong = replace(base, candidates=(other,), x=np.append(base.x, 0.1))
    assert weak.supports(right)
    assert not weak.supports(wrong)
    refused = JudgedFit(whole, wrong, accepted(whole, base))
    assert supported_fits([refused], weak) == []
    assert supported_fits([refused], None) == [refused]


def test_an_effect_that_the_catalogue_lacks_is_suspected(drawn: StructureBench) -> None:
    """A gain of 10 % without gains in it: something else takes part of what is left."""
    larger = drawn.campaign.hits.response.copy()
    larger[:, 1] *= 1.1
    lacking = tuple(c for c in drawn.candidates if c.effect.name != "gain_error")
    _, base = base_of(drawn)
    whole = replace(with_responses(drawn, larger), candidates=lacking)
    weak = weak_effects(whole, base, _silent)
    assert weak is not None
    assert not weak.complete
    assert weak.fits or weak.suspected is not None
    whole, base = base_of(drawn)
    nothing = weak_effects(whole, base, _silent)
    assert nothing is not None
    assert nothing.suspected is None


def test_errors_that_no_body_has_leave_more(drawn: StructureBench) -> None:
    """A tenth of the response of one channel, at random times, is no such error."""
    whole, base = base_of(drawn)
    few, start = retuned(whole, base.x, (), every_pair=True)
    own = weighed_by_bodies(few, start)
    assert own is not None
    near = minimise(make_problem(own, ()), start, WINDOW, iterations=2)
    assert beyond_noise(own, near) < 1.0
    response = drawn.campaign.hits.response.copy()
    rng = np.random.default_rng(514)
    response[:, 1] *= 1.0 + 0.1 * rng.normal(size=response.shape[2])
    other = with_responses(own, response)
    near = minimise(make_problem(other, ()), start, WINDOW, iterations=2)
    assert beyond_noise(other, near) > 3.0


def test_all_close_pairs_have_a_coupling_where_it_is_asked_for(
    uncertain: StructureBench,
) -> None:
    """The base keeps its coordinates but for these."""
    x = 1e-3 * np.arange(uncertain.base_sd.size)
    more, moved = retuned(uncertain, x, (), every_pair=True)
    assert moved.size == more.base_sd.size == len(more.base_names)
    assert len(more.layout.units) == moved.size
    for name in uncertain.base_names:
        if not name.startswith(("frequency", "coupling")):
            at = uncertain.layout.at(name)
            assert moved[more.layout.at(name)] == x[at]


def test_a_linear_fit_is_completed_in_one_step() -> None:
    """Its cost is that of the minimum, its effect where that is."""
    rng = np.random.default_rng(516)
    slopes, centre = rng.normal(size=(40, 5)), np.zeros(5)
    prior = np.array([1.0, 2.0, 1.0, 0.0, 0.0])
    values = rng.normal(size=40)
    system = slopes.T @ slopes + np.diag(prior)
    least = np.linalg.solve(system, slopes.T @ values)
    x = least + 0.1 * rng.normal(size=5)

    def cost(at: FloatArray) -> float:
        left = slopes @ at - values
        return float(left @ left + prior @ at**2)

    left = slopes @ x - values
    fit = Fit(x, 3, (), left, slopes, cost(x), prior, centre)
    ended = completed(fit)
    np.testing.assert_allclose(ended.x[3:], least[3:])
    np.testing.assert_allclose(ended.x[:3], x[:3])
    np.testing.assert_allclose(ended.cost, cost(least))
    np.testing.assert_allclose(ended.residual, slopes @ least - values)


def test_the_hardest_hits_of_each_point(uncertain: StructureBench) -> None:
    """Two levels of each point, the highest ones."""
    hits = uncertain.campaign.hits
    chosen = hardest(hits, 2)
    for point in np.unique(hits.point):
        own = chosen[hits.point[chosen] == point]
        levels = np.unique(hits.level[hits.point == point])
        assert sorted(hits.level[own]) == list(levels[-2:])
