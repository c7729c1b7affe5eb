# SPDX-License-Identifier: MIT
"""Second starts: fits with a diverged base start again from a better base."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, words_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import MOST_STEPS
from jointbench.analysis.gap.search.descent import cost_at, minimise
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.selection_round import Progress, finish


def crossed(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Start diverged fits again from the base of the best fit.

    While only one of two large effects is fitted, the base moves far from its nominal
    parameters. The second effect is then added at that base, where a correct pair can
    end with a higher cost than a wrong one.

    Args:
        bench: measurement and model.
        fits: each with the same number of effects, best first.
        progress: receives the label of each candidate.

    Returns:
        The fits, each the better one of before and after.
    """
    return [_again(bench, f, fits[0], progress) if k else f for k, f in enumerate(fits)]


def other_sliders(bench: Bench, fit: Fit, progress: Progress) -> list[Fit]:
    """Fit other slider laws from the final parameters of a fit with one.

    Their costs have many minima in stiffness and slip, so the correct law may stop at a
    far higher cost than an imitation. Stiffness and slip of these laws differ only by
    a factor: an Iwan element slips between half and all of its largest slip.

    Args:
        bench: measurement and model.
        fit: of one effect.
        progress: receives the label of each candidate.

    Returns:
        Fits with a cost as low as the given one; none if its effect has no sliders.
    """
    own = fit.candidates[0]
    if len(fit.candidates) > 1 or not own.effect.has_sliders:
        return []
    alike = [
        c
        for c in bench.candidates
        if c.effect.has_sliders and c.site == own.site and c != own
    ]
    found = []
    for candidate in alike:
        progress(f"{candidate.label} (from {own.effect.name})")
        problem = make_problem(bench, (candidate,))
        costs = {}
        for factor in SEARCH.slip_factors:
            x = _slider_start(fit, candidate, factor)
            x = np.clip(x, problem.lower, problem.upper)
            costs[cost_at(problem, x, MIDDLE)] = x
        x = costs[min(costs)]
        middle = minimise(problem, x, MIDDLE, iterations=MOST_STEPS, rival=fit.cost)
        if middle.cost < fit.cost + SEARCH.slider_cost_above:
            found.append(finish(problem, middle.x, progress))
    return found


def _slider_start(fit: Fit, candidate: Candidate, factor: float) -> FloatArray:
    """Return start coordinates of another slider law from those of a fit."""
    stiffness, slip = fit.terms[0].coordinates[:2]
    shape = [p.encode(p.starts[0]) for p in candidate.effect.parameters[2:]]
    return np.array([*fit.base, stiffness, slip + np.log(factor), *shape])


def caught_up(bench: Bench, fit: Fit, best: Fit, progress: Progress) -> Fit:
    """Fit again with the noise estimated at the best fit, from the better start.

    Args:
        bench: with the noise of the best fit.
        fit: found with another noise estimate.
        best: the best fit.
        progress: receives the label of each candidate.
    """
    problem = make_problem(bench, fit.candidates)
    borrowed = np.clip(_borrowed(fit, best), problem.lower, problem.upper)
    starts = (fit.x, borrowed)
    costs = [cost_at(problem, x, MIDDLE) for x in starts]
    return finish(problem, starts[int(np.argmin(costs))], progress)


def _again(bench: Bench, fit: Fit, best: Fit, progress: Progress) -> Fit:
    """Return the better of a fit and a refit from the base of the best fit."""
    deviation, least = (
        np.abs(fit.prior_deviations).max(),
        np.abs(best.prior_deviations).max(),
    )
    if deviation < SEARCH.diverged_sd or deviation < least:
        return fit
    problem = make_problem(bench, fit.candidates)
    start = np.clip(_borrowed(fit, best), problem.lower, problem.upper)
    if cost_at(problem, start, MIDDLE) > _least_promising_cost(fit, best):
        return fit
    progress(f"{words_of(fit.candidates)} (again)")
    middle = minimise(problem, start, MIDDLE, iterations=MOST_STEPS, rival=best.cost)
    if middle.cost > SEARCH.restart_share * fit.cost:
        return fit
    return finish(problem, middle.x, progress)


def _least_promising_cost(fit: Fit, best: Fit) -> float:
    """Return the cost above which a start is not used."""
    return SEARCH.restart_cost_ratio * max(fit.cost, best.cost)


def _borrowed(fit: Fit, best: Fit) -> FloatArray:
    """Return coordinates of a fit with base and common effects of the best fit."""
    known = {t.candidate.label: t.coordinates for t in best.terms}
    own = [known.get(t.candidate.label, t.coordinates) for t in fit.terms]
    return np.concatenate([best.base, *own])
