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
BASE_STEP = 1e-7
"""Difference step of a logarithm. A record holds some hundred radians, so that a step
of 1e-5 would already bend its end away from the slope."""
EFFECT_STEP = 1e-6
PATIENCE = 12.0
"""Steps of the last size that a descent may still need to come down to a rival."""
LONGEST = 1.5
"""Longest step of a coordinate; most are logarithms."""
CORRECTIONS = 2
"""Steps back into the valley, by the slopes at hand, before a step is shortened."""
STIFF = 1e-3
"""Damping under which only what the data fix well moves."""
OLDEST = 2
"""Steps in a row for which slopes are updated by the secant instead of differenced."""
TRUSTED = 0.6
"""Share of the foretold drop below which the slopes are differenced again."""


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
    step[tail] = EFFECT_STEP * np.maximum(np.abs(x[tail]), 1e-2)
    return np.where(x + step > problem.upper, -step, step)


def jacobian_of(
    problem: Problem,
    x: FloatArray,
    residual: FloatArray,
    stage: Stage,
) -> FloatArray:
    """Difference the residual.

    Args:
        problem: what is fitted.
        x: where, shape (n,).
        residual: at x, shape (n_rows,).
        stage: how thoroughly.
    """
    columns = np.empty((x.size, residual.size))
    steps = steps_of(problem, x)
    for i, h in enumerate(steps):
        moved = x.copy()
        moved[i] += h
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
    rival: float | None = None,
    jacobian_stage: Stage | None = None,
    exact_slopes: bool = True,
) -> Fit:
    """Descend from one start.

    Args:
        problem: what is fitted.
        start: coordinates, shape (n,).
        stage: window and step of the residual.
        iterations: at most.
        rival: cost of the best so far; a descent that at its pace would need very
            many more steps to come there is given up.
        jacobian_stage: a cheaper stage for the slopes, or None for the same.
        exact_slopes: difference the slopes once more at the end, which an
            intermediate stage does not need.
    """

    def slopes(x: FloatArray, r: FloatArray) -> FloatArray:
        if jacobian_stage is None:
            return jacobian_of(problem, x, r, stage)
        coarse = problem.residual(x, jacobian_stage)
        return jacobian_of(problem, x, coarse, jacobian_stage)

    x = np.clip(start, problem.lower, problem.upper)
    r, cost = _looked_at(problem, x, stage)
    if not np.isfinite(cost):
        return _hopeless(problem, x, r)
    damping, age, j = 1e-6, 0, slopes(x, r)
    for k in range(iterations):
        moved, damping = _step(problem, x, r, j, cost, damping, stage)
        if moved is None:
            if age == 0:
                break
            j, age, damping = slopes(x, r), 0, 1e-3
            continue
        drop = cost - moved[2]
        small = drop < EXCESS_TOLERANCE * _excess(problem, cost) + ABSOLUTE_TOLERANCE
        guessed = _predicted_drop(problem, x, r, j, moved[0])
        change, before = moved[0] - x, r
        x, r, cost = moved
        if small and age == 0:
            break
        if rival is not None and k >= 1 and cost - rival > PATIENCE * drop:
            break
        if not small and age < OLDEST and drop > TRUSTED * guessed:
            j, age = _secant(j, change, r - before), age + 1
        else:
            j, age = slopes(x, r), 0
    if age > 0 and exact_slopes:
        j = slopes(x, r)
    return Fit(
        x, problem.n_base, problem.candidates, r, j, cost, problem.prior, problem.centre
    )


def _hopeless(problem: Problem, x: FloatArray, r: FloatArray) -> Fit:
    """Return the fit of a start at which the model runs away."""
    return Fit(
        x,
        problem.n_base,
        problem.candidates,
        np.full_like(r, np.inf),
        np.zeros((r.size, x.size)),
        np.inf,
        problem.prior,
        problem.centre,
    )


def _excess(problem: Problem, cost: float) -> float:
    return max(cost - problem_dof(problem), 0.0)


def _predicted_drop(
    problem: Problem, x: FloatArray, r: FloatArray, j: FloatArray, moved: FloatArray
) -> float:
    """Return the drop of the cost that the linear model foretold."""
    left = r + j @ (moved - x)
    return float(r @ r - left @ left + problem.penalty(x) - problem.penalty(moved))


def _secant(j: FloatArray, change: FloatArray, difference: FloatArray) -> FloatArray:
    """Update slopes by what a step has shown, at the price of no evaluation.

    Source:
        Broyden 1965, Math. Comp. 19, 577, eq. (4.5), with parameters scaled by the
        norm of their columns.
    """
    along = np.einsum("ij,ij->j", j, j) * change
    return j + np.outer(difference - j @ change, along / (change @ along))


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
    """Try ever shorter steps until one goes down.

    Effects hand stiffness and damping to the base and back, so their valleys are long
    and curved. A step that climbed a wall is first led back down by what the data fix
    well, with the slopes at hand, and only then shortened.
    """
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
        step[free] = -_solve(h + damping * np.eye(h.shape[0]), g)
        trial = _moved(problem, x, step / size)
        try_r, try_cost = _looked_at(problem, trial, stage)
        for _ in range(CORRECTIONS):
            if try_cost < cost or not np.isfinite(try_cost):
                break
            pull = j.T @ try_r + problem.prior * (trial - problem.centre)
            stiff = h + STIFF * np.eye(h.shape[0])
            step[free] = -_solve(stiff, (pull / size)[free])
            trial = _moved(problem, trial, step / size)
            try_r, try_cost = _looked_at(problem, trial, stage)
        if np.isfinite(try_cost) and try_cost < cost:
            return (trial, try_r, try_cost), max(damping / 10, 1e-9)
        damping = max(damping * 8, 1e-6)
        if damping > 1e7:
            break
    return None, damping


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve, or return the least of all solutions where two parameters are one."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-14)[0])


def _moved(problem: Problem, x: FloatArray, step: FloatArray) -> FloatArray:
    bounded = np.clip(step, -LONGEST, LONGEST)
    return np.clip(x + bounded, problem.lower, problem.upper)


def cost_at(problem: Problem, x: FloatArray, stage: Stage) -> float:
    """Return the cost at x, infinite where the model runs away."""
    return _looked_at(problem, x, stage)[1]


def _looked_at(
    problem: Problem, x: FloatArray, stage: Stage
) -> tuple[FloatArray, float]:
    with np.errstate(all="ignore"):
        try:
            r = problem.residual(x, stage)
        except np.linalg.LinAlgError:  # a model whose modes cannot be told apart
            return np.full(problem.bench.blocks.group.size, np.inf), np.inf
        cost = float(r @ r) + problem.penalty(x)
    return r, cost if np.isfinite(cost) else np.inf


Stages = Sequence[tuple[Stage, int]]
BASE_STAGES: Stages = (
    (Stage(0.002), 6),
    (Stage(0.006), 6),
    (Stage(0.020), 6),
    (FULL, 20),
)


def fit_stages(
    problem: Problem,
    start: FloatArray,
    stages: Stages = BASE_STAGES,
    *,
    rival: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Fit:
    """Fit coarse to fine; the last stage decides."""
    x = start
    fit: Fit | None = None
    for stage, iterations in stages:
        last = stage.window is None
        fit = minimise(
            problem,
            x,
            stage,
            iterations=iterations,
            rival=rival if last else None,
            exact_slopes=last,
        )
        x = fit.x
        if progress is not None:
            progress(f"{stage} {fit.cost:.4g}")
    if fit is None:
        raise ValueError("at least one stage is needed")
    return fit
