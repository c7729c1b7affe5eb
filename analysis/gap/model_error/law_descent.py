# SPDX-License-Identifier: MIT
"""A quick descent of one law: the slopes of the base are those without the law.

A law changes the response little compared with what the base does, so that only the
slopes of the law itself are differenced again. The fit is approximate; the contenders
are fitted with all slopes afterwards.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.search.search_settings import SEARCH

_State = tuple[FloatArray, FloatArray, float]


def quick_fit(problem: FitProblem, base: Fit, start: FloatArray, least: float) -> Fit:
    """Minimise the cost of base and law from one start.

    Args:
        problem: base and one law.
        base: fit of the base alone under the same whitening.
        start: coordinates, shape (n,).
        least: drop of the cost below which the descent ends.
    """
    settings = MODEL_ERROR_SETTINGS
    state = _at(problem, np.clip(start, problem.lower, problem.upper))
    damping = settings.first_damping
    slopes = _slopes(problem, base, state)
    for _ in range(settings.law_iterations):
        moved, damping = _step(problem, state, slopes, damping)
        if moved is None:
            break
        drop, state = state[2] - moved[2], moved
        if drop < least:
            break
        slopes = _slopes(problem, base, state)
    x, rows, cost = state
    return Fit(
        x,
        problem.n_base,
        problem.candidates,
        rows,
        slopes,
        cost,
        problem.prior,
        problem.centre,
    )


def _at(problem: FitProblem, x: FloatArray) -> _State:
    """Return coordinates, residual and cost; an infinite cost if the model diverges."""
    with np.errstate(all="ignore"):
        try:
            rows = problem.residual(x, MIDDLE)
        except np.linalg.LinAlgError:  # a model with coincident modes
            rows = np.full(problem.bench.blocks.group.size, np.inf)
        cost = float(rows @ rows) + problem.penalty(x)
    return x, rows, cost if np.isfinite(cost) else np.inf


def _slopes(problem: FitProblem, base: Fit, state: _State) -> FloatArray:
    """Return the slopes of the base, and those of the law by differences."""
    x, rows, _ = state
    columns = [base.jacobian]
    for k in range(problem.n_base, x.size):
        step = SEARCH.effect_step * max(abs(float(x[k])), 1e-2)
        step = -step if x[k] + step > problem.upper[k] else step
        moved = x.copy()
        moved[k] += step
        columns.append(((problem.residual(moved, MIDDLE) - rows) / step)[:, None])
    return np.concatenate(columns, axis=1)


def _step(
    problem: FitProblem, state: _State, slopes: FloatArray, damping: float
) -> tuple[_State | None, float]:
    """Return the state after a step that lowers the cost, or None."""
    x, rows, cost = state
    if not np.isfinite(cost) or not np.isfinite(slopes).all():
        return None, damping
    hessian = slopes.T @ slopes + np.diag(problem.prior)
    gradient = slopes.T @ rows + problem.prior * (x - problem.centre)
    size = np.sqrt(np.maximum(np.diag(hessian), 1e-12))
    scaled = hessian / np.outer(size, size)
    for _ in range(MODEL_ERROR_SETTINGS.shorter_steps):
        step = np.linalg.lstsq(
            scaled + damping * np.eye(x.size), -gradient / size, rcond=1e-14
        )[0]
        bounded = np.clip(step / size, -SEARCH.longest_step, SEARCH.longest_step)
        moved = _at(problem, np.clip(x + bounded, problem.lower, problem.upper))
        if moved[2] < cost:
            return moved, damping / 10.0
        damping *= 30.0
    return None, damping
