# SPDX-License-Identifier: MIT
"""Outcomes to which a base leads that explains the hits."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.gap.model.effect import Candidate, words_of
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_search.found_base import FoundBase
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
