# SPDX-License-Identifier: MIT
"""Fit of one effect from a base that explains the hits."""

import numpy as np

from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import Direction
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit, at_rest


def fit_from_base(
    whole: StructureBench,
    few: StructureBench,
    base: Fit,
    test: Direction,
    window: Resolution,
) -> JudgedFit:
    """Return the fit of an effect to all records, at rest.

    The start of a directed test is linear: that of a cable resonance had eighteen times
    the cost of the base. So its coordinates are fitted in the window of the test first.

    Args:
        whole: all records, on which the base was found.
        few: the records of the test.
        base: fit without effects.
        test: directed test that led to it.
        window: of the test.
    """
    candidates = (test.candidate,)
    start = np.concatenate([base.base, test.coordinates])
    steps = STRUCTURE.approach_iterations
    problem = make_problem(few, candidates)
    near = minimise(problem, start, window, iterations=steps, exact_slopes=False)
    start = np.concatenate([base.base, near.x[near.n_base :]])
    bench, fit = settled(whole, start, candidates, near=True)
    judged = accept_structure(bench, fit, base)
    return at_rest(JudgedFit(bench.at_rest(), fit, judged))
