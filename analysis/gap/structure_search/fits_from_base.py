# SPDX-License-Identifier: MIT
"""Directed tests beside a base that explains the hits, and fits from it."""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.gap.model.effect import Candidate, words_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import Direction, Screening, screen
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    at_rest,
    best_first,
)

WINDOW = Resolution(STRUCTURE_SEARCH.approach_windows[-1])
"""Of the directed tests beside a base."""


def tested_beside(
    few: StructureBench, base: Fit, candidates: Sequence[Candidate]
) -> tuple[Fit, Screening]:
    """Return the base in the window of the tests, and the tests of effects beside it.

    Args:
        few: the records of the tests.
        base: fit without effects.
        candidates: to be tested.
    """
    near = minimise(make_problem(few, ()), base.x, WINDOW, iterations=2)
    at_once = few.for_tests(near, WINDOW)
    return near, screen(at_once, near, candidates, resolution=WINDOW)


def fits_from_base(
    whole: StructureBench,
    few: StructureBench,
    base: Fit,
    found: Screening,
    progress: Progress,
    *,
    least: float = 0.0,
) -> list[JudgedFit]:
    """Return fits of the effects that lead the tests, best first, at rest.

    Args:
        whole: all records, on which the base was found.
        few: the records of the tests.
        base: fit without effects.
        found: tests beside it.
        progress: receives one line for each fit.
        least: drop of a test below which its effect is not fitted.
    """
    least = max(least, STRUCTURE_SEARCH.test_share * found.largest)
    done: list[JudgedFit] = []
    for candidate in found.leaders(STRUCTURE_SEARCH.whole_fits):
        test = found.best(candidate, 1)[0]
        if test.drop < least:
            break
        progress(f"{words_of((candidate,))} from the base")
        # Slopes of a law stay, and are the largest array there is.
        done = best_first([*done, _fit_from_base(whole, few, base, test)])
    return done


def _fit_from_base(
    whole: StructureBench, few: StructureBench, base: Fit, test: Direction
) -> JudgedFit:
    """Return the fit of an effect to all records, at rest.

    The start of a directed test is linear: that of a cable resonance had eighteen times
    the cost of the base. So its coordinates are fitted in the window of the test first.
    """
    candidates = (test.candidate,)
    start = np.concatenate([base.base, test.coordinates])
    steps = STRUCTURE_SEARCH.approach_iterations
    problem = make_problem(few, candidates)
    near = minimise(problem, start, WINDOW, iterations=steps, exact_slopes=False)
    start = np.concatenate([base.base, near.x[near.n_base :]])
    bench, fit = settled(whole, start, candidates, near=True)
    judged = accept_structure(bench, fit, base)
    return at_rest(JudgedFit(bench.at_rest(), fit, judged))
