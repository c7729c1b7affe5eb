"""Plans of hits and sensors: information, choice, and what it is compared with."""

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.design.fisher_plan import (
    Criterion,
    HitPlan,
    PairInformation,
    PlanPrior,
    hits_needed,
    plan_covariance,
)
from jointbench.analysis.design.plan_search import (
    PlanRequest,
    choose_plan,
    next_steps,
    random_plan,
)
from jointbench.analysis.structures.design.pair_information import (
    AddedMass,
    HammerTest,
    information_names,
    pair_information,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

HAMMER = HammerTest(500.0, 2e-4, 0.05, 25600.0, 0.25, (300.0, 2500.0), 60)


@pytest.fixture(scope="module")
def pairs(
    reduced: ReducedModel, rows: np.ndarray, truth: JointValues
) -> PairInformation:
    """Five points, each for sensors and for hits."""
    return pair_information(reduced, truth, HAMMER, rows, rows)


def random_pairs(seed: int, sensors: int = 7, hits: int = 6) -> PairInformation:
    """Information of random slopes of three parameters at four lines."""
    rng = np.random.default_rng(seed)
    slope = rng.normal(size=(sensors, hits, 3, 4)) * rng.uniform(
        0.2, 3.0, (sensors, hits, 1, 1)
    )
    own = rng.normal(size=(sensors, hits, 4)) * 5.0
    return PairInformation(
        np.einsum("shpl,shql->shpq", slope, slope),
        np.einsum("shpl,shl->shp", slope, own),
        np.einsum("shl,shl->sh", own, own),
    )


def request(pairs: PairInformation, **more: object) -> PlanRequest:
    """All parameters wanted, with gains of 2 %."""
    size = pairs.common.shape[-1]
    prior = PlanPrior(np.full(size, np.inf), 0.02, 0.02)
    return PlanRequest(pairs, prior, np.arange(size), **more)  # type: ignore[arg-type]


def test_slopes_are_those_of_the_frf(
    reduced: ReducedModel, rows: np.ndarray, truth: JointValues, pairs: PairInformation
) -> None:
    """The own information of a pair is chi2 of its FRF; damping follows stiffness."""
    again = pair_information(reduced, truth, HAMMER, rows[:1], rows[2:3])
    scale = np.abs(pairs.common[0, 2]).max()
    assert_allclose(
        again.common[0, 0], pairs.common[0, 2], rtol=1e-6, atol=1e-7 * scale
    )
    assert information_names(reduced)[3] == "joint.normal_damping"
    assert np.all(np.linalg.eigvalsh(pairs.common) > -1e-6 * pairs.common.max())


def test_a_mass_that_vanishes_changes_nothing_and_a_real_one_does(
    reduced: ReducedModel, rows: np.ndarray, truth: JointValues, pairs: PairInformation
) -> None:
    """One microgram and one kilogram."""
    found = []
    for mass in (1e-9, 1.0):
        added = AddedMass(mass, rows[2])
        found.append(
            pair_information(reduced, truth, HAMMER, rows, rows, added).own[0, 0]
        )
    assert_allclose(found[0], pairs.own[0, 0], rtol=1e-5)
    assert abs(found[1] / pairs.own[0, 0] - 1.0) > 0.01


def test_gains_as_parameters_give_the_same_covariance() -> None:
    """The Schur complement is the inverse of the whole information, wanted part."""
    pairs = random_pairs(1, 2, 2)
    prior = PlanPrior(np.array([np.inf, 0.5, np.inf]), 0.1, 0.2)
    plan = HitPlan((0, 1), (0, 1), 3.0)
    whole = np.zeros((7, 7))
    whole[:3, :3] = 3.0 * pairs.common.sum(axis=(0, 1)) + np.diag([0.0, 4.0, 0.0])
    for i in range(2):
        for j in range(2):
            for at in (3 + i, 5 + j):
                whole[:3, at] += 3.0 * pairs.cross[i, j]
            whole[3 + i, 5 + j] += 3.0 * pairs.own[i, j]
    whole = whole + np.triu(whole, 3).T * (np.arange(7)[:, None] > 2)
    whole[range(3, 5), range(3, 5)] = 100.0 + 3.0 * pairs.own.sum(axis=1)
    whole[range(5, 7), range(5, 7)] = 25.0 + 3.0 * pairs.own.sum(axis=0)
    upper = np.triu(whole)
    whole = upper + np.triu(upper, 1).T
    wanted = np.linalg.inv(whole)[:3, :3]
    assert_allclose(plan_covariance(pairs, prior, plan), wanted, rtol=1e-5)


@pytest.mark.parametrize("criterion", list(Criterion))
def test_the_plan_is_the_best_of_all_and_of_random_ones(criterion: Criterion) -> None:
    """All 7 x 6 plans of two sensors and two points; 200 random ones of three."""
    for seed in range(3):
        search = request(random_pairs(seed), criterion=criterion)
        found = search.width(choose_plan(search, 2, 2))
        widths = [
            search.width(HitPlan(s, h))
            for s in combinations(range(7), 2)
            for h in combinations(range(6), 2)
        ]
        assert found <= min(widths) * (1 + 1e-9)
        rng = np.random.default_rng(90 + seed)
        best = min(search.width(random_plan(search, 3, 3, rng)) for _ in range(200))
        assert search.width(choose_plan(search, 3, 3)) <= best * (1 + 1e-9)


def test_more_hits_narrow_until_the_prior_limits() -> None:
    """The number found is the smallest; gains set an end to it."""
    search, plan = request(random_pairs(4)), HitPlan((0, 1, 2), (0, 1))
    wanted = [0, 1, 2]

    def widest(count: int) -> float:
        full = HitPlan(plan.sensors, plan.hits, count)
        found = plan_covariance(search.pairs, search.prior, full)
        return float(np.sqrt(np.diag(found).max()))

    goal = 0.5 * widest(1)
    count = hits_needed(search.pairs, search.prior, plan, wanted, goal)
    assert count is not None
    assert widest(count) <= goal < widest(count - 1)
    assert hits_needed(search.pairs, search.prior, plan, wanted, 1e-9) is None


def test_next_steps_are_sorted_by_what_they_buy(pairs: PairInformation) -> None:
    """Every point that is left, and one more hit; none makes it wider."""
    search = request(pairs)
    plan = HitPlan((0, 2), (0,), 2.0)
    steps = next_steps(search, plan)
    assert len(steps) == 1 + 4 + 3
    widths = [one.width for one in steps]
    assert widths == sorted(widths)
    assert max(widths) <= 1.0 + 1e-9


def test_what_cannot_be_asked_is_said(pairs: PairInformation) -> None:
    """More sensors than points; no line in the band."""
    with pytest.raises(UsageError, match="6 sensors and 1 hit points of 5 and 5"):
        choose_plan(request(pairs), 6, 1)
    hammer = HammerTest(500.0, 2e-4, 0.05, 25600.0, 0.25, (301.0, 302.0))
    with pytest.raises(BadData, match="no line between 301 and 302"):
        hammer.frequency()
