"""The evidence of a gap locates and describes the true cause."""

import json
from dataclasses import replace
from functools import cache

import gap_outcomes as outcomes
import numpy as np
import pytest

from jointbench.analysis.gap.diagnosis.evidence import make_evidence
from jointbench.analysis.gap.diagnosis.findings import EVEN, ODD, symmetry
from jointbench.analysis.gap.diagnosis.level_evidence import (
    LevelScaling,
    is_linear,
    levels_of,
    recurrences,
    scaling_of,
)
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.evidence_records import (
    DirectedTest,
    GapEvidence,
    evidence_json,
)
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench

LATE = ("delay", "channel:a1", [4e-5])
CUBIC = ("cubic_stiffness", "link:joint", [3e15])
HEAVY = ("added_mass", "body:m2", [0.3])
PRELOADED = ("preload_stiffness", "link:joint", [0.01])
FOUND_DELAY = ("delay", "channel:a1")


@cache
def case(name: str) -> tuple[SearchOutcome, LumpedBench, GapEvidence]:
    """Return an outcome with its evidence."""
    hidden, tried = {
        "none": ([], ()),
        "delay": ([LATE], (FOUND_DELAY,)),
        "cubic": ([CUBIC], ()),
        "mass": ([HEAVY], ()),
        "preload": ([PRELOADED], ()),
    }[name]
    outcome, bench = outcomes.outcome_of(hidden, *tried, samples=1024)
    finding = Finding.NAMED if tried else Finding.UNKNOWN
    return outcome, bench, make_evidence(bench, outcome.base, outcome, finding)


def test_the_residual_of_a_linear_cause_recurs_fully_at_every_level() -> None:
    """A delayed channel: the same residual per force from 30 to 1000 N."""
    outcome, bench, _ = case("delay")
    difference = bench.campaign.response - bench.response(outcome.base.base, ())
    found = recurrences(bench, difference)
    assert {f.level for f in found} == {30.0, 300.0}
    assert all(f.share == pytest.approx(1.0, abs=0.1) for f in found)


def test_a_cubic_spring_does_not_recur_in_softer_hits() -> None:
    """Less than half of the residual at 1000 N recurs in softer hits."""
    outcome, bench, evidence = case("cubic")
    difference = bench.campaign.response - bench.response(outcome.base.base, ())
    found = recurrences(bench, difference)
    assert not is_linear(found)
    assert all(f.share < 0.5 for f in found)
    assert "with level" in evidence.where
    assert evidence.view == "level"


def test_a_base_bent_by_the_hardest_hits_makes_no_cause_linear() -> None:
    """As in the demo: heavier masses leave a residual in proportion to every hit.

    With that base the residual recurs by more than 80 %; with the base fitted to the
    softer hits it does not, although the law is the same.
    """
    outcome, bench, _ = case("cubic")
    bent = outcome.base.base + np.log(1.3) * np.ones(outcome.base.n_base)
    difference = bench.campaign.response - bench.response(bent, ())
    assert all(f.share > 0.8 for f in recurrences(bench, difference))
    found = levels_of(bench, replace(outcome.base, x=bent))
    assert scaling_of(found) is LevelScaling.CHANGES
    assert all(abs(f.share) < 0.2 for f in found)


def test_the_representative_record_of_a_cubic_spring_is_a_hardest_hit() -> None:
    """Its condition is stated as text."""
    _, bench, evidence = case("cubic")
    equal = 1.0 / bench.campaign.response[..., 0].size
    assert "1000 N" in evidence.curves.condition
    assert evidence.curves.share > 2.5 * equal


def test_a_fault_of_one_channel_is_located_on_it() -> None:
    """A delay of a1 is not located on a0, although the base changes a0 as well."""
    evidence = case("delay")[2]
    assert "a1" in evidence.where
    assert evidence.curves.channel == "a1"


def test_a_complete_model_has_no_sentences() -> None:
    """No sentence, and a residual equal to the noise within 10 %."""
    evidence = case("none")[2]
    assert (evidence.where, evidence.look, evidence.advice) == ("", (), "")
    curves = evidence.curves
    assert np.std(curves.residual_before) == pytest.approx(curves.sigma, rel=0.1)
    assert np.array_equal(curves.residual_before, curves.residual_after)


def test_the_right_effect_leaves_noise_in_the_representative_record() -> None:
    """Before: many times the noise; after: the noise within 15 %."""
    curves = case("delay")[2].curves
    assert np.std(curves.residual_before) > 5 * curves.sigma
    assert np.std(curves.residual_after) == pytest.approx(curves.sigma, rel=0.15)


def test_the_residual_spectrum_is_one_where_only_noise_is_left() -> None:
    """Over bands of many lines, within 5 %."""
    spectra = case("none")[2].spectra
    high = spectra.frequency > 500.0
    assert np.mean(spectra.residual_before[high] ** 2) == pytest.approx(1.0, rel=0.05)


def test_the_response_function_of_a_right_model_is_the_measured_one() -> None:
    """At the peak, where the noise is smallest, within 1 %."""
    spectra = case("none")[2].spectra
    peak = int(np.nanargmax(spectra.measured))
    assert spectra.before[peak] == pytest.approx(spectra.measured[peak], rel=0.01)


def test_record_estimates_follow_the_stiffness_of_the_preload() -> None:
    """Stiffness ~ preload^0.01: 1 % of ln 2 more at twice the preload."""
    record_estimates = case("preload")[2].record_estimates
    assert record_estimates is not None
    like = (record_estimates.level == 300.0) & (np.array(record_estimates.hit) == "m2")
    first = record_estimates.stiffness[:, 0]
    twice = float(first[like & (record_estimates.preload == 8000.0)].mean())
    once = float(first[like & (record_estimates.preload == 4000.0)].mean())
    assert twice - once == pytest.approx(0.01 * np.log(2), rel=0.1)
    assert record_estimates.share > 0.8


def test_a_mass_that_the_base_absorbs_is_recognised_by_its_prior() -> None:
    """The records are explained, with m2 many sd off: no sentence about levels."""
    evidence = case("mass")[2]
    assert "m2 +" in evidence.where
    assert evidence.view == "priors"


def test_the_limits_are_those_of_the_acceptance_criteria() -> None:
    """No directed test of a complete base exceeds the limit shown with it."""
    outcome, _, evidence = case("none")
    assert outcome.acceptance.passed
    assert evidence.limits.chi2_per_dof < evidence.limits.chi2_allowed
    assert evidence.limits.remaining is not None
    assert 0.0 < evidence.limits.remaining < evidence.limits.remaining_allowed
    threshold = outcome.base_screening.threshold
    assert evidence.limits.remaining_allowed == pytest.approx(1.3 * threshold)


def test_a_fit_without_directed_tests_shows_no_limit_of_them() -> None:
    """This outcome has no directed tests of its best fit."""
    outcome, _, evidence = case("delay")
    assert outcome.acceptance.left is None
    assert evidence.limits.remaining is None


@pytest.mark.parametrize("known", [{ODD}, {EVEN}, {ODD, EVEN}])
def test_symmetry_is_reported_only_where_both_laws_were_tested(known: set[str]) -> None:
    """An effect outside the catalogue is not reported as 0 %."""
    shares = {ODD: 0.9, EVEN: 0.2}
    tests = [DirectedTest(f"{n}@link:joint", 10.0, shares[n]) for n in sorted(known)]
    line = symmetry(tests)
    assert bool(line) == (len(known) == 2)
    assert "0 %:" not in line or "20 %:" in line


def test_the_directed_tests_put_the_truth_first() -> None:
    """A delay of a1 explains nearly the whole residual to first order."""
    first = case("delay")[2].tests[0]
    assert first.label == "delay@channel:a1"
    assert 0.9 < first.share <= 1.0


def test_the_json_of_the_evidence_holds_words_and_no_samples() -> None:
    """It stays below 8 kB."""
    text = json.dumps(evidence_json(case("delay")[2]))
    assert "delay@channel:a1" in text
    assert len(text) < 8000


def test_a_shaken_bench_without_hits_has_evidence_too() -> None:
    """Without hits and levels, no sentence mentions them."""
    outcome, bench = outcomes.outcome_of([LATE], continuous=True)
    evidence = make_evidence(bench, outcome.base, outcome, Finding.UNKNOWN)
    assert "a1" in evidence.where
    assert evidence.where.startswith("the residual is ")
    assert not any("level" in line or "hit" in line for line in evidence.look)
    assert "hit" not in evidence.curves.condition
    assert not any(line.startswith("time:") for line in evidence.look)
    assert evidence.curves.time.size > 100
