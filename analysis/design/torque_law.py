# SPDX-License-Identifier: MIT
"""What the test at one more torque buys: by the law of the parameters over the torque.

The parameters at torque T are ln k = ln k_0 + n ln(T/T_0) + e - e_0: those at T_0,
exponents n, and what each state departs from the law, the first one as well. Tests at
all torques inform on all of them together; gains of sensors and of hits are the same in
all, since the sensors stay.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.design.expected_gain import Forecast, expected_gain
from jointbench.analysis.design.fisher_plan import (
    Criterion,
    HitPlan,
    PairInformation,
    PlanPrior,
    plan_covariance,
    plan_width,
)

CONTACT_EXPONENTS = (1.0 / 3.0, 0.5, 1.0)
"""Stiffness over load: smooth contact (Hertz), between, rough contact (Persson)."""
_DRAWS = 300
# Laws nearer than this score are rivals, as in the diagnosis of joints.
_RIVAL_SCORE = 15.0


@dataclass(frozen=True, slots=True, eq=False)
class TorqueTest:
    """The test at one torque.

    Attributes:
        log_ratio: ln of the torque over that of the wanted parameters [-].
        pairs: information of its sensors and hit points, by the parameters there.
    """

    log_ratio: float
    pairs: PairInformation


@dataclass(frozen=True, slots=True, eq=False)
class TorqueLaw:
    """What is known of the law before.

    Attributes:
        deviation: sd of each parameter's exponent, 0 where a parameter is the same at
            all torques (a modulus), shape (p,).
        scatter: sd in ln by which a state departs from the law [-].
    """

    deviation: FloatArray
    scatter: float = 0.0

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "deviation")

    @property
    def bound(self) -> IntArray:
        """Numbers of the parameters that change with the torque."""
        return np.flatnonzero(self.deviation > 0)


@dataclass(frozen=True, slots=True, eq=False)
class TorqueRequest:
    """What the steps are for.

    Attributes:
        known: tests so far; the first one is at the torque of the parameters.
        prior: of the parameters, with gains.
        law: over the torque.
        wanted: numbers of the wanted parameters.
        judged: those of them whose exponents contact laws state (stiffnesses).
        criterion: D or E.
        repeats: hits at each point.
    """

    known: tuple[TorqueTest, ...]
    prior: PlanPrior
    law: TorqueLaw
    wanted: IntArray
    judged: IntArray
    criterion: Criterion = Criterion.D
    repeats: float = 1.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "wanted", "judged")


@dataclass(frozen=True, slots=True, eq=False)
class TorqueStep:
    """The test at one more torque, and what it buys.

    Attributes:
        log_ratio: ln of the torque over that of the parameters [-].
        width: of the wanted parameters afterwards, over that before [-].
        law_width: of their exponents afterwards, over that before [-].
        exponent_sd: of each parameter's exponent afterwards, shape (p,).
        decides: share of outcomes that leave one exponent of `CONTACT_EXPONENTS` [-].
    """

    log_ratio: float
    width: float
    law_width: float
    exponent_sd: FloatArray
    decides: float

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "exponent_sd")


def torque_steps(
    request: TorqueRequest, options: Sequence[TorqueTest]
) -> tuple[TorqueStep, ...]:
    """Return what the test at one more torque buys, in the order of `options`.

    Args:
        request: tests so far, priors and what is wanted.
        options: tests that could follow.
    """
    size, bound = request.law.deviation.size, request.law.bound
    exponents = np.flatnonzero(np.isin(bound, request.wanted)) + size
    before = law_covariance(request, request.known)
    steps = []
    for option in options:
        after = law_covariance(request, (*request.known, option))
        width, law_width = (
            plan_width(after, at, request.criterion)
            / plan_width(before, at, request.criterion)
            for at in (request.wanted, exponents)
        )
        deviation = np.zeros(size)
        deviation[bound] = np.sqrt(np.diag(after)[size : size + bound.size])
        decides = _decides(request, (*request.known, option))
        steps.append(TorqueStep(option.log_ratio, width, law_width, deviation, decides))
    return tuple(steps)


def law_covariance(request: TorqueRequest, tests: Sequence[TorqueTest]) -> FloatArray:
    """Return the covariance of parameters, exponents, and departures of states.

    Args:
        request: priors and law.
        tests: at their torques; the first one is at that of the parameters.

    Returns:
        Shape (p + d + d n_tests,) squared, of d parameters that change with the torque;
        without departures where the scatter is 0.
    """
    law, bound = request.law, request.law.bound
    states = len(tests) if law.scatter > 0 else 0
    shape = tests[0].pairs.own.shape
    own = np.concatenate(
        [
            request.prior.deviation,
            law.deviation[bound],
            np.full(states * bound.size, law.scatter),
        ]
    )
    whole = PairInformation(
        np.zeros((*shape, own.size, own.size)),
        np.zeros((*shape, own.size)),
        np.zeros(shape),
    )
    for at, test in enumerate(tests):
        turn = _turn(law, test.log_ratio, at, own.size)
        part = _turned_pairs(test.pairs, turn)
        whole = PairInformation(
            whole.common + part.common, whole.cross + part.cross, whole.own + part.own
        )
    plan = HitPlan(tuple(range(shape[0])), tuple(range(shape[1])), request.repeats)
    return plan_covariance(whole, replace(request.prior, deviation=own), plan)


def _turned_pairs(pairs: PairInformation, turn: FloatArray) -> PairInformation:
    """Return information on coordinates z, of which the parameters are `turn` @ z.

    Args:
        pairs: on the parameters.
        turn: shape (p, n).
    """
    return PairInformation(
        np.swapaxes(pairs.common @ turn, -1, -2) @ turn, pairs.cross @ turn, pairs.own
    )


def _turn(law: TorqueLaw, log_ratio: float, state: int, size: int) -> FloatArray:
    """Return how the parameters at a torque follow from the coordinates."""
    count, bound = law.deviation.size, law.bound
    found = np.zeros((count, size))
    found[:, :count] = np.eye(count)
    each = np.arange(bound.size)
    found[bound, count + each] = log_ratio
    if state > 0 and law.scatter > 0:
        departure = count + bound.size + each
        found[bound, departure] = -1.0
        found[bound, departure + bound.size * state] = 1.0
    return found


def _decides(request: TorqueRequest, tests: Sequence[TorqueTest]) -> float:
    """Return the share of outcomes that leave one contact law.

    All judged stiffnesses follow one exponent; what is known of it before is left out.
    """
    if not any(test.log_ratio for test in tests) or not request.judged.size:
        return 0.0
    law = request.law
    free = replace(law, deviation=np.where(law.deviation > 0, np.inf, 0.0))
    size = law.deviation.size
    at = size + np.flatnonzero(np.isin(law.bound, request.judged))
    own = law_covariance(replace(request, law=free), tests)[np.ix_(at, at)]
    forecasts = [Forecast(0.0, np.full(at.size, n), own) for n in CONTACT_EXPONENTS]
    return expected_gain(forecasts, _RIVAL_SCORE, draws=_DRAWS).decided
