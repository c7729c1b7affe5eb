# SPDX-License-Identifier: MIT
"""Second starts: fits whose base has lost its way start again from a better one."""

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
    """Let fits that went astray start again from the base of the best.

    Two great effects drag the base with them while only one of them is fitted. The
    second comes in far from the sheet, and there a pair that is right can end behind
    one that is wrong.

    Args:
        bench: measurement and model.
        fits: of as many effects each, best first.
        progress: told what is being tried.

    Returns:
        The fits, each the better of what it was and what it became.
    """
    return [_again(bench, f, fits[0], progress) if k else f for k, f in enumerate(fits)]


def other_sliders(bench: Bench, fit: Fit, progress: Progress) -> list[Fit]:
    """Put other slider laws in the place of a fit's own, from where that one ended.

    Their costs have many valleys in stiffness and slip, so the right law may stop far
    behind one that imitates it. What slides, and how far, they have in common but for
    a factor: an Iwan element slips at a half to all of its largest slip.

    Args:
        bench: measurement and model.
        fit: of one effect.
        progress: told what is being tried.

    Returns:
        Fits that came as low as the one given, none where its effect does not slide.
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
    """Return a fit's base, and its slider's stiffness and slip as another law's."""
    stiffness, slip = fit.terms[0].coordinates[:2]
    shape = [p.encode(p.starts[0]) for p in candidate.effect.parameters[2:]]
    return np.array([*fit.base, stiffness, slip + np.log(factor), *shape])


def caught_up(bench: Bench, fit: Fit, best: Fit, progress: Progress) -> Fit:
    """Fit again under a noise that was estimated at the best, from the better start.

    Args:
        bench: with the noise of the best.
        fit: of another noise.
        best: of this one.
        progress: told what is being tried.
    """
    problem = make_problem(bench, fit.candidates)
    borrowed = np.clip(_borrowed(fit, best), problem.lower, problem.upper)
    starts = (fit.x, borrowed)
    costs = [cost_at(problem, x, MIDDLE) for x in starts]
    return finish(problem, starts[int(np.argmin(costs))], progress)


def _again(bench: Bench, fit: Fit, best: Fit, progress: Progress) -> Fit:
    """Return the better of a fit and what it becomes from the best's base."""
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
    """Return the cost at which a start is no better than nothing."""
    return SEARCH.restart_cost_ratio * max(fit.cost, best.cost)


def _borrowed(fit: Fit, best: Fit) -> FloatArray:
    """Return a fit with the base of the best, and of its effects those they share."""
    known = {t.candidate.label: t.coordinates for t in best.terms}
    own = [known.get(t.candidate.label, t.coordinates) for t in fit.terms]
    return np.concatenate([best.base, *own])
