# SPDX-License-Identifier: MIT
"""Friction laws start from one another, since their costs have many minima."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.restarts import other_sliders

STIFFNESS, SLIP, SHARPNESS = 8e5, 4e-6, 11.0
NOISE = 0.05


def test_a_slider_is_found_from_a_law_that_imitates_it() -> None:
    """From the fit of a Bouc-Wen element, the Jenkins slider reaches the noise."""
    hidden = ("jenkins", "link:joint", [STIFFNESS, SLIP, SHARPNESS])
    campaign = made.made_campaign([hidden], noise=NOISE)
    bench = make_bench(campaign)
    start = made.term_of(bench, "bouc_wen", "link:joint", [STIFFNESS, SLIP, 3.0, 0.5])
    right = made.term_of(bench, *hidden)
    bench = bench.refine(made.BASE, [right])
    wrong = minimise(
        make_problem(bench, (start.candidate,)),
        np.concatenate([made.BASE, start.coordinates]),
        MIDDLE,
    )
    found = other_sliders(bench, wrong, lambda line: None)
    best = min(found, key=lambda f: f.cost)
    assert [c.effect.name for c in best.candidates] == ["jenkins"]
    dof = bench.blocks.dof
    assert wrong.chi2 > 1.2 * dof
    assert best.chi2 == pytest.approx(dof, rel=0.05)


def test_an_effect_without_sliders_has_no_alternatives() -> None:
    """A cubic spring is not a friction law."""
    bench = make_bench(made.made_campaign([]))
    term = made.term_of(bench, "cubic_stiffness", "link:joint", [0.0])
    problem = make_problem(bench, (term.candidate,))
    fit = minimise(problem, np.zeros(problem.n_base + 1), MIDDLE, iterations=2)
    assert other_sliders(bench, fit, pytest.fail) == []
