# SPDX-License-Identifier: MIT
"""Scores on records that the fit did not see, one group out at a time.

With the fit at its minimum, leaving a group out moves the parameters by one Newton
step whose matrices are at hand; the residual of the group after that step is what a
refit without it would leave, to first order. Where one group alone holds a parameter
(the only hits that slip) that step is long and its foretelling is worth nothing, so
there the fit is made again.
"""

from dataclasses import dataclass, fields

import numpy as np

from jointbench.acquisition.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.analysis.gap.bench import FINE, MIDDLE, Bench, Blocks, Stage
from jointbench.analysis.gap.descent import minimise
from jointbench.analysis.gap.fit import Fit, Problem, make_problem

LONG_STEP = 1.5
"""Growth of a group's chi2 by being held out beyond which it is fitted again."""
REFIT_STEPS = 8


@dataclass(frozen=True, slots=True, eq=False)
class HeldOut:
    """Chi2 of each group when it is held out.

    Attributes:
        chi2: shape (n_groups,).
        dof: residuals with weight in each group, shape (n_groups,).
    """

    chi2: FloatArray
    dof: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "chi2", "dof")

    @property
    def chi2_per_dof(self) -> float:
        """Over all groups [-]."""
        return float(self.chi2.sum() / self.dof.sum())

    @property
    def gap(self) -> float:
        """sqrt(max(0, chi2/dof - 1)) [-]."""
        return float(np.sqrt(max(0.0, self.chi2_per_dof - 1.0)))


def hold_out(fit: Fit, bench: Bench) -> HeldOut:
    """Hold out every condition in turn, its repeats with it.

    Where there is but one condition, the sheet alone foretells it.

    Args:
        fit: a minimum.
        bench: on which it was found.
    """
    blocks = bench.blocks
    condition = conditions_of(blocks)
    hessian = fit.jacobian.T @ fit.jacobian + np.diag(fit.prior)
    chi2, dof = [], []
    share = blocks.dof / fit.residual.size
    for c in range(int(condition.max()) + 1):
        rows = np.isin(blocks.group, np.flatnonzero(condition == c))
        j, r = fit.jacobian[rows], fit.residual[rows]
        step = np.linalg.lstsq(hessian - j.T @ j, j.T @ r, rcond=1e-12)[0]
        left = r + j @ step
        if not rows.all() and left @ left > LONG_STEP * (r @ r):
            left = _fitted_without(fit, bench, rows)
        chi2.append(float(left @ left))
        dof.append(share * rows.sum())
    return HeldOut(np.array(chi2), np.array(dof))


@dataclass(frozen=True, slots=True, eq=False)
class _Without(Problem):
    """A problem that does not see some of its rows."""

    hidden: BoolArray

    def residual(self, x: FloatArray, stage: Stage) -> FloatArray:
        """Return the whitened residual at x, 0 in the rows that are hidden."""
        seen = Problem.residual(self, x, stage)
        seen[self.hidden] = 0.0
        return seen


def _fitted_without(fit: Fit, bench: Bench, rows: BoolArray) -> FloatArray:
    """Return the residual of some rows at a fit to all others."""
    whole = make_problem(bench, fit.candidates)
    known = {f.name: getattr(whole, f.name) for f in fields(whole)}
    blind = _Without(**known, hidden=rows)
    moved = minimise(
        blind,
        fit.x,
        FINE,
        iterations=REFIT_STEPS,
        jacobian_stage=MIDDLE,
        exact_slopes=False,
    )
    return whole.residual(moved.x, FINE)[rows]


def conditions_of(blocks: Blocks) -> IntArray:
    """Return the condition of each group: same level, point and preload are one."""
    keys = [
        tuple(v for k, v in sorted(labels.items()) if k != "order")
        for labels in blocks.labels
    ]
    index = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    return np.array([index[key] for key in keys])


def groups_won(before: HeldOut, after: HeldOut) -> float:
    """Return the share of the groups in which chi2 fell [-]."""
    return float(np.mean(after.chi2 < before.chi2))
