# SPDX-License-Identifier: MIT
"""Meshed bodies that do not explain their modes: the fault of a body that does."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.chain.chain_records import (
    JointReading,
    LinkTest,
    StructureReading,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.model.confidence import Evidence
from jointbench.analysis.gap.model.diagnosis_record import (
    Estimate,
    Finding,
    NamedEffect,
)
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.structures.identification.body_faults import (
    BodyFault,
    Joints,
    body_faults,
)
from jointbench.analysis.structures.identification.stiffness_problem import Optimum
from jointbench.station.joints.identify_checks import known_priors, known_values
from jointbench.station.joints.identify_run import IdentifiedStructure
from jointbench.station.joints.structure_model import StructureModel, masses_of
from jointbench.station.joints.structure_states import all_evidence

_SEPARATES = 9.0
"""Difference of chi2 above which another solution is the better one."""
SEEK_HITS = "seek the effect with `jointbench gap` without --surface"


def with_fault(
    done: IdentifiedStructure,
    settings: StructureModel,
    before: JointReading,
    names: Sequence[str],
) -> tuple[StructureReading, BodyFault | None]:
    """Return the reading of bodies, and the fault that explains their modes if any.

    Faults whose chi2 is too close to that of the best are all named; the joint is read
    with the best one.

    Args:
        done: bodies and joints as identified.
        settings: the model file.
        before: the joint without a fault, and the test of the modes.
        names: of its stiffness in each state that is kept.
    """
    count, faults = len(done.measured), _faults(done, settings)
    before = _on_best_branch(before, faults, names)
    accepted = [one for one in faults if _passes(one.end)]

    def gain(one: BodyFault) -> float:
        # What the mesh is wrong by is the same in every state: they count as one.
        return (before.test.cost - one.end.chi2) / count

    if not accepted or gain(accepted[0]) < CONTACT.amplitude_limit**2:
        if before.test.passed:
            return StructureReading(before), None
        reason = f"{before.test.reason}; no fault of one body explains them"
        unknown = StructureReading(before, None, Finding.UNKNOWN, (), reason, SEEK_HITS)
        return unknown, None
    trust = 2.0 * settings.identify.frequency_sd
    best = accepted[0]
    least = gain(best) - STANDARD.rival_score
    near = [one for one in accepted if gain(one) > least]
    words = " or ".join(f"{one.effect}@{one.site}" for one in near)
    reading = StructureReading(
        replace(before, test=_failed(before.test, words, gain(best))),
        _reading(best, names, words),
        Finding.NAMED if len(near) == 1 else Finding.AMBIGUOUS,
        tuple(_named(one, near, gain, trust) for one in near),
        f"{words} explains the modes",
        "" if len(near) == 1 else SEEK_HITS,
    )
    return reading, best


def _on_best_branch(
    before: JointReading, faults: Sequence[BodyFault], names: Sequence[str]
) -> JointReading:
    """Return the joint without a fault by the best fit that was met on the way."""
    if not faults:
        return before
    best = min(faults, key=lambda one: one.nominal.chi2)
    end = best.nominal
    if before.test.cost <= end.chi2 + _SEPARATES:
        return before
    rows = [best.names.index(name) for name in names]
    test = modes_test(end.chi2, _freedom(end))
    covariance = end.noise() * end.covariance()[np.ix_(rows, rows)]
    return JointReading(end.unknowns[rows], covariance, test)


def modes_test(chi2: float, freedom: int) -> LinkTest:
    """Return the test of the modes with a free joint.

    Args:
        chi2: of all states.
        freedom: rows less unknowns.
    """
    limit = chi2_limit(CONTACT.fit_chance, freedom) if freedom > 0 else np.inf
    passed = chi2 <= limit
    words = "explains its modes with a free joint"
    if not passed:
        words = (
            f"chi2 of its modes is {chi2:.0f}, the limit is {limit:.0f}; state what "
            "the mesh is good for with identify.frequency_sd"
        )
    return LinkTest(chi2, max(freedom, 0), bool(passed), words)


def _failed(test: LinkTest, words: str, gain: float) -> LinkTest:
    """Return the test of the modes as failed: a fault would explain them better."""
    reason = f"{words} would lower chi2 by {gain:.0f} for each state"
    return replace(test, passed=False, reason=reason)


def _faults(
    done: IdentifiedStructure, settings: StructureModel
) -> tuple[BodyFault, ...]:
    table, reduced = settings.identify, done.reduced
    joints = Joints(
        known_values(table, reduced.names),
        table.sought,
        table.shared,
        known_priors(table),
    )
    return body_faults(
        done.structure,
        reduced,
        all_evidence(done.structure, reduced, settings, dict(done.measured)),
        joints,
        done.result.solutions[0].parameters,
        masses_of(settings),
    )


def _passes(end: Optimum) -> bool:
    """Return whether a fit explains the modes of all states."""
    freedom = _freedom(end)
    return freedom > 0 and end.chi2 <= chi2_limit(CONTACT.fit_chance, freedom)


def _freedom(end: Optimum) -> int:
    return int(end.slopes.shape[0]) - end.unknowns.size


def _reading(fault: BodyFault, names: Sequence[str], words: str) -> JointReading:
    rows = [fault.problem.names.index(name) for name in names]
    chi2, freedom = fault.end.chi2, _freedom(fault.end)
    covariance = fault.end.noise() * fault.end.covariance()[np.ix_(rows, rows)]
    test = LinkTest(
        chi2,
        freedom,
        passed=True,
        reason=f"chi2 {chi2:.0f} for {freedom} degrees of freedom with {words}",
        charge=STANDARD.parameter_charge,
    )
    return JointReading(fault.end.unknowns[rows], covariance, test)


def _named(
    fault: BodyFault,
    near: Sequence[BodyFault],
    gain: Callable[[BodyFault], float],
    trust: float,
) -> NamedEffect:
    """Return a fault as an effect, with its probability among those near.

    Args:
        fault: that is named.
        near: it and those it is not distinguished from.
        gain: drop of chi2 by a fault for one state.
        trust: sd of ln of a stiffness by what the mesh is good for [-].
    """
    weight = np.exp([0.5 * (gain(one) - gain(fault)) for one in near])
    sd = float(np.hypot(fault.factor_sd, trust * fault.factor))
    rivals = [gain(fault) - gain(one) for one in near if one is not fault]
    return NamedEffect(
        fault.effect,
        fault.site,
        (Estimate("factor", fault.factor, sd, "-"),),
        float(1.0 / weight.sum()),
        Evidence(
            margin=min(rivals, default=STANDARD.rival_score),
            slack=0.0,
            amplitude=float(np.sqrt(max(gain(fault), 0.0))),
            effects=1,
        ),
    )
