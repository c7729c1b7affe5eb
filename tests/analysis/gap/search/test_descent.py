# SPDX-License-Identifier: MIT
"""A descent along a long and curved valley, with and without sparing trials."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.search.descent import Descent, descend

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
