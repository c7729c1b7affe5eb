# SPDX-License-Identifier: MIT
"""Outcomes to which a base leads that explains the hits."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Candidate, words_of
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.fit_summary import fit_summary
from jointbench.analysis.gap.structure_search.found_base import FoundBase
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import UNTESTED
from jointbench.analysis.gap.structure_search.weak_effects import WeakEffects
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit


@pytest.fixture(scope="module")
def base(found: StructureOutcome) -> FoundBase:
    """Return the base of hits to which nothing is missing."""
    outcome = found.outcome
    return FoundBase(found.base_bench, outcome.base, outcome.acceptance, found.before)


def gain_of(base: FoundBase) -> Candidate:
    """Return a candidate of the bench."""
    return next(c for c in base.whole.candidates if c.effect.name == "gain_error")


def test_a_base_beside_which_no_effect_is_suspected_is_complete(base: FoundBase):
    weak = WeakEffects(base.whole, base.base.x, 10.0, 100.0, UNTESTED)
    for tests in (None, weak):
        assert base.nothing(UNTESTED, tests).outcome.acceptance.passed


def test_a_suspected_effect_is_named_in_a_verdict_of_unknown(base: FoundBase):
    gain = gain_of(base)
    weak = WeakEffects(base.whole, base.base.x, 10.0, 100.0, UNTESTED, suspected=gain)
    acceptance = base.nothing(UNTESTED, weak).outcome.acceptance
    assert not acceptance.passed and acceptance.unexplained
    assert words_of((gain,)) in acceptance.reason


def test_an_effect_that_other_tests_do_not_support_is_not_named(base: FoundBase):
    gain = gain_of(base)
    start = np.append(base.base.x, 0.05)
    fit = minimise(make_problem(base.whole, (gain,)), start, iterations=0)
    named = JudgedFit(base.whole, fit, replace(base.first, passed=True))
    outcome = base.doubtful(named, UNTESTED).outcome
    assert outcome.acceptance.unexplained and not outcome.best.candidates
    assert words_of((gain,)) in outcome.acceptance.reason


@pytest.fixture(scope="module")
def outstanding(uncertain: StructureBench) -> FoundBase:
    """Return a base that leaves far more in the second channel than in the others."""
    fit = minimise(make_problem(uncertain, ()), np.zeros(uncertain.base_sd.size))
    left = np.full(uncertain.blocks.shape, 0.1 / np.sqrt(uncertain.coherence))
    left[:, 1] *= 18.0
    fit = replace(fit, residual=left.ravel())
    first = accept_structure(uncertain, fit, fit)
    return FoundBase(uncertain, fit, first, fit_summary(uncertain, fit))


@pytest.mark.parametrize(
    ("left", "complete"), [(2.0, True), (20.0, True), (2.0, False)]
)
def test_a_channel_stands_out_unless_errors_of_bodies_explain_it(
    outstanding: FoundBase, left: float, complete: bool
) -> None:
    """Only where they leave little and no effect counts beside them."""
    whole, base = outstanding.whole, outstanding.base
    name = whole.campaign.bodies.channels[1]
    assert outstanding.first.reason.startswith(f"{name} leaves chi2/dof")
    weak = WeakEffects(whole, base.x, left, 100.0, UNTESTED, complete=complete)
    judged = outstanding.beside(weak).first
    assert judged.passed == (complete and left < 3.0)
    assert judged.reason == ("" if judged.passed else outstanding.first.reason)


def test_without_tests_of_weak_effects_a_base_keeps_its_acceptance(
    outstanding: FoundBase,
) -> None:
    assert outstanding.beside(None) is outstanding
