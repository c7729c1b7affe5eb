# SPDX-License-Identifier: MIT
"""A descent along a long and curved valley, and what ends it early."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.search.descent import Descent, descend, fit_at

SHARE = np.array([100.0, 1.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Valley:
    """Rosenbrock's valley, at whose end a third residual leaves a cost of four."""

    blocks: Blocks
    met: list[FloatArray] = field(default_factory=list)

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return the residual, and keep where it was asked for."""
        self.met.append(base.copy())
        x, y = base
        return SHARE * np.array([y - x**2, 1.0 - x, 2.0])


def valley() -> tuple[Valley, FitProblem]:
    """Return the problem, which records where its residual was asked for."""
    bench = Valley(Blocks(np.zeros(3, dtype=np.int64), (), 3, (1, 1, 3)))
    wide = np.full(2, 10.0)
    flat = np.zeros(2)
    problem = FitProblem(cast(Bench, bench), (), -wide, wide, flat, flat, 2)
    return bench, problem


@pytest.mark.parametrize("start", [(-1.2, 1.0), (-2.0, -1.0), (-3.0, 2.0)])
def test_a_sparing_descent_ends_where_any_other_does(start: tuple[float, float]):
    costs, counts = [], []
    for sparing in (False, True):
        bench, problem = valley()
        how = Descent(iterations=200, sparing=sparing, exact_slopes=False, dof=3.0)
        costs.append(descend(problem, np.array(start), how).cost)
        counts.append(len(bench.met))
    assert costs == pytest.approx([4.0, 4.0], abs=0.01)
    assert counts[1] < counts[0]


@pytest.mark.parametrize("start", [(-1.2, 1.0), (-2.0, -1.0), (-3.0, 2.0)])
def test_a_rival_out_of_reach_ends_a_descent_before_its_first_step(
    start: tuple[float, float],
):
    """The slopes promise to take all but the four that every point leaves."""
    _, problem = valley()
    begun = fit_at(problem, np.array(start), FULL).cost
    for share, moves in ((0.9, True), (1.1, False)):
        rival = begun - share * 2.0 * (begun - 4.0)
        how = Descent(iterations=50, rival=rival, promises=2.0)
        cost = descend(problem, np.array(start), how).cost
        assert (cost < begun) is moves


def test_a_descent_that_is_followed_computes_no_slopes_for_nothing():
    """Slopes updated by the secant promise no further drop at the minimum."""
    costs, counts = [], []
    for followed in (False, True):
        bench, problem = valley()
        how = Descent(iterations=50, followed=followed, exact_slopes=False, dof=3.0)
        fit = descend(problem, np.array([1.02, 1.03]), how)
        costs.append(fit.cost)
        counts.append(len(bench.met))
        assert fit.late is followed
    assert costs == pytest.approx([4.0, 4.0], abs=0.01)
    assert counts[1] < counts[0]


def test_a_fit_at_a_point_asks_for_one_residual():
    bench, problem = valley()
    there = fit_at(problem, np.array([-1.2, 20.0]), FULL)
    assert len(bench.met) == 1
    assert there.x == pytest.approx([-1.2, 10.0])
    assert there.cost == pytest.approx(float(there.residual @ there.residual))
    assert there.jacobian.shape == (0, 2)
