# SPDX-License-Identifier: MIT
"""Search of a test plan: greedy choice, then exchanges until none helps."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb

import numpy as np

from jointbench.acquisition.basics.arrays import IntArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.design.fisher_plan import (
    Criterion,
    HitPlan,
    PairInformation,
    PlanPrior,
    plan_covariance,
    plan_width,
)

# So few plans are all tried.
_ALL = 1500
# Further starts of the exchange: the best of so many random plans.
_STARTS = 4
_RANDOM = 200
# An exchange that gains less than this share is rounding.
_GAIN = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class PlanRequest:
    """What a plan is for.

    Attributes:
        pairs: information of single hits.
        prior: what is known before.
        wanted: numbers of the wanted parameters.
        criterion: D or E.
        repeats: hits at each point.
    """

    pairs: PairInformation
    prior: PlanPrior
    wanted: IntArray
    criterion: Criterion = Criterion.D
    repeats: float = 1.0

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "wanted")

    def width(self, plan: HitPlan) -> float:
        """Return the width of a plan."""
        found = plan_covariance(self.pairs, self.prior, plan)
        return plan_width(found, self.wanted, self.criterion)


@dataclass(frozen=True, slots=True)
class NextStep:
    """One thing added to a plan, and what it buys.

    Attributes:
        kind: ``hit point``, ``sensor`` or ``repeat``.
        number: of the point; -1 for one more hit at every point.
        width: afterwards, over that before [-].
    """

    kind: str
    number: int
    width: float


def require_choice(sensors: int, hits: int, there: tuple[int, int]) -> None:
    """Raise `UsageError` where more sensors or hit points are asked for than there are.

    Args:
        sensors: how many.
        hits: how many points.
        there: sensors and hit points that can be reached.
    """
    if not (0 < sensors <= there[0] and 0 < hits <= there[1]):
        raise UsageError(
            f"{sensors} sensors and {hits} hit points of {there[0]} and {there[1]} "
            "that can be reached; ask for at least one, and not for more"
        )


def choose_plan(
    request: PlanRequest, sensors: int, hits: int, seed: int = 0
) -> HitPlan:
    """Choose sensors and hit points.

    Args:
        request: information, prior and criterion.
        sensors: how many.
        hits: how many points.
        seed: of the further starts.

    Returns:
        The best plan found; numbers ascend.

    Raises:
        UsageError: more are asked for than there are.

    Source:
        Fedorov 1972, Theory of Optimal Experiments, ch. 3 (exchange).
    """
    there = request.pairs.own.shape
    require_choice(sensors, hits, (there[0], there[1]))
    if comb(there[0], sensors) * comb(there[1], hits) <= _ALL:
        ends = [
            HitPlan(own, struck, request.repeats)
            for own in combinations(range(there[0]), sensors)
            for struck in combinations(range(there[1]), hits)
        ]
    else:
        rng = np.random.default_rng(seed)
        some = [random_plan(request, sensors, hits, rng) for _ in range(_RANDOM)]
        starts = sorted(some, key=request.width)[:_STARTS]
        starts.append(_greedy(request, sensors, hits))
        ends = [_exchanged(request, one) for one in starts]
    best = min(ends, key=request.width)
    return replace(
        best, sensors=tuple(sorted(best.sensors)), hits=tuple(sorted(best.hits))
    )


def random_plan(
    request: PlanRequest, sensors: int, hits: int, rng: np.random.Generator
) -> HitPlan:
    """Return a random plan."""
    there = request.pairs.own.shape
    return HitPlan(
        tuple(rng.permutation(there[0])[:sensors].tolist()),
        tuple(rng.permutation(there[1])[:hits].tolist()),
        request.repeats,
    )


def next_steps(request: PlanRequest, plan: HitPlan) -> tuple[NextStep, ...]:
    """Return what one more hit point, sensor or repeat buys, the best first.

    Args:
        request: information, prior and criterion.
        plan: as measured.
    """
    before = request.width(plan)
    more = replace(plan, repeats=plan.repeats + 1.0)
    steps = [NextStep("repeat", -1, request.width(more) / before)]
    there = request.pairs.own.shape
    for at in sorted(set(range(there[1])) - set(plan.hits)):
        wider = replace(plan, hits=(*plan.hits, at))
        steps.append(NextStep("hit point", at, request.width(wider) / before))
    for at in sorted(set(range(there[0])) - set(plan.sensors)):
        wider = replace(plan, sensors=(*plan.sensors, at))
        steps.append(NextStep("sensor", at, request.width(wider) / before))
    return tuple(sorted(steps, key=lambda one: one.width))


def _greedy(request: PlanRequest, sensors: int, hits: int) -> HitPlan:
    """Begin with the best pair, and add what helps most until the plan is full."""
    there = request.pairs.own.shape
    single = [
        HitPlan((i,), (j,), request.repeats)
        for i in range(there[0])
        for j in range(there[1])
    ]
    plan = min(single, key=request.width)
    while len(plan.sensors) < sensors or len(plan.hits) < hits:
        options = list(_additions(plan, there, sensors, hits))
        plan = min(options, key=request.width)
    return plan


def _additions(
    plan: HitPlan, there: tuple[int, ...], sensors: int, hits: int
) -> Iterator[HitPlan]:
    if len(plan.sensors) < sensors:
        for at in set(range(there[0])) - set(plan.sensors):
            yield replace(plan, sensors=(*plan.sensors, at))
    if len(plan.hits) < hits:
        for at in set(range(there[1])) - set(plan.hits):
            yield replace(plan, hits=(*plan.hits, at))


def _exchanged(request: PlanRequest, plan: HitPlan) -> HitPlan:
    """Exchange one sensor or hit point at a time while that helps."""
    width = request.width(plan)
    there = request.pairs.own.shape
    while True:
        options = list(_swaps(plan, there))
        if not options:
            return plan
        widths = [request.width(one) for one in options]
        best = int(np.argmin(widths))
        if widths[best] > (1.0 - _GAIN) * width:
            return plan
        plan, width = options[best], widths[best]


def _swaps(plan: HitPlan, there: tuple[int, ...]) -> Iterator[HitPlan]:
    for place in range(len(plan.sensors)):
        for at in set(range(there[0])) - set(plan.sensors):
            chosen = list(plan.sensors)
            chosen[place] = at
            yield replace(plan, sensors=tuple(chosen))
    for place in range(len(plan.hits)):
        for at in set(range(there[1])) - set(plan.hits):
            chosen = list(plan.hits)
            chosen[place] = at
            yield replace(plan, hits=tuple(chosen))
