# SPDX-License-Identifier: MIT
"""Prediction of each torque from a fit to all others, with its interval."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.analysis.gap.contact_bench.contact_bench import ContactBench
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.slopes import curvature
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.jacobian import jacobian_of


@dataclass(frozen=True, slots=True, eq=False)
class HeldOutTorques:
    """Values at each torque, predicted without it.

    Attributes:
        level: torque [N m] or preload [N] of each row, shape (n_rows,).
        predicted: ln of the value, same shape.
        sd: of the measured minus the predicted logarithm, same shape.
        measured: ln of the value, same shape.
        seen: False where only a bound is known, same shape.
        chi2: of each level with the covariance of its prediction, shape (n_levels,).
        dof: values of each level, same shape.
        levels: torque or preload of each level, same shape.
    """

    level: FloatArray
    predicted: FloatArray
    sd: FloatArray
    measured: FloatArray
    seen: BoolArray
    chi2: FloatArray
    dof: FloatArray
    levels: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "level", "predicted", "sd", "measured", "seen")
        freeze(self, "chi2", "dof", "levels")

    @property
    def inside(self) -> BoolArray:
        """Whether each value is within its interval of 95 %, shape (n_rows,)."""
        off = np.abs(self.measured - self.predicted)
        return np.asarray(off <= CONTACT.interval_z * self.sd)

    @property
    def share_inside(self) -> float:
        """Share of the values within their interval [-]."""
        return float(self.inside[self.seen].mean()) if self.seen.any() else 1.0

    @property
    def chi2_per_dof(self) -> float:
        """Over all levels [-]."""
        return float(self.chi2.sum() / max(self.dof.sum(), 1.0))

    @property
    def gap(self) -> float:
        """sqrt(max(0, chi2/dof - 1)) [-]."""
        return float(np.sqrt(max(0.0, self.chi2_per_dof - 1.0)))


def hold_out_torques(bench: ContactBench, fit: Fit) -> HeldOutTorques:
    """Predict the values of each torque from a fit to the others.

    The interval holds the uncertainty of all parameters, of the preload in the held-out
    states, of the measured value, and the error of the formulas, which is common to the
    values of a torque.

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    rows = bench.data.rows
    level = bench.data.states.level[rows.state]
    levels = np.unique(level)
    predicted, sd = rows.value.copy(), np.ones(level.size)
    chi2, dof = np.zeros(levels.size), np.zeros(levels.size)
    for i, one in enumerate(levels):
        own = level == one
        mean, covariance = _predict(bench, fit, own)
        predicted[own] = mean
        sd[own] = np.sqrt(np.diag(covariance))
        seen = ~rows.bound[own]
        off = (rows.value[own] - mean)[seen]
        part = covariance[np.ix_(seen, seen)]
        chi2[i] = float(off @ np.linalg.solve(part, off)) if seen.any() else 0.0
        dof[i] = seen.sum()
    return HeldOutTorques(
        level, predicted, sd, rows.value.copy(), ~rows.bound, chi2, dof, levels
    )


def _predict(
    bench: ContactBench, fit: Fit, own: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of the measured minus predicted logarithms."""
    rows = bench.data.rows
    if own.all():
        x, hessian = np.zeros(fit.x.size), np.diag(np.maximum(fit.prior, 1e-9))
        x[fit.n_base :] = fit.x[fit.n_base :]
    else:
        others = bench.chosen(~own)
        problem = make_problem(others, fit.candidates)
        found = minimise(problem, fit.x, FULL, iterations=CONTACT.descent_steps)
        x = found.x
        hessian = curvature(found.jacobian) + np.diag(found.prior)
    held = bench.plain(own)
    problem = make_problem(held, fit.candidates)
    slopes = jacobian_of(problem, x, problem.residual(x, FULL), FULL)
    spread = slopes @ np.linalg.pinv(hessian, hermitian=True) @ slopes.T
    # A fit that leaves more than its noise predicts no better than it fits.
    spread *= max(fit.cost / max(bench.blocks.dof, 1), 1.0)
    spread += CONTACT.model_sd**2
    mean = held.predict(x[: fit.n_base], split(x, fit.n_base, fit.candidates))
    return mean, spread + rows.covariance[np.ix_(own, own)]
