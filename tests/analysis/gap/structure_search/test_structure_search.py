"""The search on bolted bodies: what is fitted to whole records, and what is named."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hit_campaigns import Hidden, write_campaign

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.judgement.amplitudes import weakest_amplitude
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FULL,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import Descent, descend, minimise
from jointbench.analysis.gap.search.screening import Direction, Screening
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.landing import mark_missed
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_search.base_fits import with_errors_found
from jointbench.analysis.gap.structure_search.continued_laws import with_continued
from jointbench.analysis.gap.structure_search.records_of_search import (
    one_of_each,
    torques_in_turn,
)
from jointbench.analysis.gap.structure_search.second_effects import (
    affordable,
    alone,
    leaves_much,
)
from jointbench.analysis.gap.structure_search.short_windows import SHORT, carried
from jointbench.analysis.gap.structure_search.sought_frequencies import (
    from_other_frequencies,
    sought,
)
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_diagnosis import (
    diagnose_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    in_windows,
    settled,
)
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import (
    UNTESTED,
    needless,
    one_effect_takes_much,
    takes,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    worth_it,
)
from jointbench.station.schemas.nominal_bench_file import read_nominal


def with_mass(found: StructureOutcome, mass: float) -> JudgedFit:
    """Return the base of an outcome with a mass at the first place, not fitted."""
    heavy = next(c for c in found.bench.candidates if c.effect.name == "added_mass")
    problem = make_problem(found.bench, (heavy,))
    fit = minimise(problem, np.append(found.outcome.base.x, mass), iterations=0)
    return JudgedFit(found.bench, fit, accept_structure(found.bench, fit, fit))


def test_an_effect_that_is_nearly_off_is_not_named(found: StructureOutcome) -> None:
    """The base does as well without a mass of a billionth, so nothing is missing."""
    after = needless(with_mass(found, 1e-9), UNTESTED)
    assert after is not None
    assert after.outcome.acceptance.passed
    assert after.outcome.best.candidates == ()


def test_an_effect_that_is_far_from_off_goes_on_to_its_judge(
    found: StructureOutcome,
) -> None:
    """A mass of a tenth of the structure is many sd from zero."""
    assert needless(with_mass(found, 0.1), UNTESTED) is None


def test_a_mark_that_all_hits_missed_is_not_explained(tmp_path: Path) -> None:
    """Aim and tilt of each hit follow the records, so chi2 shows nothing of it."""
    path, nominal = write_campaign(tmp_path, Hidden(mark=(8e-3, 0.0)))
    bench = make_structure_bench(read_hit_campaign(path, *read_nominal(nominal)))
    bench, base = based(bench)
    judged = accept_structure(bench, base, base)
    assert judged.excess < judged.allowed
    assert re.fullmatch(r"hits at P1 landed [78]\.\d mm beside .*", judged.reason)
    assert not judged.passed


def test_one_hit_may_miss_by_more_than_a_dozen(found: StructureOutcome) -> None:
    """A mean of few hits scatters more than one of many."""
    campaign = found.bench.campaign
    own = np.flatnonzero(campaign.hits.point == 0)
    landing = np.zeros((campaign.hits.point.size, 4))
    landing[own, 2] = 4 * campaign.nominal.aim_sd
    assert "P1" in mark_missed(campaign, landing, 3.0, 5.0)
    assert not mark_missed(campaign, landing, 3.0, 4.1 * np.sqrt(own.size))


def test_one_effect_may_take_much_of_what_an_accepted_base_leaves(
    tmp_path: Path,
) -> None:
    """The limit of chi2 is wide; a gain of 0.4 % stays below it and is no error."""
    path, nominal = write_campaign(tmp_path, Hidden())
    campaign = read_hit_campaign(path, *read_nominal(nominal))
    complete = make_structure_bench(campaign)
    assert not one_effect_takes_much(*based(complete))
    response = campaign.hits.response.copy()
    response[:, 1] *= 1.004
    hits = replace(campaign.hits, response=response)
    bench, base = based(make_structure_bench(replace(campaign, hits=hits)))
    assert accept_structure(bench, base, base).passed
    assert one_effect_takes_much(bench, base)
    assert takes(bench, replace(base, residual=0.8 * base.residual), base)
    assert not takes(bench, replace(base, residual=0.95 * base.residual), base)


def test_the_gap_of_an_uncertain_table_is_in_units_of_its_floor(
    tmp_path: Path,
) -> None:
    """Records count as few numbers in fits, which hid any gap that was held out."""
    path, nominal = write_campaign(tmp_path, Hidden())
    campaign = read_hit_campaign(path, *read_nominal(nominal))
    response = campaign.hits.response.copy()
    response[:, 1] *= 1.5
    campaign = replace(
        campaign,
        hits=replace(campaign.hits, response=response),
        nominal=replace(campaign.nominal, table_sd=(0.005, 0.02)),
    )
    found = diagnose_structure(campaign).found
    assert [e.name for e in found.effects] == ["gain_error"]
    assert found.gap_before.value > 1.0
    assert found.gap_after.value < 0.1 * found.gap_before.value
    levels = next(v for v in found.gap_before.views if v.name == "level")
    assert np.mean(list(levels.chi2_per_dof.values())) > 1.0
    assert found.acceptable_deviation == STANDARD.floor_prior_limit


def based(bench: StructureBench) -> tuple[StructureBench, Fit]:
    """Return the base, fitted to all whole records."""
    return settled(bench, np.zeros(bench.base_sd.size), (), near=True)


def test_a_pair_whose_second_effect_is_nearly_off_is_a_single_one(
    found: StructureOutcome,
) -> None:
    """It was a further start for the first one."""
    mass, bolt = candidate(found, "added_mass"), candidate(found, "loose_bolt")
    problem = make_problem(found.bench, (mass, bolt))
    start = np.append(found.outcome.base.x, [1e-9, 1e-6])
    fit = minimise(problem, start, iterations=0)
    judged = JudgedFit(found.bench, fit, accept_structure(found.bench, fit, fit))
    one = alone(found.bench, found.outcome.base, judged)
    assert one is not None
    assert len(one.fit.candidates) == 1
    refused = replace(judged, acceptance=replace(judged.acceptance, passed=False))
    assert alone(found.bench, found.outcome.base, refused) is None


def test_a_law_refused_for_the_base_alone_is_not_paired(
    found: StructureOutcome,
) -> None:
    """What chi2 allows leaves nothing to a second effect beside a law."""
    passed = found.outcome.acceptance
    refused = replace(passed, passed=False)
    far = replace(refused, excess=passed.allowed + 1.0)
    micro = costly(found, 1.0, candidate(found, "microslip"))
    bolt = costly(found, 1.0, candidate(found, "loose_bolt"))
    assert leaves_much(JudgedFit(found.bench, micro, far))
    assert not leaves_much(JudgedFit(found.bench, micro, refused))
    assert leaves_much(JudgedFit(found.bench, bolt, refused))
    assert not leaves_much(JudgedFit(found.bench, bolt, passed))


def test_friction_leaves_masses_as_weighed(found: StructureOutcome) -> None:
    """Narrow priors count as often as samples show one error, until stated."""
    few = found.bench.chosen(one_of_each(found.bench.campaign.hits))
    micro = candidate(found, "microslip")
    x = np.append(np.zeros(few.base_sd.size), [0.3, 0.0, -1.0, 0.5, -0.1])
    masses = [k for k, sd in enumerate(few.base_sd) if sd < STRUCTURE_SEARCH.weighed_sd]
    assert masses
    x[masses] = 2.0 * few.base_sd[masses]
    plain = minimise(make_problem(few, (micro,)), x, SHORT, iterations=0)
    _, held = in_windows(few, x, (micro,))
    assert np.abs(held.prior_deviations[masses]).max() < 0.5
    assert np.array_equal(held.prior, plain.prior)


def test_effects_at_the_place_of_the_leader_are_tried(found: StructureOutcome) -> None:
    """A cable resonance looks like a gain in directed tests."""
    gain = candidate(found, "gain_error", 1)
    direction = Direction(
        candidate=gain,
        coordinates=np.array([0.1]),
        shift=np.zeros(found.outcome.base.x.size),
        drop=1.0,
        one_sided=False,
        suggested=False,
        amplitude=0.1,
        amplitude_sd=0.01,
    )
    few = found.bench.chosen(one_of_each(found.bench.campaign.hits))
    near = minimise(make_problem(few, ()), found.outcome.base.x, SHORT, iterations=0)
    lines: list[str] = []
    carried(few, near, Screening((direction,), 0.0, 1.0), lines.append)
    short = {line.split(" ")[0] for line in lines if "short" in line}
    assert {f"gain_error@{gain.site}", f"cable_resonance@{gain.site}"} <= short
    assert f"cable_resonance@{candidate(found, 'gain_error', 0).site}" not in short


def candidate(found: StructureOutcome, name: str, number: int = 0) -> Candidate:
    """Return an effect at one of its sites."""
    every = [c for c in found.bench.candidates if c.effect.name == name]
    return every[number]


def costly(found: StructureOutcome, cost: float, *candidates: Candidate) -> Fit:
    """Return a fit of effects with a cost."""
    return replace(found.outcome.base, candidates=candidates, cost=cost)


def test_a_stiff_spring_is_tried_where_no_directed_test_leads(
    found: StructureOutcome,
) -> None:
    """Five bolts at one point: along its directed test a fit ends at a soft spring."""
    bench = found.base_bench
    spring = next(
        c for c in bench.candidates if c.label == "added_stiffness@point:P1 normal"
    )
    held = (Term(spring, np.array([5.6])),)
    response = bench.response(found.outcome.base.base, held, None)
    hits = replace(bench.campaign.hits, response=response)
    bench = make_structure_bench(replace(bench.campaign, hits=hits))
    few = bench.chosen(one_of_each(hits))
    base = np.zeros(few.base_sd.size)
    few = few.at(base, (), few.landing, few.table_floor)
    near = minimise(make_problem(few, ()), base, SHORT, iterations=8)
    fits = carried(few, near, UNTESTED, lambda line: None)
    assert fits[0].candidates == (spring,)
    assert fits[0].x[-1] == pytest.approx(5.6, rel=1e-2)


def test_every_law_of_the_leading_family_is_fitted_to_whole_records(
    found: StructureOutcome,
) -> None:
    """In short windows macro-slip seemed ten times worse than micro-slip."""
    micro = costly(found, 1.0, candidate(found, "microslip"))
    macro = costly(found, 10.0, candidate(found, "macroslip", 1))
    further = costly(found, 11.0, candidate(found, "macroslip", 2))
    bolt = costly(found, 10.0, candidate(found, "loose_bolt"))
    worth = worth_it(found.bench, [micro, macro, bolt, further])
    assert [fit.candidates for fit in worth] == [micro.candidates, macro.candidates]
    near = replace(bolt, cost=1.0)
    assert worth_it(found.bench, [near, macro, further]) == [near]


def test_friction_continues_where_its_shape_ends(found: StructureOutcome) -> None:
    """Both are one law: a fit at the end of its shape continues as the other."""
    few = found.bench.chosen(one_of_each(found.bench.campaign.hits))
    micro = candidate(found, "microslip")
    macro = next(
        c
        for c in found.bench.candidates
        if c.effect.name == "macroslip" and c.site == micro.site
    )
    end = macro.effect.parameters[2].bounds[1]
    base = np.zeros(few.base_sd.size)
    start = np.append(base, [0.3, -2.0, end, 0.5, -0.1, 0.1])
    bound = minimise(make_problem(few, (macro,)), start, SHORT, iterations=0)
    (beyond,) = with_continued(few, [bound], SHORT, 2)
    assert beyond.candidates == (micro,)
    assert beyond.cost < bound.cost
    start[-4] -= 1.0
    inside = minimise(make_problem(few, (macro,)), start, SHORT, iterations=0)
    assert with_continued(few, [inside], SHORT, 2) == [inside]


def test_one_pair_with_a_law_is_fitted_to_whole_records(
    found: StructureOutcome,
) -> None:
    """Each step of such a fit integrates the law for every coordinate."""
    bolt, mass = candidate(found, "loose_bolt"), candidate(found, "added_mass")
    laws = [
        costly(found, 1.0 + k, bolt, candidate(found, "macroslip", k)) for k in (0, 1)
    ]
    linear = costly(found, 3.0, bolt, mass)
    kept = affordable(found.bench, [*laws, linear])
    assert [fit.candidates for fit in kept] == [laws[0].candidates, linear.candidates]
    micro = candidate(found, "microslip")
    assert not found.bench.may_add(micro, (candidate(found, "macroslip"),))
    assert found.bench.may_add(micro, (bolt,))


def test_torques_in_turn_meet_every_point_and_level(found: StructureOutcome) -> None:
    """A third of the records, or half of them, shows every torque at each level."""
    hits = found.bench.campaign.hits
    few, every = torques_in_turn(hits), one_of_each(hits)
    points = {(hits.point[k], hits.level[k]) for k in every}
    assert {(hits.point[k], hits.level[k]) for k in few} == points
    assert len(few) == len(points) < len(every)
    assert set(hits.torque[few]) == set(hits.torque)


def test_a_frequency_that_a_descent_cannot_reach_is_found(
    uncertain: StructureBench,
) -> None:
    """A mode 3 % off its table, half a cycle and more in 20 ms, is sought and found."""
    tuned, window = uncertain.layout.tuned, Resolution(0.02)
    assert tuned is not None
    inside = 2.0 * np.pi * uncertain.campaign.hits.band
    k = int(np.flatnonzero(tuned.omega < inside)[-1])
    at, x = uncertain.layout.at(tuned.names[k]), np.zeros(uncertain.base_sd.size)
    off = x.copy()
    off[at] = 0.03
    hits = replace(uncertain.campaign.hits, response=uncertain.response(off, (), None))
    made = replace(uncertain, campaign=replace(uncertain.campaign, hits=hits), kept={})
    lost, there = (
        minimise(make_problem(made, ()), start, window, iterations=0)
        for start in (x, off)
    )
    back = sought(made, lost)
    assert back is not None
    step = 2.0 * np.pi * STRUCTURE_SEARCH.sought_turn / 0.02 / tuned.omega[k]
    assert abs(back[at] - 0.03) < step
    assert sought(made, there) is None


def test_frequencies_are_as_uncertain_as_a_base_that_explains_shows(
    uncertain: StructureBench,
) -> None:
    """One far off counts only where nothing but the table can have done it."""
    tuned = uncertain.layout.tuned
    assert tuned is not None
    own = [uncertain.layout.at(name) for name in tuned.names[: tuned.omega.size]]
    free = [k for k in own if uncertain.base_sd[k] > MODAL_TABLE.open_frequency]
    x = np.zeros(uncertain.base_sd.size)
    x[free] = 0.1 * uncertain.base_sd[free]
    x[free[-1]] = 5.0 * uncertain.base_sd[free[-1]]
    fit = minimise(make_problem(uncertain, ()), x, SHORT, iterations=0)
    left, raised = (
        with_errors_found(uncertain.layout, fit, explains=one).sd / uncertain.base_sd
        for one in (False, True)
    )
    np.testing.assert_allclose(left, 1.0)
    rms = np.sqrt((25.0 + 0.01 * (len(free) - 1)) / len(free))
    np.testing.assert_allclose(raised[own], min(rms, MODAL_TABLE.largest_size))


def test_with_an_uncertain_table_the_base_is_fitted_from_any_effect(
    uncertain: StructureBench,
) -> None:
    """A mass of many sd is not named where the base explains the hits from there."""
    heavy = next(c for c in uncertain.candidates if c.effect.name == "added_mass")
    start = np.append(np.zeros(uncertain.base_sd.size), 0.1)
    fit = minimise(make_problem(uncertain, (heavy,)), start, iterations=0)
    assert weakest_amplitude(fit) > STRUCTURE_SEARCH.plain_amplitude
    best = JudgedFit(uncertain, fit, accept_structure(uncertain, fit, fit))
    after = needless(best, UNTESTED)
    assert after is not None
    assert after.outcome.acceptance.passed
    assert after.outcome.best.candidates == ()
    bare = minimise(make_problem(uncertain, ()), fit.base, FULL, iterations=0)
    assert needless(best, UNTESTED, 0.09 * bare.cost) is None
    assert needless(best, UNTESTED, far_off=True) is None


def test_a_fit_far_off_ends_by_what_its_samples_count_as(
    uncertain: StructureBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Answers a third too large: over its samples there is no excess, so it creeps."""
    hits = uncertain.campaign.hits
    stronger = replace(hits, response=1.3 * hits.response)
    campaign = replace(uncertain.campaign, hits=stronger)
    problem = make_problem(replace(uncertain, campaign=campaign, kept={}), ())
    looks: list[Resolution] = []
    plain = StructureBench.residual

    def counted(
        own: StructureBench,
        base: FloatArray,
        terms: Sequence[Term],
        resolution: Resolution,
    ) -> FloatArray:
        looks.append(resolution)
        return plain(own, base, terms, resolution)

    monkeypatch.setattr(StructureBench, "residual", counted)
    start, cost, count = np.zeros(uncertain.base_sd.size), [], []
    samples = uncertain.blocks.dof
    for dof in (None, samples / uncertain.coherence):
        looks.clear()
        how = Descent(SHORT, iterations=20, exact_slopes=False, dof=dof)
        cost.append(descend(problem, start, how).cost)
        count.append(len(looks))
    assert count[1] < count[0]
    assert cost[0] <= cost[1] < 1.01 * cost[0]


def test_a_fit_of_an_effect_seeks_the_frequency_it_has_lost(
    uncertain: StructureBench,
) -> None:
    """A channel reads 30 % more and a mode is 3 % off its table: both are found."""
    tuned = uncertain.layout.tuned
    assert tuned is not None
    k = int(np.searchsorted(tuned.omega, 2.0 * np.pi * 650.0))
    at, off = uncertain.layout.at(tuned.names[k]), np.zeros(uncertain.base_sd.size)
    off[at] = 0.03
    gain = next(c for c in uncertain.candidates if c.effect.name == "gain_error")
    response = uncertain.response(off, (Term(gain, np.array([0.3])),), None)
    hits = replace(uncertain.campaign.hits, response=response)
    nominal = replace(uncertain.campaign.nominal, table_sd=(0.02, 0.02))
    campaign = replace(uncertain.campaign, hits=hits, nominal=nominal)
    made = replace(make_structure_bench(campaign), reach=STRUCTURE_SEARCH.final_reach)
    start = np.concatenate([np.zeros(off.size), [0.3]])
    made = made.at(start[:-1], (), made.landing, made.table_floor)
    lost = minimise(make_problem(made, (gain,)), start, FULL, iterations=0)
    found = from_other_frequencies(made, lost)
    assert found is not None
    _, fit = found
    assert abs(fit.x[at] - 0.03) < 0.006
    assert abs(fit.x[-1] - 0.3) < 0.01
    assert fit.cost < 0.1 * lost.cost
