# SPDX-License-Identifier: MIT
"""The race of the candidates: joint refits, coarse to fine, the hopeless dropped."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.bench import FINE, FULL, Bench, Stage
from jointbench.analysis.gap.effects import Candidate, Term
from jointbench.analysis.gap.fit import (
    BASE_STAGES,
    Fit,
    Problem,
    make_problem,
    minimise,
)
from jointbench.analysis.gap.screening import Direction, Screening

Progress = Callable[[str], None]

COST_PER_PARAMETER = 10.0
"""Chi2 that one more parameter must earn: far above chance, far below any name."""
COST_PER_PHASE = 2.0
COARSE_ROUNDS: tuple[tuple[Stage, int], ...] = (
    (Stage(0.005, 2), 5),
    (Stage(0.016, 2), 6),
)
MIDDLE = Stage(oversampling=2)
SURVIVORS = (12, 8)
FINALISTS = 5
HOPELESS = 6.0
"""Cost over the best's above which a finalist is not fitted to the end."""
HUGE = 100.0
"""Chi2 over dof of the base above which a flipped sign is worth a start."""
SWAP_PROBE = 1e-4
EVERYDAY = 1.3
"""Chi2 over dof of the base above which the effect is no small perturbation."""


@dataclass(frozen=True, slots=True, eq=False)
class Runner:
    """One start of one candidate set, as far as it has come."""

    problem: Problem
    x: FloatArray
    cost: float
    fit: Fit | None = None

    @property
    def label(self) -> str:
        """The candidates in words, in an order of their own."""
        return " + ".join(sorted(c.label for c in self.problem.candidates))


def score(bench: Bench, fit: Fit) -> float:
    """Return the cost of a fit with a charge for every parameter."""
    charge = 0.0
    for candidate in fit.candidates:
        charge += COST_PER_PARAMETER * len(candidate.effect.parameters)
        charge += COST_PER_PHASE * bench.phases(candidate)
    return fit.cost + charge


def race(
    bench: Bench,
    fit: Fit,
    screening: Screening,
    candidates: Sequence[Candidate],
    progress: Progress,
) -> list[Fit]:
    """Fit base plus one more effect for every candidate worth it.

    Args:
        bench: measurement and model.
        fit: what the candidates are added to.
        screening: directed tests of that fit.
        candidates: what to try.
        progress: told what is being tried.

    Returns:
        One fit for each candidate that came far enough, best score first.
    """
    everyday = fit.chi2 > EVERYDAY * bench.blocks.dof
    runners = _starters(bench, fit, screening, candidates, progress, everyday=everyday)
    if everyday:
        for (stage, iterations), keep in zip(COARSE_ROUNDS, SURVIVORS, strict=True):
            runners = [_run(r, stage, iterations, progress) for r in runners]
            runners = _keep(runners, keep)
        runners = _best_of_each(runners)
    limit, done = np.inf, []
    for r in runners:
        progress(r.label)
        middle = minimise(r.problem, r.x, MIDDLE, iterations=8, give_up=limit)
        done.append(Runner(r.problem, middle.x, middle.cost, middle))
        limit = min(limit, HOPELESS * middle.cost)
    runners = _keep(_best_of_each(done), FINALISTS)
    limit = np.inf
    fits = []
    for r in runners:
        if r.fit is None or r.cost > limit:
            fits += [] if r.fit is None else [r.fit]
            continue
        fits.append(finish(bench, r.problem, r.x, progress))
        limit = min(limit, HOPELESS * fits[-1].cost)
    return sorted(fits, key=lambda f: score(bench, f))


def finish(bench: Bench, problem: Problem, x: FloatArray, progress: Progress) -> Fit:
    """Fit to the end at the finest step."""
    progress(" + ".join(c.label for c in problem.candidates) + " (fine)")
    families = {c.effect.family for c in problem.candidates if c.site.kind == "link"}
    if "friction" in families:
        return minimise(problem, x, FULL, iterations=6, jacobian_stage=MIDDLE)
    if families & {"stiffness", "contact", "damping"}:
        return minimise(problem, x, FINE, iterations=6, jacobian_stage=FULL)
    return minimise(problem, x, FULL, iterations=8)


def _starters(
    bench: Bench,
    fit: Fit,
    screening: Screening,
    candidates: Sequence[Candidate],
    progress: Progress,
    *,
    everyday: bool,
) -> list[Runner]:
    runners: list[Runner] = []
    best = max(screening.largest, 1e-9)
    for candidate in candidates:
        directions = screening.best(candidate, 2 if everyday else 1)
        problem = make_problem(bench, (*fit.candidates, candidate))
        for d in directions:
            if not everyday and d.drop < 0.15 * best and not candidate.effect.by_prior:
                continue
            runners.append(_runner(problem, np.concatenate([fit.x, d.coordinates])))
        if candidate.effect.by_prior:
            runners.append(_runner(problem, swapped(bench, fit, candidate)))
        elif candidate.effect.refit_nominal and fit.chi2 > HUGE * bench.blocks.dof:
            progress(f"{candidate.label} from the sheet")
            runners.append(_from_nominal(problem, fit, directions))
    return runners


def _runner(problem: Problem, x: FloatArray) -> Runner:
    return Runner(problem, np.clip(x, problem.lower, problem.upper), np.inf)


def swapped(bench: Bench, fit: Fit, candidate: Candidate) -> FloatArray:
    """Start where an effect hands back to the base what the base took of it.

    An added mass is exactly a larger mass: along such a direction only the priors
    change, and the amplitude at which they are happiest follows in one step.
    """
    first = candidate.effect.parameters[0]
    plain = bench.residual(fit.base, fit.terms, MIDDLE)
    tail = np.array([SWAP_PROBE])
    moved = bench.residual(fit.base, (*fit.terms, Term(candidate, tail)), MIDDLE)
    d = (moved - plain) / SWAP_PROBE
    hessian = fit.jacobian.T @ fit.jacobian + 1e-6 * np.diag(fit.prior)
    along = -np.linalg.solve(hessian, fit.jacobian.T @ d)
    off = fit.x - fit.centre
    amplitude = -float(off @ (fit.prior * along)) / float(along @ (fit.prior * along))
    amplitude = float(np.clip(amplitude, *first.bounds))
    step = np.clip(along * amplitude, -0.5, 0.5)
    return np.concatenate([fit.x + step, [amplitude]])


def _from_nominal(
    problem: Problem, fit: Fit, directions: Sequence[Direction]
) -> Runner:
    """Start from the nominal sheet: the base has lost its way."""
    start = np.zeros_like(fit.x)
    start[fit.n_base :] = fit.x[fit.n_base :]
    tail = directions[0].coordinates if directions else np.zeros(1)
    x = np.concatenate([start, tail])
    for stage, iterations, _ in BASE_STAGES[:-1]:
        x = minimise(problem, x, stage, iterations=iterations).x
    return _runner(problem, x)


def _run(runner: Runner, stage: Stage, iterations: int, progress: Progress) -> Runner:
    progress(runner.label)
    fit = minimise(runner.problem, runner.x, stage, iterations=iterations)
    return Runner(runner.problem, fit.x, fit.cost, fit)


def _best_of_each(runners: Sequence[Runner]) -> list[Runner]:
    best: dict[str, Runner] = {}
    for r in sorted(runners, key=lambda r: r.cost):
        best.setdefault(r.label, r)
    return list(best.values())


def _keep(runners: Sequence[Runner], count: int) -> list[Runner]:
    return sorted(runners, key=lambda r: r.cost)[:count]


__all__ = ["finish", "race", "score"]
