# SPDX-License-Identifier: MIT
"""Faults of the bodies that explain the modes of all states of a jointed structure.

One at a time is free beside the joints, alike in every state: the modulus of a body,
the springs of its supports, the mass at a sensor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.structures.identification.sensor_masses import (
    SensorMasses,
    sensor_masses,
)
from jointbench.analysis.structures.identification.solution_branches import (
    exchanged_starts,
)
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    Prior,
    StiffnessProblem,
    pose_problem,
    residuals,
    state_at,
    values_of,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.parts import PointMass
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    bodies_on_springs,
    modulus_name,
    with_moduli,
    with_support_factor,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

_MODULUS_SD = 0.3
"""Of ln of a modulus that may be wrong [-]: stone, castings and laminates."""
_FACTOR_SD = 1.0
"""Of ln of the mass at a sensor, or of the springs of supports [-]."""
_STARTS = (-0.15, 0.15)
"""Of ln of a factor: modes that change places keep a descent on one side."""
_FITTED = 3
"""Faults of the largest predicted gain that are fitted."""
_REPAIRED = 2
"""Best of them whose states are searched again where they are not explained."""
_SHIFTS = (-0.7, -0.3, 0.3, 0.7)
"""Of ln of all joint values of a state, from where such a search begins as well."""
_ROUNDS = 3
_BETTER = 0.9
"""Part of chi2 that such a round must come down to."""
_LONGEST_STEP = 0.3
"""Of any unknown in that step, in ln."""
_LEAST_GAIN = 25.0
"""Predicted drop of chi2 by a fault below which it is not fitted."""


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """What is sought of the joints while a body has a fault.

    Attributes:
        known: values of the directions that are not sought; None where all are.
        sought: names of the others; None for all.
        shared: names common to all states.
        priors: by name.
    """

    known: JointValues | None
    sought: Sequence[str] | None
    shared: Sequence[str]
    priors: Mapping[str, Prior]


@dataclass(frozen=True, slots=True, eq=False)
class BodyFault:
    """One fault, fitted with the joints of all states.

    Attributes:
        effect: ``"modulus"``, ``"support"`` or ``"added_mass"``.
        site: ``"body"`` or ``"point"``, a colon, and its name.
        problem: with the factor among its unknowns.
        end: of the fit.
        factor: on the nominal value [-].
        factor_sd: its standard deviation [-].
        names: of the unknowns without that factor.
        nominal: fit of these on the same branch with the nominal value.
    """

    effect: str
    site: str
    problem: StiffnessProblem
    end: Optimum
    factor: float
    factor_sd: float
    names: tuple[str, ...]
    nominal: Optimum

    def state(self, label: str) -> tuple[ReducedModel, FloatArray]:
        """Return the structure with the fault in a state, and its joints.

        Args:
            label: of the state.

        Returns:
            The model, and the stiffness of every direction [N/m] and factor [-].
        """
        row = [one.label for one in self.problem.evidence].index(label)
        model, _ = state_at(self.problem, self.end.unknowns, row)
        return model, values_of(self.problem, self.end.unknowns, row).stiffness


@dataclass(frozen=True, slots=True, eq=False)
class _PosedFault:
    """A fault before its fit; `name` is that of its factor among the unknowns."""

    effect: str
    site: str
    problem: StiffnessProblem
    name: str

    def step(self, start: Mapping[str, float]) -> tuple[float, FloatArray]:
        """Return the predicted drop of chi2, and where the step ends, (n_unknowns,)."""
        first: FloatArray = np.log([start.get(n, 1.0) for n in self.problem.names])
        left, slopes = residuals(self.problem, first)
        moved = np.linalg.lstsq(slopes, -left, rcond=None)[0]
        without = np.delete(slopes, self.problem.names.index(self.name), axis=1)
        plain = np.linalg.lstsq(without, -left, rcond=None)[0]
        rest = left + without @ plain
        gain = float(rest @ rest - np.sum((left + slopes @ moved) ** 2))
        return gain, first + np.clip(moved, -_LONGEST_STEP, _LONGEST_STEP)

    def fitted(self, start: FloatArray) -> Optimum:
        """Fit joints and factor from a start, shape (n_unknowns,), and around it."""
        at = self.problem.names.index(self.name)
        starts = [start]
        for moved in _STARTS:
            other = start.copy()
            other[at] = moved
            starts.append(other)
        return min((descend(self.problem, x) for x in starts), key=lambda e: e.chi2)

    def repaired(self, end: Optimum) -> Optimum:
        """Search again, one by one, the states that the fault leaves unexplained.

        The solution without the fault may lie on another branch there.
        """
        for _ in range(_ROUNDS):
            if _explained(end):
                break
            unknowns = end.unknowns.copy()
            for row in range(len(self.problem.evidence)):
                self._search_state(row, unknowns)
            last, end = end, descend(self.problem, unknowns)
            if end.chi2 > _BETTER * last.chi2:
                return min(last, end, key=lambda one: one.chi2)
        return end

    def _search_state(self, row: int, unknowns: FloatArray) -> None:
        """Replace the joint of an unexplained state by a better one, in place."""
        whole = self.problem
        alone = replace(
            whole,
            evidence=(whole.evidence[row],),
            columns=whole.columns[row : row + 1],
            known=whole.known[row : row + 1],
        )
        columns = whole.columns[row]
        own = np.setdiff1d(columns[columns >= 0], [whole.names.index(self.name)])
        fixed = np.setdiff1d(np.arange(whole.size), own).tolist()
        here = descend(alone, unknowns, fixed)
        if not _explained(here):
            plain = [
                start
                for start in exchanged_starts(whole, here)
                if np.array_equal(np.delete(start, own), np.delete(unknowns, own))
            ]
            shifted = [here.unknowns.copy() for _ in _SHIFTS]
            for start, shift in zip(shifted, _SHIFTS, strict=True):
                start[own] += shift
            ends = (descend(alone, start, fixed) for start in (*plain, *shifted))
            here = min((here, *ends), key=lambda one: one.chi2)
        unknowns[own] = here.unknowns[own]

    def named(self, end: Optimum) -> BodyFault:
        """Return the fault with its factor."""
        at = self.problem.names.index(self.name)
        factor = float(np.exp(end.unknowns[at]))
        sd = float(np.sqrt(end.covariance()[at, at]))
        start = end.unknowns.copy()
        start[at] = 0.0
        plain = descend(self.problem, start, [at])
        names = self.problem.names
        return BodyFault(
            *(self.effect, self.site, self.problem, end, factor, factor * sd),
            names=(*names[:at], *names[at + 1 :]),
            nominal=Optimum(
                np.delete(plain.unknowns, at),
                plain.chi2,
                np.delete(plain.slopes, at, axis=1),
            ),
        )


@one_thread()
def body_faults(
    structure: Structure,
    model: ReducedModel,
    evidence: Sequence[StructureEvidence],
    joints: Joints,
    start: Mapping[str, float],
    masses: Mapping[str, PointMass],
) -> tuple[BodyFault, ...]:
    """Fit the faults of bodies that promise most, the best first.

    Each is tested by one step from the solution without a fault.

    Args:
        structure: bodies and joints on their meshes.
        model: the same, reduced.
        evidence: modes or FRFs of every state.
        joints: what is sought of them.
        start: values of the solution without a fault by name.
        masses: of the sensors, by name.
    """
    posed: list[_PosedFault] = []
    for body in (one.name for one in model.residual.components):
        name = modulus_name(body)
        if name not in model.names:
            own = with_moduli(model, [body])
            problem = _posed(own, evidence, joints, {name: Prior(1.0, _MODULUS_SD)})
            posed.append(_PosedFault("modulus", f"body:{body}", problem, name))
    for body in bodies_on_springs(structure):
        own = with_support_factor(model, structure, body)
        name = own.names[-1]
        problem = _posed(own, evidence, joints, {name: Prior(1.0, _FACTOR_SD)})
        posed.append(_PosedFault("support", f"body:{body}", problem, name))
    for sensor in masses:
        free = sensor_masses(structure, model, masses, {sensor: _FACTOR_SD})
        problem = _posed(model, evidence, joints, {}, free)
        posed.append(
            _PosedFault("added_mass", f"point:{sensor}", problem, free.names[0])
        )
    steps = [one.step(start) for one in posed]
    order = np.argsort([-gain for gain, _ in steps], kind="stable")
    kept = [k for k in order[:_FITTED] if steps[k][0] > _LEAST_GAIN]
    ends = [(posed[k], posed[k].fitted(steps[k][1])) for k in kept]
    ends.sort(key=lambda pair: pair[1].chi2)
    for k, (one, end) in enumerate(ends[:_REPAIRED]):
        ends[k] = (one, one.repaired(end))
        if _explained(ends[k][1]):
            break
    found = [one.named(end) for one, end in ends]
    return tuple(sorted(found, key=lambda one: one.end.chi2))


def _explained(end: Optimum) -> bool:
    return bool(end.chi2 <= end.slopes.shape[0])


def _posed(
    model: ReducedModel,
    evidence: Sequence[StructureEvidence],
    joints: Joints,
    more: Mapping[str, Prior],
    masses: SensorMasses | None = None,
) -> StiffnessProblem:
    known = joints.known
    if known is not None:
        further = len(model.names) - known.stiffness.size
        known = JointValues(
            np.concatenate([known.stiffness, np.ones(further)]),
            np.concatenate([known.damping, np.zeros(further)]),
        )
    return pose_problem(
        model,
        evidence,
        known=known,
        sought=joints.sought,
        shared=joints.shared,
        priors={**joints.priors, **more},
        masses=masses,
    )
