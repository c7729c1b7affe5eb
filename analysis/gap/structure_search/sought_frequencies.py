# SPDX-License-Identifier: MIT
"""Search for closed frequencies that a fit has lost.

A descent follows a frequency while its error turns the motion by less than half a cycle
before it has rung down. A mode that is further off stays in a minimum of its own.
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import cost_at
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.approach import approached
from jointbench.analysis.gap.structure_search.records_of_search import hardest
from jointbench.analysis.gap.structure_search.structure_fits import chi2_per_dof
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def from_other_frequencies(
    few: StructureBench, fit: Fit
) -> tuple[StructureBench, Fit] | None:
    """Return a better fit from frequencies that a fit has lost; None if there is none.

    They are sought where a fit leaves more than usual, but is not far off.

    Args:
        few: one record of each condition, on which the fit was found.
        fit: with or without effects.
    """
    chi2 = chi2_per_dof(few, fit)
    usual = STRUCTURE_SEARCH.sought_chi2 * few.policy.floor_chi2
    if not (few.uncertain and usual < chi2 < STRUCTURE_SEARCH.explaining_chi2):
        return None
    if (start := sought(few, fit)) is None:
        return None
    few, other = approached(few, start, fit.candidates)
    return (few, other) if other.cost < fit.cost else None


def sought(few: StructureBench, fit: Fit) -> FloatArray | None:
    """Return coordinates with frequencies found elsewhere; None if none is.

    Args:
        few: one record of each condition, on which the fit was found.
        fit: with or without effects.
    """
    tuned = few.layout.tuned
    if tuned is None:
        return None
    # Bodies and joints of a fit without laws are the same at all levels.
    few = few.chosen(hardest(few.campaign.hits, STRUCTURE_SEARCH.sought_levels))
    window = STRUCTURE_SEARCH.approach_windows[0]
    # Priors would draw a frequency back; the fit that follows weighs them.
    free = np.zeros(fit.x.size)
    problem = replace(make_problem(few, fit.candidates), prior=free)
    x, found = fit.x, False
    cost = cost_at(problem, x, Resolution(window))
    for k, name in enumerate(tuned.names[: tuned.omega.size]):
        at = few.layout.at(name)
        step = 2.0 * np.pi * STRUCTURE_SEARCH.sought_turn / window / tuned.omega[k]
        count = int(STRUCTURE_SEARCH.sought_reach / step)
        shifts = step * np.concatenate([np.arange(-count, 0), np.arange(1, count + 1)])
        starts = [x + shift * (np.arange(x.size) == at) for shift in shifts]
        costs = [cost_at(problem, one, Resolution(window)) for one in starts]
        if costs and min(costs) < (1.0 - STRUCTURE_SEARCH.sought_share) * cost:
            x, cost, found = starts[int(np.argmin(costs))], min(costs), True
    return x if found else None
