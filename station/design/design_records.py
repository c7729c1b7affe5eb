# SPDX-License-Identifier: MIT
"""What is asked of ``jointbench design``, and what it finds."""

from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.design.fisher_plan import HitPlan
from jointbench.analysis.design.plan_search import NextStep
from jointbench.analysis.design.torque_law import TorqueStep


@dataclass(frozen=True, slots=True, eq=False)
class NextTorque:
    """The test at one more torque.

    Attributes:
        torque: on each bolt [N m].
        step: what it buys.
    """

    torque: float
    step: TorqueStep


@dataclass(frozen=True, slots=True, eq=False)
class DesignedTest:
    """A test plan with what it is expected to give.

    Attributes:
        names: of the common parameters.
        wanted: numbers of the wanted ones.
        points: names of the points, sensors and hits alike.
        plan: chosen, or as measured.
        deviation: expected sd of the common parameters in ln, shape (p,).
        even: the same of an evenly spread plan.
        ratio_even: width of that plan over that of the chosen one [-].
        ratio_random: width of the best of 200 random plans, likewise [-].
        needed: hits at each point for the wanted deviation; None where there is none.
        steps: what one more step buys, the best first.
        torques: the test at one more torque; a step ``torque`` is numbered in it.
        known_torques: at which the joints are known so far.
    """

    names: tuple[str, ...]
    wanted: tuple[int, ...]
    points: tuple[str, ...]
    plan: HitPlan
    deviation: FloatArray
    even: FloatArray
    ratio_even: float
    ratio_random: float
    needed: int | None
    steps: tuple[NextStep, ...] = ()
    torques: tuple[NextTorque, ...] = ()
    known_torques: int = 0


@dataclass(frozen=True, slots=True)
class DesignRequest:
    """What is asked for.

    Attributes:
        identified: JSON of ``identify``; None takes the expected values of the model.
        state: label in it.
        measured: whether [sensors] and [hits] of the model are the plan, and the next
            step is asked for.
        deviation: wanted sd [-], or None.
        mass: added at each point in turn as a next step [kg], or None.
        plan_sensors: response sensors of the plan to be written, or None.
        plan_torques: torques of a plan, of which one could be next [N m].
    """

    identified: Path | None = None
    state: str | None = None
    measured: bool = False
    deviation: float | None = None
    mass: float | None = None
    plan_sensors: int | None = None
    plan_torques: tuple[float, ...] = ()
