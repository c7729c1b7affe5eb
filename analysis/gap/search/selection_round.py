# SPDX-License-Identifier: MIT
"""The race of the candidates: joint refits, coarse to fine, the hopeless dropped."""

from collections.abc import Callable, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term, words_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_stages import (
    FINE,
    FULL,
    MIDDLE,
    Stage,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.search.descent import (
    BASE_STAGES,
    chi2_between,
    cost_at,
    minimise,
)
from jointbench.analysis.gap.search.race_starts import MOST_STEPS, Runner, along
from jointbench.analysis.gap.search.screening import Direction, Screening
from jointbench.analysis.gap.search.search_settings import SEARCH

Progress = Callable[[str], None]

_COARSE_ROUNDS: tuple[tuple[Stage, int], ...] = (
    (Stage(SEARCH.short_window, SEARCH.screening_steps), SEARCH.coarse_iterations[0]),
    (Stage(SEARCH.longer_window, SEARCH.screening_steps), SEARCH.coarse_iterations[1]),
)
HUGE = SEARCH.nominal_restart_chi2
STARTS = SEARCH.shape_starts


def score(bench: Bench, fit: Fit) -> float:
    """Return the cost of a fit with a charge for every parameter."""
    charge, policy = 0.0, bench.policy
    for candidate in fit.candidates:
        charge += policy.parameter_charge * len(candidate.effect.parameters)
        charge += policy.phase_charge * bench.phases(candidate)
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
    runners = _near(bench, fit, screening, candidates)
    if fit.chi2 > bench.policy.far_chi2 * bench.blocks.dof:
        runners += _far(bench, fit, screening, candidates, progress)
    return _run_out(bench, runners, progress)


def race_on(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Race fits of a shorter window over the whole records.

    Args:
        bench: measurement and model.
        fits: where to start from.
        progress: told what is being tried.

    Returns:
        One fit for each that came far enough, best score first.
    """
    problems = [make_problem(bench, f.candidates) for f in fits]
    runners = [
        Runner(p, f.x, cost_at(p, f.x, MIDDLE))
        for p, f in zip(problems, fits, strict=True)
    ]
    return _run_out(bench, runners, progress)


def _run_out(bench: Bench, runners: list[Runner], progress: Progress) -> list[Fit]:
    """Run starts to the end, the hopeless dropped on the way."""
    for iterations, keep, alike in SEARCH.selection_rounds:
        runners = _best_of_each(
            _keep(_heat(runners, iterations, progress), keep), alike
        )
    best: float | None = None
    done: list[Runner] = []
    for r in runners:
        progress(_trying(r, done))
        middle = minimise(r.problem, r.x, MIDDLE, iterations=MOST_STEPS, rival=best)
        done.append(Runner(r.problem, middle.x, middle.cost, middle))
        best = min(best or np.inf, middle.cost)
    runners = _keep(done, SEARCH.final_fits)
    hopeful = [r for r in runners if r.cost < SEARCH.pruning_ratio * runners[0].cost]
    fits = [finish(r.problem, r.x, progress) for r in hopeful]
    fits += [r.fit for r in runners if r not in hopeful and r.fit is not None]
    return sorted(fits, key=lambda f: score(bench, f))


def finish(
    problem: FitProblem,
    x: FloatArray,
    progress: Progress,
) -> Fit:
    """Fit to the end, at the step that the march of its start needs."""
    stage = _step_for(problem, x)
    progress(f"{words_of(problem.candidates)} (fine)")
    families = {c.effect.family for c in problem.candidates if c.site.kind == "link"}
    if families & {"friction", "stiffness", "contact", "damping"}:
        return minimise(problem, x, stage, iterations=8, jacobian_stage=MIDDLE)
    return minimise(problem, x, stage, iterations=8)


def _step_for(problem: FitProblem, x: FloatArray) -> Stage:
    """Return eight steps a sample where four err by more than the noise hides.

    A stop of 75,000 times the noise is marched too coarsely by four, and a second law
    makes up for the error.
    """
    return (
        FINE
        if chi2_between(problem, x, FULL, FINE) > SEARCH.integration_error
        else FULL
    )


def _heat(
    runners: Sequence[Runner], iterations: int, progress: Progress
) -> list[Runner]:
    """Let all take some steps, best first, so that the slow see whom to catch."""
    best: float | None = None
    done: list[Runner] = []
    for r in _keep(runners, len(runners)):
        progress(_trying(r, done))
        done.append(_run(r, MIDDLE, iterations, rival=best))
        best = min(best or np.inf, done[-1].cost)
    return done


def _near(
    bench: Bench, fit: Fit, screening: Screening, candidates: Sequence[Candidate]
) -> list[Runner]:
    """Start where the directed tests point to, on the whole record."""
    runners: list[Runner] = []
    least = SEARCH.least_drop_share * max(screening.largest, 1e-9)
    for candidate in candidates:
        problem = make_problem(bench, (*fit.candidates, candidate))
        shaped = len(candidate.effect.parameters) > 2
        for d in screening.best(candidate, STARTS if shaped else 1):
            if d.drop >= least:
                runners.append(along(problem, fit, d, MIDDLE))
        if candidate.effect.by_prior:
            x = np.clip(_swapped(bench, fit, candidate), problem.lower, problem.upper)
            runners.append(Runner(problem, x, cost_at(problem, x, MIDDLE)))
    return [r for r in runners if np.isfinite(r.cost)]


def _far(
    bench: Bench,
    fit: Fit,
    screening: Screening,
    candidates: Sequence[Candidate],
    progress: Progress,
) -> list[Runner]:
    """Start far off, under short windows that forgive a misplaced resonance."""
    runners: list[Runner] = []
    for candidate in candidates:
        problem = make_problem(bench, (*fit.candidates, candidate))
        directions = screening.best(candidate, 2)
        runners += [along(problem, fit, d, _COARSE_ROUNDS[0][0]) for d in directions]
        for amplitude in candidate.effect.parameters[0].far:
            x = np.concatenate([fit.x, [amplitude]])
            runners.append(_started(problem, x))
        if candidate.effect.refit_nominal and fit.chi2 > HUGE * bench.blocks.dof:
            progress(f"{candidate.label} from nominal values")
            runners.append(_from_nominal(problem, fit, directions))
    for (stage, iterations), keep in zip(
        _COARSE_ROUNDS, SEARCH.coarse_survivors, strict=True
    ):
        done: list[Runner] = []
        for r in runners:
            progress(_trying(r, done))
            done.append(_run(r, stage, iterations))
        runners = _keep(done, keep)
    return runners


def _runner(problem: FitProblem, x: FloatArray) -> Runner:
    return Runner(problem, np.clip(x, problem.lower, problem.upper), np.inf)


def _started(problem: FitProblem, x: FloatArray) -> Runner:
    stage = _COARSE_ROUNDS[0][0]
    fit = minimise(problem, x, stage, iterations=4, exact_slopes=False)
    return Runner(problem, fit.x, fit.cost)


def _swapped(bench: Bench, fit: Fit, candidate: Candidate) -> FloatArray:
    """Start where an effect hands back to the base what the base took of it.

    An added mass is exactly a larger mass: along such a direction only the priors
    change, and the amplitude at which they are happiest follows in one step.
    """
    first = candidate.effect.parameters[0]
    plain = bench.residual(fit.base, fit.terms, MIDDLE)
    tail = np.array([SEARCH.exchange_probe])
    moved = bench.residual(fit.base, (*fit.terms, Term(candidate, tail)), MIDDLE)
    d = (moved - plain) / SEARCH.exchange_probe
    hessian = fit.jacobian.T @ fit.jacobian + 1e-6 * np.diag(fit.prior)
    way = -np.linalg.solve(hessian, fit.jacobian.T @ d)
    off = fit.x - fit.centre
    amplitude = -float(off @ (fit.prior * way)) / float(way @ (fit.prior * way))
    amplitude = float(np.clip(amplitude, *first.bounds))
    step = np.clip(way * amplitude, -0.5, 0.5)
    return np.concatenate([fit.x + step, [amplitude]])


def _from_nominal(
    problem: FitProblem, fit: Fit, directions: Sequence[Direction]
) -> Runner:
    """Start from the nominal sheet: the base has lost its way."""
    start = np.zeros_like(fit.x)
    start[fit.n_base :] = fit.x[fit.n_base :]
    tail = directions[0].coordinates if directions else np.zeros(1)
    x = np.concatenate([start, tail])
    for stage, iterations in BASE_STAGES[:-1]:
        x = minimise(problem, x, stage, iterations=iterations, exact_slopes=False).x
    return _runner(problem, x)


def _trying(runner: Runner, done: Sequence[Runner]) -> str:
    """Name the candidate of the moment, and the best so far."""
    if not done:
        return runner.label
    best = min(done, key=lambda r: r.cost)
    return f"{runner.label}; best so far: {best.label}"


def _run(
    runner: Runner,
    stage: Stage,
    iterations: int,
    rival: float | None = None,
) -> Runner:
    fit = minimise(
        runner.problem,
        runner.x,
        stage,
        iterations=iterations,
        rival=rival,
        exact_slopes=False,
    )
    return Runner(runner.problem, fit.x, fit.cost, fit)


def _best_of_each(runners: Sequence[Runner], count: int) -> list[Runner]:
    """Return the best starts of each set of effects, the best first."""
    kept: list[Runner] = []
    for r in sorted(runners, key=lambda r: r.cost):
        if sum(k.label == r.label for k in kept) < count:
            kept.append(r)
    return kept


def _keep(runners: Sequence[Runner], count: int) -> list[Runner]:
    return sorted((r for r in runners if np.isfinite(r.cost)), key=lambda r: r.cost)[
        :count
    ]
