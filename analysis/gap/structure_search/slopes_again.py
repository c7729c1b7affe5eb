# SPDX-License-Identifier: MIT
"""Slopes of fits at rest, which are computed again where they are needed."""

from dataclasses import replace

from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench


def with_slopes(bench: StructureBench, fit: Fit) -> Fit:
    """Return a fit with its slopes, which a verdict needs, and its cost.

    Args:
        bench: on which it was found.
        fit: of effects that are not integrated, or with its slopes.
    """
    if fit.jacobian.size:
        return fit
    problem = make_problem(bench, fit.candidates)
    found = minimise(problem, fit.x, FULL, iterations=0)
    return replace(found, cost=fit.cost)


def with_covariance(bench: StructureBench, fit: Fit) -> Fit:
    """Return a fit with its covariance: as kept, or with its slopes.

    Args:
        bench: on which it was found.
        fit: of effects that are not integrated, or with its slopes.
    """
    return fit if fit.kept is not None else with_slopes(bench, fit)
