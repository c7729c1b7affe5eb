# SPDX-License-Identifier: MIT
"""Joint least squares of base and effects: Levenberg and Marquardt, coarse to fine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.bench import FULL, Bench, Stage
from jointbench.analysis.gap.effects import Candidate, Term

EXCESS_TOLERANCE = 1e-3
"""Stop below this share of the excess of chi2 over its degrees of freedom: a share
of chi2 itself would hide an effect of a hundred units among 60,000."""
ABSOLUTE_TOLERANCE = 0.03
BASE_STEP = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A minimum of the cost.

    Attributes:
        x: base coordinates, then those of each candidate, shape (n,).
        n_base: how many of them belong to the base.
        candidates: the effects switched on.
        residual: whitened, shape (n_rows,).
        jacobian: d residual / d x, shape (n_rows, n).
        cost: chi2 of the data plus that of the priors.
        prior: diagonal of the prior's precision, shape (n,).
        centre: of the prior, shape (n,).
    """

    x: FloatArray
    n_base: int
    candidates: tuple[Candidate, ...]
    residual: FloatArray
    jacobian: FloatArray
    cost: float
    prior: FloatArray
    centre: FloatArray

    @property
    def base(self) -> FloatArray:
        """Base coordinates, shape (n_base,)."""
        return self.x[: self.n_base]

    @property
    def terms(self) -> tuple[Term, ...]:
        """The effects with their coordinates."""
        return split(self.x, self.n_base, self.candidates)

    @property
    def chi2(self) -> float:
        """Of the data alone."""
        return float(self.residual @ self.residual)

    @property
    def covariance(self) -> FloatArray:
        """Of x by the curvature of the cost, shape (n, n)."""
        hessian = self.jacobian.T @ self.jacobian + np.diag(self.prior)
        return np.asarray(np.linalg.pinv(hessian, hermitian=True))

    @property
    def pulls(self) -> FloatArray:
        """Distance of the base from its sheet, in prior sd, shape (n_base,)."""
        scaled = np.sqrt(self.prior[: self.n_base])
        return np.asarray(self.base * scaled)


def split(
    x: FloatArray, n_base: int, candidates: Sequence[Candidate]
) -> tuple[Term, ...]:
    """Cut a coordinate vector into terms."""
    terms, at = [], n_base
    for candidate in candidates:
        n = len(candidate.effect.parameters)
        terms.append(Term(candidate, x[at : at + n]))
        at += n
    return tuple(terms)


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A bench with chosen effects, as a least-squares problem."""

    bench: Bench
    candidates: tuple[Candidate, ...]
    lower: FloatArray
    upper: FloatArray
    prior: FloatArray
    centre: FloatArray
    n_base: int

    def residual(self, x: FloatArray, stage: Stage) -> FloatArray:
        """Return the whitened residual at x."""
        terms = split(x, self.n_base, self.candidates)
        return self.bench.residual(x[: self.n_base], terms, stage)

    def penalty(self, x: FloatArray) -> float:
        """Return the priors' share of the cost."""
        return float(np.sum(self.prior * (x - self.centre) ** 2))


def make_problem(bench: Bench, candidates: Sequence[Candidate]) -> Problem:
    """Collect bounds and priors of base and effects."""
    n_base = bench.base_sd.size
    lower, upper = [-3.0] * n_base, [3.0] * n_base
    prior = list(1.0 / bench.base_sd**2)
    centre = [0.0] * n_base
    for candidate in candidates:
        for p in candidate.effect.parameters:
            low, high = p.bounds
            lower.append(low)
            upper.append(high)
            prior.append(0.0 if p.prior is None else 1.0 / p.prior[1] ** 2)
            centre.append(0.0 if p.prior is None else p.encode(p.prior[0]))
    return Problem(
        bench,
        tuple(candidates),
        np.array(lower),
        np.array(upper),
        np.array(prior),
        np.array(centre),
        n_base,
    )


def steps_of(problem: Problem, x: FloatArray) -> FloatArray:
    """Return the difference steps of x, turned inwards at a bound."""
    step = np.full(x.size, BASE_STEP)
    tail = slice(problem.n_base, None)
    step[tail] = 1e-4 * np.maximum(np.abs(x[tail]), 1e-2)
    return np.where(x + step > problem.upper, -step, step)


def jacobian_of(
    problem: Problem,
    x: FloatArray,
    residual: FloatArray,
    stage: Stage,
    *,
    linear_base: bool = False,
) -> FloatArray:
    """Difference the residual.

    Args:
        problem: what is fitted.
        x: where, shape (n,).
        residual: at x, shape (n_rows,).
        stage: how thoroughly.
        linear_base: take the base's columns with the effects off: cheap, and close
            enough to descend by while the step of the effects is being found.
    """
    columns = np.empty((x.size, residual.size))
    steps = steps_of(problem, x)
    plain = residual
    if linear_base:
        plain = problem.bench.residual(x[: problem.n_base], (), stage)
    for i, h in enumerate(steps):
        moved = x.copy()
        moved[i] += h
        if linear_base and i < problem.n_base:
            columns[i] = problem.bench.residual(moved[: problem.n_base], (), stage)
            columns[i] -= plain
        else:
            columns[i] = problem.residual(moved, stage)
            columns[i] -= residual
        columns[i] /= h
    return columns.T


def minimise(
    problem: Problem,
    start: FloatArray,
    stage: Stage = FULL,
    *,
    iterations: int = 20,
    give_up: float | None = None,
    linear_base: bool = False,
    jacobian_stage: Stage | None = None,
) -> Fit:
    """Descend from one start.

    Args:
        problem: what is fitted.
        start: coordinates, shape (n,).
        stage: window and step of the residual.
        iterations: at most.
        give_up: stop when three steps have not come below this cost.
        linear_base: see `jacobian_of`.
        jacobian_stage: a cheaper stage for the slopes, or None for the same.
    """

    def slopes(x: FloatArray, r: FloatArray) -> FloatArray:
        if jacobian_stage is None:
            return jacobian_of(problem, x, r, stage, linear_base=linear_base)
        coarse = problem.residual(x, jacobian_stage)
        return jacobian_of(problem, x, coarse, jacobian_stage)

    x = np.clip(start, problem.lower, problem.upper)
    r = problem.residual(x, stage)
    cost = float(r @ r) + problem.penalty(x)
    damping = 1e-3
    j = slopes(x, r)
    for k in range(iterations):
        moved, damping = _step(problem, x, r, j, cost, damping, stage)
        if moved is None:
            break
        drop = cost - moved[2]
        x, r, cost = moved
        j = slopes(x, r)
        excess = max(cost - problem_dof(problem), 0.0)
        if drop < EXCESS_TOLERANCE * excess + ABSOLUTE_TOLERANCE:
            break
        if give_up is not None and k >= 1 and cost > give_up and drop < 0.5 * cost:
            break
    return Fit(
        x, problem.n_base, problem.candidates, r, j, cost, problem.prior, problem.centre
    )


def problem_dof(problem: Problem) -> int:
    """Return the number of residuals that carry weight."""
    return problem.bench.blocks.dof


Moved = tuple[FloatArray, FloatArray, float]


def _step(
    problem: Problem,
    x: FloatArray,
    r: FloatArray,
    j: FloatArray,
    cost: float,
    damping: float,
    stage: Stage,
) -> tuple[Moved | None, float]:
    """Try ever shorter steps until one goes down."""
    hessian = j.T @ j + np.diag(problem.prior)
    gradient = j.T @ r + problem.prior * (x - problem.centre)
    free = ~(
        ((x <= problem.lower) & (gradient > 0))
        | ((x >= problem.upper) & (gradient < 0))
    )
    size = np.sqrt(np.maximum(np.diag(hessian), 1e-12))
    h = (hessian / np.outer(size, size))[np.ix_(free, free)]
    g = (gradient / size)[free]
    for _ in range(9):
        step = np.zeros(x.size)
        step[free] = -np.linalg.solve(h + damping * np.eye(h.shape[0]), g)
        trial = np.clip(
            x + np.clip(step / size, -1.5, 1.5), problem.lower, problem.upper
        )
        try_r = problem.residual(trial, stage)
        try_cost = float(try_r @ try_r) + problem.penalty(trial)
        if np.isfinite(try_cost) and try_cost < cost:
            return (trial, try_r, try_cost), max(damping / 10, 1e-9)
        damping = max(damping * 8, 1e-6)
        if damping > 1e7:
            break
    return None, damping


Stages = Sequence[tuple[Stage, int, bool]]
BASE_STAGES: Stages = (
    (Stage(0.002), 6, False),
    (Stage(0.006), 6, False),
    (Stage(0.020), 6, False),
    (FULL, 20, False),
)


def fit_stages(
    problem: Problem,
    start: FloatArray,
    stages: Stages = BASE_STAGES,
    *,
    give_up: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Fit:
    """Fit coarse to fine; the last stage decides."""
    x = start
    fit: Fit | None = None
    for stage, iterations, linear_base in stages:
        last = stage.window is None
        fit = minimise(
            problem,
            x,
            stage,
            iterations=iterations,
            linear_base=linear_base,
            give_up=give_up if last else None,
        )
        x = fit.x
        if progress is not None:
            progress(f"{stage} {fit.cost:.4g}")
    if fit is None:
        raise ValueError("at least one stage is needed")
    return fit
