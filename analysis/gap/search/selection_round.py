# SPDX-License-Identifier: MIT
"""Selection rounds: joint fits of all candidates, pruned from coarse to fine."""

from collections.abc import Callable, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term, words_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FINE,
    FULL,
    MIDDLE,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.slopes import along_columns, curvature
from jointbench.analysis.gap.search.candidate_starts import (
    MOST_STEPS,
    CandidateFit,
    along,
)
from jointbench.analysis.gap.search.descent import (
    BASE_RESOLUTIONS,
    chi2_between,
    cost_at,
    minimise,
)
from jointbench.analysis.gap.search.screening import Direction, Screening
from jointbench.analysis.gap.search.search_settings import SEARCH

Progress = Callable[[str], None]

_COARSE_ROUNDS: tuple[tuple[Resolution, int], ...] = (
    (
        Resolution(SEARCH.short_window, SEARCH.screening_steps),
        SEARCH.coarse_iterations[0],
    ),
    (
        Resolution(SEARCH.longer_window, SEARCH.screening_steps),
        SEARCH.coarse_iterations[1],
    ),
)
HUGE = SEARCH.nominal_restart_chi2
STARTS = SEARCH.shape_starts


def score(bench: Bench, fit: Fit) -> float:
    """Return the score of a fit: its cost plus a charge for each parameter.

    A law that contains a simpler one of the catalogue is charged as much as separates
    rivals, so that it is named only where the simpler one explains clearly less.
    """
    charge, policy = 0.0, bench.policy
    for candidate in fit.candidates:
        charge += policy.parameter_charge * len(candidate.effect.parameters)
        charge += policy.phase_charge * bench.phases(candidate)
        if candidate.effect.generalises:
            charge += policy.rival_score
    return fit.cost + charge


def run_selection(
    bench: Bench,
    fit: Fit,
    screening: Screening,
    candidates: Sequence[Candidate],
    progress: Progress,
) -> list[Fit]:
    """Fit the base with one more effect, for each promising candidate.

    Args:
        bench: measurement and model.
        fit: fit that the candidates are added to.
        screening: directed tests of that fit.
        candidates: to be fitted.
        progress: receives the label of each candidate.

    Returns:
        One fit for each candidate that was not pruned, best score first.
    """
    candidate_fits = _near(bench, fit, screening, candidates)
    if fit.chi2 > bench.policy.far_chi2 * bench.blocks.dof:
        candidate_fits += _far(bench, fit, screening, candidates, progress)
    return _run_rounds(bench, candidate_fits, progress)


def continue_selection(
    bench: Bench, fits: Sequence[Fit], progress: Progress
) -> list[Fit]:
    """Continue fits of a shorter window over the whole records.

    Args:
        bench: measurement and model.
        fits: starts.
        progress: receives the label of each candidate.

    Returns:
        One fit for each start that was not pruned, best score first.
    """
    problems = [make_problem(bench, f.candidates) for f in fits]
    candidate_fits = [
        CandidateFit(p, f.x, cost_at(p, f.x, MIDDLE))
        for p, f in zip(problems, fits, strict=True)
    ]
    return _run_rounds(bench, candidate_fits, progress)


def _run_rounds(
    bench: Bench, candidate_fits: list[CandidateFit], progress: Progress
) -> list[Fit]:
    """Run all selection rounds, and fit the remaining candidates to the end."""
    for iterations, keep, alike in SEARCH.selection_rounds:
        candidate_fits = _best_of_each(
            _keep(_round(candidate_fits, iterations, progress), keep), alike
        )
        candidate_fits = _without_pruned(bench, candidate_fits)
    best: float | None = None
    done: list[CandidateFit] = []
    for r in candidate_fits:
        progress(_trying(r, done))
        middle = minimise(r.problem, r.x, MIDDLE, iterations=MOST_STEPS, rival=best)
        done.append(CandidateFit(r.problem, middle.x, middle.cost, middle))
        best = min(best or np.inf, middle.cost)
    candidate_fits = _keep(done, SEARCH.final_fits)
    hopeful = [
        r
        for r in candidate_fits
        if r.cost < SEARCH.pruning_ratio * candidate_fits[0].cost
    ]
    fits = [finish(r.problem, r.x, progress) for r in hopeful]
    fits += [r.fit for r in candidate_fits if r not in hopeful and r.fit is not None]
    return sorted(fits, key=lambda f: score(bench, f))


def _without_pruned(
    bench: Bench, candidate_fits: Sequence[CandidateFit]
) -> list[CandidateFit]:
    """Drop starts far above one that explains the records.

    Some rivals are kept for the ranking, and so are laws of the best one's family:
    they may follow the same loop and converge slowly.
    """
    best = candidate_fits[0] if candidate_fits else None
    explained = SEARCH.explained_chi2 * bench.blocks.dof
    if best is None or best.cost > explained:
        return list(candidate_fits)
    family = best.problem.candidates[-1].effect.family
    return [
        r
        for k, r in enumerate(candidate_fits)
        if k < SEARCH.rivals_kept
        or r.cost < SEARCH.round_pruning_ratio * best.cost
        or r.problem.candidates[-1].effect.family == family
    ]


def finish(
    problem: FitProblem,
    x: FloatArray,
    progress: Progress,
) -> Fit:
    """Fit to convergence, at the step size that the start requires."""
    resolution = _step_for(problem, x)
    progress(f"{words_of(problem.candidates)} (fine)")
    if any(c.effect.integrated for c in problem.candidates if c.site.kind == "link"):
        return minimise(
            problem, x, resolution, iterations=8, jacobian_resolution=MIDDLE
        )
    return minimise(problem, x, resolution, iterations=8)


def _step_for(problem: FitProblem, x: FloatArray) -> Resolution:
    """Return eight steps per sample if the error of four exceeds the noise.

    Four steps are too few for a stop of 75,000 times the noise, and a second law would
    compensate the error.
    """
    return (
        FINE
        if chi2_between(problem, x, FULL, FINE) > SEARCH.integration_error
        else FULL
    )


def _round(
    candidate_fits: Sequence[CandidateFit], iterations: int, progress: Progress
) -> list[CandidateFit]:
    """Run some steps of every start, best first, as a reference for slow ones."""
    best: float | None = None
    done: list[CandidateFit] = []
    for r in _keep(candidate_fits, len(candidate_fits)):
        progress(_trying(r, done))
        done.append(_run(r, MIDDLE, iterations, rival=best))
        best = min(best or np.inf, done[-1].cost)
    return done


def _near(
    bench: Bench, fit: Fit, screening: Screening, candidates: Sequence[Candidate]
) -> list[CandidateFit]:
    """Return starts predicted by the directed tests, on the whole records."""
    candidate_fits: list[CandidateFit] = []
    least = SEARCH.least_drop_share * max(screening.largest, 1e-9)
    for candidate in candidates:
        problem = make_problem(bench, (*fit.candidates, candidate))
        shaped = len(candidate.effect.parameters) > 2
        for d in screening.best(candidate, STARTS if shaped else 1):
            if d.drop >= least:
                candidate_fits.append(along(problem, fit, d, MIDDLE))
        if candidate.effect.by_prior:
            x = np.clip(_swapped(bench, fit, candidate), problem.lower, problem.upper)
            candidate_fits.append(CandidateFit(problem, x, cost_at(problem, x, MIDDLE)))
    return [r for r in candidate_fits if np.isfinite(r.cost)]


def _far(
    bench: Bench,
    fit: Fit,
    screening: Screening,
    candidates: Sequence[Candidate],
    progress: Progress,
) -> list[CandidateFit]:
    """Return starts far from the base, from fits under short windows.

    Under a short window, a misplaced resonance changes the cost smoothly.
    """
    candidate_fits: list[CandidateFit] = []
    for candidate in candidates:
        problem = make_problem(bench, (*fit.candidates, candidate))
        directions = screening.best(candidate, 2)
        candidate_fits += [
            along(problem, fit, d, _COARSE_ROUNDS[0][0]) for d in directions
        ]
        for amplitude in candidate.effect.parameters[0].far:
            x = np.concatenate([fit.x, [amplitude]])
            candidate_fits.append(_started(problem, x))
        if candidate.effect.refit_nominal and fit.chi2 > HUGE * bench.blocks.dof:
            progress(f"{candidate.label} from nominal values")
            candidate_fits.append(_from_nominal(problem, fit, directions))
    for (resolution, iterations), keep in zip(
        _COARSE_ROUNDS, SEARCH.coarse_survivors, strict=True
    ):
        done: list[CandidateFit] = []
        for r in candidate_fits:
            progress(_trying(r, done))
            done.append(_run(r, resolution, iterations, rival=_last_kept(done, keep)))
        candidate_fits = _keep(done, keep)
    return candidate_fits


def _last_kept(done: Sequence[CandidateFit], count: int) -> float | None:
    """Return the cost that a start must reach to be kept; None while all are."""
    costs = sorted(r.cost for r in done)
    return costs[count - 1] if len(costs) >= count else None


def _candidate_fit(problem: FitProblem, x: FloatArray) -> CandidateFit:
    return CandidateFit(problem, np.clip(x, problem.lower, problem.upper), np.inf)


def _started(problem: FitProblem, x: FloatArray) -> CandidateFit:
    resolution = _COARSE_ROUNDS[0][0]
    fit = minimise(problem, x, resolution, iterations=4, exact_slopes=False)
    return CandidateFit(problem, fit.x, fit.cost)


def _swapped(bench: Bench, fit: Fit, candidate: Candidate) -> FloatArray:
    """Return a start at which an effect takes over its share from the base.

    An added mass is equivalent to a larger mass: along such a direction only the priors
    change, and their optimal amplitude follows in one step.
    """
    first = candidate.effect.parameters[0]
    plain = bench.residual(fit.base, fit.terms, MIDDLE)
    tail = np.array([SEARCH.exchange_probe])
    moved = bench.residual(fit.base, (*fit.terms, Term(candidate, tail)), MIDDLE)
    d = (moved - plain) / SEARCH.exchange_probe
    hessian = curvature(fit.jacobian) + 1e-6 * np.diag(fit.prior)
    # A parameter that changes no record, of an effect beyond its threshold, stays.
    alive = np.diag(hessian) > 0.0
    way = np.zeros_like(fit.x)
    way[alive] = -np.linalg.solve(
        hessian[np.ix_(alive, alive)], along_columns(fit.jacobian, d)[alive]
    )
    off = fit.x - fit.centre
    amplitude = -float(off @ (fit.prior * way)) / float(way @ (fit.prior * way))
    amplitude = float(np.clip(amplitude, *first.bounds))
    step = np.clip(way * amplitude, -0.5, 0.5)
    return np.concatenate([fit.x + step, [amplitude]])


def _from_nominal(
    problem: FitProblem, fit: Fit, directions: Sequence[Direction]
) -> CandidateFit:
    """Return a start from the nominal parameters, for a diverged base."""
    start = np.zeros_like(fit.x)
    start[fit.n_base :] = fit.x[fit.n_base :]
    tail = directions[0].coordinates if directions else np.zeros(1)
    x = np.concatenate([start, tail])
    for resolution, iterations in BASE_RESOLUTIONS[:-1]:
        x = minimise(
            problem, x, resolution, iterations=iterations, exact_slopes=False
        ).x
    return _candidate_fit(problem, x)


def _trying(candidate_fit: CandidateFit, done: Sequence[CandidateFit]) -> str:
    """Return the label of the current candidate and of the best so far."""
    if not done:
        return candidate_fit.label
    best = min(done, key=lambda r: r.cost)
    return f"{candidate_fit.label}; best so far: {best.label}"


def _run(
    candidate_fit: CandidateFit,
    resolution: Resolution,
    iterations: int,
    rival: float | None = None,
) -> CandidateFit:
    fit = minimise(
        candidate_fit.problem,
        candidate_fit.x,
        resolution,
        iterations=iterations,
        rival=rival,
        exact_slopes=False,
    )
    return CandidateFit(candidate_fit.problem, fit.x, fit.cost, fit)


def _best_of_each(
    candidate_fits: Sequence[CandidateFit], count: int
) -> list[CandidateFit]:
    """Return the best starts of each set of effects, best first."""
    kept: list[CandidateFit] = []
    for r in sorted(candidate_fits, key=lambda r: r.cost):
        if sum(k.label == r.label for k in kept) < count:
            kept.append(r)
    return kept


def _keep(candidate_fits: Sequence[CandidateFit], count: int) -> list[CandidateFit]:
    return sorted(
        (r for r in candidate_fits if np.isfinite(r.cost)), key=lambda r: r.cost
    )[:count]
