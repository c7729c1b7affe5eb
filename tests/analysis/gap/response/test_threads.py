# SPDX-License-Identifier: MIT
"""Slopes are identical for any number of threads."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.search_effort import (
    SearchExhausted,
    counted,
    limited,
)
from jointbench.analysis.gap.response.threads import each, side_by_side
from jointbench.analysis.gap.search.jacobian import jacobian_of

SLIDER = ("jenkins", "link:joint", [8e5, 4e-6, 11.0])


def slider_problem() -> tuple[FitProblem, FloatArray]:
    """Return the problem of a hidden slider, and its coordinates."""
    bench = make_bench(made.made_campaign([SLIDER]))
    term = made.term_of(bench, *SLIDER)
    problem = make_problem(bench, (term.candidate,))
    return problem, np.concatenate([made.BASE, term.coordinates])


def test_slopes_do_not_depend_on_the_number_of_threads() -> None:
    """Three threads give the same result as one."""
    problem, x = slider_problem()
    residual = problem.residual(x, MIDDLE)
    with counted() as alone:
        expected = jacobian_of(problem, x, residual, MIDDLE)
    with counted() as together, side_by_side(3):
        found = jacobian_of(problem, x, residual, MIDDLE)
    assert np.array_equal(found, expected)
    assert np.abs(expected).max(axis=0).min() > 0.0
    assert together.spent == alone.spent > 0.0


@pytest.mark.parametrize("workers", [1, 3])
def test_a_search_ends_by_its_effort_in_any_thread(workers: int) -> None:
    """The effort of a thread counts, and its exception is raised."""
    problem, x = slider_problem()
    residual = problem.residual(x, MIDDLE)
    with counted() as effort, side_by_side(workers):
        jacobian_of(problem, x, residual, MIDDLE)
        with (
            limited(effort, 1.5 * effort.spent),
            pytest.raises(SearchExhausted),
        ):
            jacobian_of(problem, x, residual, MIDDLE)


def test_threads_end_with_their_context() -> None:
    """Outside it, tasks run one after the other in the calling thread."""
    seen: list[int] = []
    with side_by_side(2):
        each(seen.append, 3)
    each(seen.append, 2)
    assert sorted(seen[:3]) == [0, 1, 2]
    assert seen[3:] == [0, 1]
