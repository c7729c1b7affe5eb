# SPDX-License-Identifier: MIT
"""The next torque of a measured plan: which ones there are, and what each buys."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.design.fisher_plan import HitPlan, PairInformation
from jointbench.analysis.design.plan_search import PlanRequest
from jointbench.analysis.design.torque_law import (
    TorqueLaw,
    TorqueRequest,
    TorqueTest,
    torque_steps,
)
from jointbench.analysis.structures.design.pair_information import (
    HammerTest,
    information_names,
    pair_information,
)
from jointbench.analysis.structures.design.torque_exponents import (
    MeasuredLevels,
    fitted_exponents,
    prior_exponents,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import is_modulus
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.station.design.design_records import DesignRequest, NextTorque
from jointbench.station.joints.state_values import (
    IdentifiedFile,
    label_parts,
    read_identified,
    state_labels,
    state_values,
)
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.joints.structure_tables import DesignTable

# Torques beyond those measured, where the model names none that are allowed.
_BEYOND = (0.5, 2.0)
# Torques nearer than this are the same [-].
_SAME = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class KnownState:
    """The joints at a torque.

    Attributes:
        torque: on each bolt [N m].
        joints: stiffness and damping of every direction.
        deviation: sd of ln stiffness, then ln damping; infinite where one is not known,
            shape (2 n_parameters,).
    """

    torque: float
    joints: JointValues
    deviation: FloatArray

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "deviation")


@dataclass(frozen=True, slots=True, eq=False)
class StruckPlan:
    """The measured plan on its structure.

    Attributes:
        model: the reduced structure, with unknown moduli.
        test: how hits are made.
        sensors: rows of `readout`, shape (n_sensors, r).
        hits: rows of `readout`, shape (n_hits, r).
    """

    model: ReducedModel
    test: HammerTest
    sensors: FloatArray
    hits: FloatArray

    def information(self, joints: JointValues) -> PairInformation:
        """Return the information of one hit with joints of these values."""
        own = (self.sensors, self.hits)
        return pair_information(
            self.model, with_moduli_of_one(joints, self.model), self.test, *own
        )


def with_moduli_of_one(joints: JointValues, model: ReducedModel) -> JointValues:
    """Return values of joints with nominal moduli for a model that has some.

    Args:
        joints: of every direction.
        model: with or without unknown moduli.
    """
    count = sum(is_modulus(name) for name in model.names)
    return JointValues(
        np.append(joints.stiffness, np.ones(count)),
        np.append(joints.damping, np.zeros(count)),
    )


def known_states(
    settings: StructureModel,
    structure: Structure,
    request: DesignRequest,
    expected: JointValues,
) -> tuple[KnownState, ...]:
    """Return the joints at the torques so far; none where no torque is known.

    Args:
        settings: model with [design].
        structure: its joints.
        request: with the identified joints, if there are any.
        expected: values of the state that the plan is for.

    Returns:
        That state first, then the others whose torque is known.
    """
    table = settings.design
    assert table is not None
    if request.identified is None:
        if table.torque is None:
            return ()
        open_ones = np.full(2 * expected.stiffness.size, np.inf)
        return (KnownState(table.torque, expected, open_ones),)
    file = read_identified(request.identified)
    own = state_values(file, structure, settings.identify, request.state)
    torques = _torques(settings, table, own.label, file)
    found = []
    for label, torque in torques.items():
        state = state_values(file, structure, settings.identify, label or None)
        variance = np.diag(state.covariance)
        deviation = np.sqrt(np.where(variance > 0, variance, np.inf))
        found.append(KnownState(torque, state.joints, deviation))
    return tuple(found)


def _torques(
    settings: StructureModel, table: DesignTable, chosen: str, file: IdentifiedFile
) -> dict[str, float]:
    """Return the torques of identified states by label, the chosen one first."""
    contact = settings.contact

    def stated(label: str) -> float | None:
        preload = label_parts(label)[1]
        if label in table.states or preload is None or contact is None:
            return table.states.get(label)
        return contact.torque(preload)

    own = stated(chosen) or table.torque
    if own is None:
        return {}
    found, base = {chosen: own}, label_parts(chosen)[1]
    for label in state_labels(file):
        torque, preload = stated(label), label_parts(label)[1]
        if torque is None and base is not None and preload is not None:
            torque = own * preload / base
        if torque is not None and label != chosen:
            found[label] = torque
    return found


def torque_options(known: Iterable[float], allowed: Iterable[float]) -> list[float]:
    """Return torques that could be next, ascending [N m].

    Args:
        known: measured ones.
        allowed: ones that model or plan name.

    Returns:
        Allowed ones; those between neighbours; where none is named, also half the
        lowest and twice the highest.
    """
    measured, named = sorted(known), sorted(allowed)
    marks = sorted({*measured, *named})
    between = [float(np.sqrt(a * b)) for a, b in pairwise(marks)]
    ends = [] if named else [_BEYOND[0] * marks[0], _BEYOND[1] * marks[-1]]
    found = sorted({float(f"{one:.3g}") for one in (*named, *between, *ends)})
    return [
        one
        for one in found
        if all(abs(np.log(one / other)) > _SAME for other in measured)
    ]


def next_torques(
    struck: StruckPlan,
    search: PlanRequest,
    plan: HitPlan,
    states: Sequence[KnownState],
    allowed: Sequence[float],
    scatter: float,
) -> tuple[NextTorque, ...]:
    """Return what the plan at one more torque buys, torques ascending.

    Args:
        struck: the plan on its structure.
        search: priors, wanted parameters and criterion.
        plan: as measured.
        states: joints at the torques so far; the first one is the plan's.
        allowed: torques that model or plan name [N m].
        scatter: sd in ln by which a state departs from the law [-].
    """
    if not states:
        return ()
    names = information_names(struck.model)
    damping = np.array([name.endswith("_damping") for name in names])
    first = states[0]
    own = struck.information(first.joints).common.sum(axis=(0, 1))
    # A damping that was not identified is 0: nothing informs on its logarithm.
    informed = np.diag(own) > 0
    bound = np.array([not is_modulus(name) for name in names]) & informed
    wanted = search.wanted[informed[search.wanted]]
    if not bound[wanted].any():
        return ()
    ratios = np.array([float(np.log(one.torque / first.torque)) for one in states])
    exponent = _exponents(states, ratios, scatter)
    deviation = np.zeros(len(names))
    deviation[bound] = prior_exponents(damping)[1][bound]
    request = TorqueRequest(
        tuple(
            TorqueTest(float(ratio), struck.information(one.joints))
            for ratio, one in zip(ratios, states, strict=True)
        ),
        search.prior,
        TorqueLaw(deviation, scatter),
        wanted,
        np.array([at for at in wanted if bound[at] and not damping[at]], int),
        search.criterion,
        plan.repeats,
    )
    torques = torque_options([one.torque for one in states], allowed)
    tests = []
    for torque in torques:
        ratio = float(np.log(torque / first.torque))
        joints = _extrapolated(first.joints, exponent * ratio)
        tests.append(TorqueTest(ratio, struck.information(joints)))
    steps = torque_steps(request, tests)
    return tuple(map(NextTorque, torques, steps))


def _exponents(
    states: Sequence[KnownState], ratios: FloatArray, scatter: float
) -> FloatArray:
    """Return exponents of stiffness, then damping, from identified states."""
    value = np.array(
        [np.append(one.joints.stiffness, one.joints.damping) for one in states]
    )
    # A direction without damping has no logarithm, and no exponent but the prior.
    absent = value <= 0
    deviation = np.where(absent, np.inf, np.array([one.deviation for one in states]))
    levels = MeasuredLevels(ratios, np.log(np.where(absent, 1.0, value)), deviation)
    damping = np.arange(value.shape[1]) >= states[0].joints.stiffness.size
    return fitted_exponents(levels, damping, scatter)


def _extrapolated(joints: JointValues, change: FloatArray) -> JointValues:
    count = joints.stiffness.size
    return JointValues(
        joints.stiffness * np.exp(change[:count]),
        joints.damping * np.exp(change[count:]),
    )
