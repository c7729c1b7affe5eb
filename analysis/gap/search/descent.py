# SPDX-License-Identifier: MIT
"""Minimise the cost by the Levenberg-Marquardt method, coarse to fine."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.residuals.slopes import (
    SlopeArray,
    along_columns,
    curvature,
    linear_change,
    squared_norms,
)
from jointbench.analysis.gap.search.jacobian import jacobian_of
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.slopes_on_hand import SlopesOnHand

_NO_SLOPES = np.zeros((0, 0))
"""In the place of slopes that are computed again: two sets double the memory."""


@dataclass(frozen=True, slots=True)
class Descent:
    """How far a descent goes.

    Attributes:
        resolution: window and step of the residual.
        iterations: largest number of steps.
        rival: cost of the best fit so far; a descent that would need very many more
            steps to reach it is stopped.
        jacobian_resolution: coarser resolution for the slopes, or None for the same.
        exact_slopes: difference the slopes once more at the end, which intermediate
            fits do not need.
        least_drop: drop of the cost below which the descent ends, for a fit that need
            not converge to a fraction of a unit of chi2.
        dof: degrees of freedom beyond which chi2 is excess; none for those of the
            samples, which are more where their errors are coherent.
        sparing: try no step that is hardly shorter than one that failed, and correct
            none further whose correction raised the cost.
        followed: whether a fit with slopes of its own follows, so that no others are
            computed where a step was small, or those updated by the secant promise
            nothing more.
        promises: drops that the linear model predicts for a full step within which the
            rival must be, or the descent ends; None for any number.
    """

    resolution: Resolution = FULL
    iterations: int = 20
    rival: float | None = None
    jacobian_resolution: Resolution | None = None
    exact_slopes: bool = True
    least_drop: float = 0.0
    dof: float | None = None
    sparing: bool = False
    followed: bool = False
    promises: float | None = None

    def slopes(self, problem: FitProblem, x: FloatArray, r: FloatArray) -> SlopeArray:
        """Return the Jacobian at x, where the residual is r, shape (n_rows, n)."""
        if self.jacobian_resolution is None:
            return jacobian_of(problem, x, r, self.resolution)
        coarse = problem.residual(x, self.jacobian_resolution)
        return jacobian_of(problem, x, coarse, self.jacobian_resolution)


def minimise(
    problem: FitProblem,
    start: FloatArray,
    resolution: Resolution = FULL,
    *,
    iterations: int = 20,
    rival: float | None = None,
    jacobian_resolution: Resolution | None = None,
    exact_slopes: bool = True,
    least_drop: float = 0.0,
) -> Fit:
    """Minimise the cost from one start; the options are those of `Descent`.

    Args:
        problem: least-squares problem.
        start: coordinates, shape (n,).
        resolution: window and step of the residual.
        iterations: largest number of steps.
        rival: cost of the best fit so far.
        jacobian_resolution: of the slopes.
        exact_slopes: slopes at the end are those of the solution.
        least_drop: of the cost.
    """
    how = Descent(
        resolution, iterations, rival, jacobian_resolution, exact_slopes, least_drop
    )
    return descend(problem, start, how)


def descend(
    problem: FitProblem,
    start: FloatArray,
    how: Descent,
    known: SlopesOnHand | None = None,
) -> Fit:
    """Minimise the cost from one start.

    Args:
        problem: least-squares problem.
        start: coordinates, shape (n,).
        how: how far.
        known: slopes of nearly the same problem there, kept until a step fails; they
            change in place. None to compute them.
    """
    x = np.clip(start, problem.lower, problem.upper)
    r, cost = _looked_at(problem, x, how.resolution)
    if not np.isfinite(cost):
        return _pruned(problem, x, r)
    damping, age = SEARCH.least_damping, 0 if known is None else 1
    j = how.slopes(problem, x, r) if known is None else known.taken()
    for k in range(how.iterations):
        ended = max(
            how.least_drop,
            SEARCH.excess_tolerance * _excess(problem, cost, how.dof)
            + SEARCH.absolute_tolerance,
        )
        near = _Neighbourhood(problem, x, r, j, cost, SEARCH.promised_share * ended)
        if how.rival is not None and how.promises is not None:
            if cost - how.rival > how.promises * near.promise():
                break
        moved, damping = _step(near, damping, how)
        if moved is None:
            if age == 0 or how.followed:
                break
            near.j = j = _NO_SLOPES
            j, age, damping = how.slopes(problem, x, r), 0, 1e-3
            continue
        drop = cost - moved[2]
        small = drop < ended
        guessed = near.predicted_drop(moved[0])
        change, before = moved[0] - x, r
        x, r, cost = moved
        if small and (age == 0 or known is not None or how.followed):
            break
        if how.rival is not None and k >= 1:
            if cost - how.rival > SEARCH.patience * drop:
                break
        if k + 1 == how.iterations:
            age += 1  # no step follows: the slopes are those of the step before
        elif (
            not small
            and age < SEARCH.secant_steps
            and drop > SEARCH.trusted_share * guessed
        ):
            j, age = _secant(j, change, r - before), age + 1
        else:
            near.j = j = _NO_SLOPES
            j, age = how.slopes(problem, x, r), 0
        near.j = _NO_SLOPES
    if age > 0 and how.exact_slopes:
        j, age = _NO_SLOPES, 0
        j = how.slopes(problem, x, r)
    return replace(_fit(problem, x, r, j, cost), late=age > 0)


def fit_at(problem: FitProblem, start: FloatArray, resolution: Resolution) -> Fit:
    """Return the fit at a start, without a step and without slopes.

    Args:
        problem: least-squares problem.
        start: coordinates, shape (n,).
        resolution: window and step of the residual.
    """
    x = np.clip(start, problem.lower, problem.upper)
    r, cost = _looked_at(problem, x, resolution)
    if not np.isfinite(cost):
        return _pruned(problem, x, r)
    return _fit(problem, x, r, np.zeros((0, x.size)), cost)


def _pruned(problem: FitProblem, x: FloatArray, r: FloatArray) -> Fit:
    """Return the fit of a start at which the model diverges."""
    slopes = np.zeros((r.size, x.size))
    return _fit(problem, x, np.full_like(r, np.inf), slopes, np.inf)


def _fit(
    problem: FitProblem, x: FloatArray, r: FloatArray, j: SlopeArray, cost: float
) -> Fit:
    """Return the fit of a problem at x, with residual, slopes and cost there."""
    n, candidates = problem.n_base, problem.candidates
    return Fit(x, n, candidates, r, j, cost, problem.prior, problem.centre)


def _excess(problem: FitProblem, cost: float, dof: float | None) -> float:
    return max(cost - (_problem_dof(problem) if dof is None else dof), 0.0)


class _Neighbourhood:
    """A point of a descent with the linear model of its residual.

    Attributes:
        problem: least-squares problem.
        x: coordinates, shape (n,).
        j: slopes, shape (n_rows, n).
        cost: at x.
        least: predicted drop below which a step is not tried.
        hessian: of half the cost, without second derivatives, shape (n, n).
        gradient: of half the cost, shape (n,).
    """

    def __init__(
        self,
        problem: FitProblem,
        x: FloatArray,
        r: FloatArray,
        j: SlopeArray,
        cost: float,
        least: float,
    ) -> None:
        self.problem, self.x, self.j = problem, x, j
        self.cost, self.least = cost, least
        self.hessian = curvature(j) + np.diag(problem.prior)
        self.gradient = self.gradient_with(x, r)

    def gradient_with(self, x: FloatArray, r: FloatArray) -> FloatArray:
        """Return the gradient of half the cost at x, with the slopes known here."""
        off = x - self.problem.centre
        return along_columns(self.j, r) + self.problem.prior * off

    def predicted_drop(self, moved: FloatArray) -> float:
        """Return the drop of the cost predicted by the linear model."""
        step = moved - self.x
        return -float(step @ (2.0 * self.gradient + self.hessian @ step))

    def promise(self) -> float:
        """Return the drop of the cost that the linear model predicts for a full step.

        Bounds are left out.
        """
        return self.predicted_drop(self.x - _solve(self.hessian, self.gradient))


def _secant(j: SlopeArray, change: FloatArray, difference: FloatArray) -> SlopeArray:
    """Update slopes in place from the residuals of a step, without an evaluation.

    Source:
        Broyden 1965, Math. Comp. 19, 577, eq. (4.5), with parameters scaled by the
        norm of their columns.
    """
    along = squared_norms(j) * change
    left, weights = difference - linear_change(j, change), along / (change @ along)
    moved = j if j.flags.writeable else j.copy()
    # Column by column: a second set of slopes would double the memory.
    for column, weight in zip(moved.T, weights, strict=True):
        column += left * weight
    return moved


def _problem_dof(problem: FitProblem) -> int:
    """Return the number of residuals that carry weight."""
    return problem.bench.blocks.dof


_Moved = tuple[FloatArray, FloatArray, float]


def _step(
    near: _Neighbourhood, damping: float, how: Descent
) -> tuple[_Moved | None, float]:
    """Try successively shorter steps until one lowers the cost.

    Effects and base can exchange stiffness and damping, so the valleys of the cost are
    long and curved. A step that raises the cost is first corrected along the
    well-determined directions, with the known slopes, and only then shortened. At a
    minimum even the longest step promises nothing, and none is tried; the promise is
    that of the whole step, because a step cut at a bound is corrected afterwards.
    """
    problem, x, gradient, cost = near.problem, near.x, near.gradient, near.cost
    free = ~(
        ((x <= problem.lower) & (gradient > 0))
        | ((x >= problem.upper) & (gradient < 0))
    )
    size = np.sqrt(np.maximum(np.diag(near.hessian), 1e-12))
    h = (near.hessian / np.outer(size, size))[np.ix_(free, free)]
    g = (gradient / size)[free]
    failed = np.inf
    for _ in range(9):
        step = np.zeros(x.size)
        step[free] = -_solve(h + damping * np.eye(h.shape[0]), g)
        if near.predicted_drop(x + step / size) < near.least:
            break
        length = float(np.linalg.norm(step))
        if not how.sparing or length < SEARCH.shorter_step * failed:
            tried = _tried(near, step, h, size, free, how)
            if tried[2] < cost:
                return tried, max(damping / 10, SEARCH.least_damping)
            failed = length
        damping = max(damping * 8, 1e-6)
        if damping > 1e7:
            break
    return None, damping


def _tried(
    near: _Neighbourhood,
    step: FloatArray,
    hessian: FloatArray,
    size: FloatArray,
    free: BoolArray,
    how: Descent,
) -> _Moved:
    """Return where a step leads, corrected into the valley while it raises the cost.

    Args:
        near: where it begins.
        step: over `size`, shape (n,).
        hessian: over `size`, of the free coordinates.
        size: root of the diagonal of the Hessian, shape (n,).
        free: coordinates that are not held at a bound, shape (n,).
        how: resolution, and whether the descent is sparing.
    """
    problem = near.problem
    x = _moved(problem, near.x, step / size)
    r, cost = _looked_at(problem, x, how.resolution)
    stiff = hessian + SEARCH.stiff_damping * np.eye(len(hessian))
    for _ in range(SEARCH.corrections):
        if cost < near.cost or not np.isfinite(cost):
            break
        back, before = np.zeros(x.size), cost
        back[free] = -_solve(stiff, (near.gradient_with(x, r) / size)[free])
        x = _moved(problem, x, back / size)
        r, cost = _looked_at(problem, x, how.resolution)
        if how.sparing and cost > before:
            break
    return x, r, cost


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve, with the smallest solution if parameters are linearly dependent."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-14)[0])


def _moved(problem: FitProblem, x: FloatArray, step: FloatArray) -> FloatArray:
    bounded = np.clip(step, -SEARCH.longest_step, SEARCH.longest_step)
    return np.clip(x + bounded, problem.lower, problem.upper)


def cost_at(problem: FitProblem, x: FloatArray, resolution: Resolution) -> float:
    """Return the cost at x, infinite if the model diverges."""
    return _looked_at(problem, x, resolution)[1]


def chi2_between(
    problem: FitProblem, x: FloatArray, coarse: Resolution, fine: Resolution
) -> float:
    """Return the chi2 between two resolutions at x; NaN if one diverges."""
    one, two = (_looked_at(problem, x, resolution)[0] for resolution in (coarse, fine))
    with np.errstate(all="ignore"):
        return float(np.sum((two - one) ** 2))


def _looked_at(
    problem: FitProblem, x: FloatArray, resolution: Resolution
) -> tuple[FloatArray, float]:
    with np.errstate(all="ignore"):
        try:
            r = problem.residual(x, resolution)
        except np.linalg.LinAlgError:  # a model with coincident modes
            return np.full(problem.bench.blocks.group.size, np.inf), np.inf
        cost = float(r @ r) + problem.penalty(x)
    return r, cost if np.isfinite(cost) else np.inf


_Resolutions = Sequence[tuple[Resolution, int]]
BASE_RESOLUTIONS: _Resolutions = (
    *((Resolution(decay), SEARCH.window_iterations) for decay in SEARCH.base_windows),
    (FULL, SEARCH.base_iterations),
)


def fit_coarse_to_fine(
    problem: FitProblem, start: FloatArray, resolutions: _Resolutions
) -> Fit:
    """Fit coarse to fine; the result is that of the last resolution."""
    x = start
    for resolution, iterations in resolutions[:-1]:
        x = minimise(
            problem, x, resolution, iterations=iterations, exact_slopes=False
        ).x
    last, iterations = resolutions[-1]
    return minimise(problem, x, last, iterations=iterations)
