# SPDX-License-Identifier: MIT
"""Starts for many searches of one structure, from one survey of its box."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.structures.identification.multistart import starting_points
from jointbench.analysis.structures.identification.stiffness_problem import (
    StiffnessProblem,
    values_of,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.reduction.body_moduli import is_factor
from jointbench.analysis.structures.reduction.reduced_model import solve_reduced


@dataclass(frozen=True, slots=True, eq=False)
class SurveyedStarts:
    """Frequencies of a structure at points over its box.

    Attributes:
        names: of the unknowns.
        points: logarithms of the unknowns, shape (n_points, n_unknowns).
        log_frequency: of the elastic modes [ln Hz], shape (n_points, n_modes).
    """

    names: tuple[str, ...]
    points: FloatArray
    log_frequency: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "points", "log_frequency")

    def best(
        self, problem: StiffnessProblem, evidence: StructureEvidence, count: int
    ) -> list[FloatArray]:
        """Return the points whose frequencies are closest to the measured ones.

        Args:
            problem: of the search; unknowns that the survey lacks are at their prior.
            evidence: with its pairing; by order where it has none.
            count: number of points.

        Returns:
            Logarithms, each of shape (n_unknowns,); any points for FRFs.
        """
        chosen = np.arange(count)
        if evidence.modes is not None:
            measured = evidence.modes.natural_frequency
            order = np.arange(measured.size)
            if evidence.pairing is not None:
                order = np.asarray(evidence.pairing)
            away = self.log_frequency[:, order] - np.log(measured)
            # Of absolute values: one wrong mode must not decide.
            chosen = np.argsort(np.abs(away).sum(axis=1), kind="stable")[:count]
        found = np.tile(problem.prior, (chosen.size, 1))
        for at, name in enumerate(problem.names):
            if name in self.names and not is_factor(name):
                found[:, at] = self.points[chosen, self.names.index(name)]
        return list(found)


def survey_starts(problem: StiffnessProblem, count: int, seed: int) -> SurveyedStarts:
    """Compute the elastic frequencies of a problem over its box.

    Args:
        problem: of one state.
        count: number of points.
        seed: of the points.

    Returns:
        The points with their frequencies.
    """
    points = np.array(starting_points(problem, count, seed))
    plain = [at for at, name in enumerate(problem.names) if is_factor(name)]
    points[:, plain] = problem.prior[plain]
    logs = []
    for point in points:
        found = solve_reduced(problem.model, values_of(problem, point, 0).stiffness)
        logs.append(0.5 * np.log(found.eigenvalue[found.rigid :]) - np.log(2.0 * np.pi))
    least = min(one.size for one in logs)
    return SurveyedStarts(
        problem.names, points, np.array([one[:least] for one in logs])
    )
