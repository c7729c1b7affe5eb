"""What no modal table imitates, sought beside a base that explains the hits."""

from dataclasses import replace

import numpy as np

from jointbench.analysis.gap.model.effect import Candidate, Site, Term
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.sensor_effects import SENSOR_EFFECTS
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.differences_from_base import (
    differences_from_base,
    differs,
    takes_differences,
)
from jointbench.analysis.gap.structure_search.sensors_from_base import (
    of_table,
    sensors_from_base,
    within_tolerance,
)
from jointbench.analysis.gap.structure_search.short_windows import SHORT
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.structure_search import takes


def test_a_gain_is_found_beside_a_base_that_explains_the_hits(
    uncertain: StructureBench,
) -> None:
    """One channel that reads 15 % more; nothing is fitted where none does."""
    _, base = settled(uncertain, np.zeros(uncertain.base_sd.size), (), near=True)
    assert sensors_from_base(uncertain, base, lambda line: None) == []
    hits = uncertain.campaign.hits
    larger = hits.response.copy()
    larger[:, 2] *= 1.15
    campaign = replace(uncertain.campaign, hits=replace(hits, response=larger))
    faulty = replace(uncertain, campaign=campaign, kept={})
    bench, base = settled(faulty, base.base, (), near=True)
    best, *_ = sensors_from_base(bench, base, lambda line: None)
    (found,) = best.fit.candidates
    assert found.site.name == campaign.bodies.channels[2]
    assert takes(best.bench, best.fit, base)
    assert of_table(best.bench, best.fit) < 1.0


def test_damping_that_follows_the_torque_is_no_error_of_a_table(
    uncertain: StructureBench,
) -> None:
    """An exponent of 1 is found; nothing is fitted where damping is constant."""
    _, base = settled(uncertain, np.zeros(uncertain.base_sd.size), (), near=True)
    assert differences_from_base(uncertain, base, lambda line: None) == []
    hits = uncertain.campaign.hits
    damped = next(c for c in uncertain.candidates if c.effect.name == "preload_damping")
    assert differs(uncertain, damped)
    term = Term(damped, np.array([1.0]))
    with_it = uncertain.response(base.base, (term,), None)
    moved = with_it - uncertain.response(base.base, (), None)
    campaign = replace(
        uncertain.campaign, hits=replace(hits, response=hits.response + moved)
    )
    made = replace(uncertain, campaign=campaign, kept={})
    bench, base = settled(made, base.base, (), near=True)
    best, *_ = differences_from_base(bench, base, lambda line: None)
    assert best.fit.candidates == (damped,)
    assert abs(best.fit.x[-1] - 1.0) < 0.2
    assert takes_differences(best.bench, best.fit, base)
    assert takes(best.bench, best.fit, base)


def test_a_sensor_a_millimetre_off_is_within_tolerance(
    uncertain: StructureBench,
) -> None:
    """It is not named beside a base that explains the hits; 5 mm off is a fault."""
    effect = next(e.effect for e in SENSOR_EFFECTS if e.effect.name == "wrong_position")
    place = Candidate(effect, Site("channel", "A0"))
    x = np.zeros(uncertain.base_sd.size)
    base = minimise(make_problem(uncertain, ()), x, SHORT, iterations=0)
    base = replace(base, cost=base.cost + 1e4)
    near, off = (
        replace(base, candidates=(place,), x=np.append(x, [distance, 0.0]), cost=0.0)
        for distance in (-1e-3, 5e-3)
    )
    assert within_tolerance(uncertain, near)
    assert not within_tolerance(uncertain, off)
    assert not takes(uncertain, near, base)
    assert takes(uncertain, off, base)
