# SPDX-License-Identifier: MIT
"""Fits of one more effect in the first milliseconds, where records show it in phase."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, words_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.search.candidate_starts import CandidateFit, along
from jointbench.analysis.gap.search.descent import Descent, cost_at, descend
from jointbench.analysis.gap.search.screening import Screening, screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.continued_laws import with_continued
from jointbench.analysis.gap.structure_search.structure_fits import chi2_per_dof
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)

SHORT = Resolution(STRUCTURE_SEARCH.base_windows[1])
LONGER = Resolution(STRUCTURE_SEARCH.base_windows[2])


def tested(few: StructureBench, near: Fit) -> Screening:
    """Run the directed tests of every effect that may be added to a fit.

    Args:
        few: one record of each condition.
        near: fit in the short window, with or without effects.
    """
    others = few.addable(near.candidates)
    return screen(few.for_tests(near, SHORT), near, others, resolution=SHORT)


@dataclass(frozen=True, slots=True)
class CostsToReach:
    """Costs that a fit should reach; one that would hardly do so ends early.

    Attributes:
        short: in the short window; None for any.
        longer: in the longer one; None for any.
    """

    short: float | None = None
    longer: float | None = None


ANY_COST = CostsToReach()
"""Of fits that are compared with each other alone."""


def carried(
    few: StructureBench,
    near: Fit,
    screening: Screening,
    progress: Progress,
    costs: CostsToReach = ANY_COST,
) -> list[Fit]:
    """Fit candidates in short windows, then the best of them in longer ones.

    A descent ends where it would hardly reach the best one so far.

    Args:
        few: one record of each condition.
        near: fit in the short window to which one effect is added.
        screening: directed tests of that fit.
        progress: receives one line for each fit.
        costs: that fits should reach.

    Returns:
        Fits in the longer window, best first.
    """
    fits: list[Fit] = []
    rival, steps = costs.short, STRUCTURE_SEARCH.short_iterations
    bases = _bases(few, near)
    chosen = _chosen(few, near, screening, bases)
    begun = [_starts(few, near, screening, c, bases) for c in chosen]
    for starts in _in_order(few, begun):
        progress(f"{starts[0].label} in a short window")
        tried = [
            _fitted(one.problem, one.x, SHORT, steps, rival, sparing=few.uncertain)
            for one in _kept(few, near, starts)
        ]
        fits.append(min(tried, key=lambda f: f.cost))
        rival = _lowest(costs.short, fits)
    longer: list[Fit] = []
    rival, steps = costs.longer, STRUCTURE_SEARCH.longer_iterations
    for fit in _best_with_continued(few, fits, costs.short):
        progress(f"{words_of(fit.candidates)} in a longer window")
        own = few.at(fit.base, fit.terms, few.landing, few.floor)
        problem = make_problem(own, fit.candidates)
        found = _fitted(problem, fit.x, LONGER, steps, rival, sparing=few.uncertain)
        longer.append(found)
        rival = _lowest(costs.longer, longer)
    longer = with_continued(few, longer, LONGER, steps, rival=costs.longer)
    return sorted(longer, key=lambda f: score(few, f))


def _in_order(
    few: StructureBench, begun: Sequence[list[CandidateFit]]
) -> list[list[CandidateFit]]:
    """Return the starts of candidates; with an uncertain table, the nearest ones first.

    A descent ends where it would hardly reach the best fit so far, so that a good one
    spares the steps of the others.

    Args:
        few: one record of each condition.
        begun: starts of each candidate, best first.
    """
    some = [starts for starts in begun if starts]
    return sorted(some, key=lambda own: own[0].cost) if few.uncertain else some


def _kept(
    few: StructureBench, near: Fit, starts: Sequence[CandidateFit]
) -> list[CandidateFit]:
    """Return the starts of a candidate that are fitted, best first.

    Beside a base far off, a strong effect of a shape of its own, as a hidden mode at
    its frequency, starts far from the records, and a few steps lead it near: the best
    start at each shape is fitted there.

    Args:
        few: one record of each condition.
        near: fit in the short window to which the effect is added.
        starts: best first.
    """
    kept = list(starts[: STRUCTURE_SEARCH.starts_kept])
    far_off = chi2_per_dof(few, near) > STRUCTURE_SEARCH.explaining_chi2
    if few.nonlinear(starts[0].problem.candidates) or not far_off:
        return kept
    shapes = {one.x[near.x.size + 1 :].tobytes(): one for one in reversed(starts)}
    return kept + [one for one in shapes.values() if all(one is not k for k in kept)]


def _fitted(
    problem: FitProblem,
    start: FloatArray,
    window: Resolution,
    steps: int,
    rival: float | None,
    *,
    sparing: bool,
) -> Fit:
    """Return a fit in a window, which ends where it would hardly reach a rival."""
    how = Descent(window, steps, rival, exact_slopes=False, sparing=sparing)
    return descend(problem, start, how)


def _lowest(cost: float | None, fits: Sequence[Fit]) -> float | None:
    """Return the lowest of a cost and those of fits, None if there is none."""
    known = [] if cost is None else [cost]
    return min([*known, *(f.cost for f in fits)], default=None)


def _best_with_continued(
    few: StructureBench, fits: Sequence[Fit], rival: float | None
) -> list[Fit]:
    """Return the best fits in the short window, laws continued beyond a common bound.

    Beside a law that ended there, every second effect has a fit that ends there, and
    the law beyond is fitted only beside those that are among the best.

    Args:
        few: one record of each condition.
        fits: in the short window.
        rival: cost that they should reach there, if any.
    """
    count, steps = STRUCTURE_SEARCH.longer_fits, STRUCTURE_SEARCH.short_iterations
    best = sorted(fits, key=lambda f: score(few, f))[:count]
    best = with_continued(few, best, SHORT, steps, rival=rival)
    return sorted(best, key=lambda f: score(few, f))[:count]


@dataclass(frozen=True, slots=True, eq=False)
class _StartingBase:
    """A base from which far starts go.

    Attributes:
        x: its coordinates, then those of effects fitted already, shape (n,).
        bench: with the joints closed there once.
    """

    x: FloatArray
    bench: StructureBench


def _bases(few: StructureBench, near: Fit) -> list[_StartingBase]:
    """Return the nominal base and the fitted one."""
    nominal = np.concatenate([np.zeros_like(near.base), near.x[near.n_base :]])
    fits = (replace(near, x=nominal), near)
    return [_StartingBase(one.x, few.for_tests(one, SHORT)) for one in fits]


def _chosen(
    few: StructureBench,
    near: Fit,
    screening: Screening,
    bases: Sequence[_StartingBase],
) -> list[Candidate]:
    """Return the leaders of the directed tests, and those that are always tried.

    An effect leads at a few sites at most, else one that follows any residual would
    fill all places. Effects at the place of the first leader, without laws, are tried
    as well: a strong one looks like another one there.
    """
    always = {e.effect.name for e in few.entries if e.always}
    free = few.addable(near.candidates)
    chosen = [c for c in free if c.effect.name in always or few.hints(near, c)]
    others: list[Candidate] = []
    for c in screening.leaders(len(few.candidates)):
        same = sum(c.effect.name == one.effect.name for one in others)
        if c not in chosen and same < STRUCTURE_SEARCH.leading_sites:
            others.append(c)
    leaders = others[: STRUCTURE_SEARCH.leaders]
    place = [
        c
        for c in free
        if leaders and c.site == leaders[0].site and not few.nonlinear((c,))
        if c not in leaders and c not in chosen
    ]
    known = leaders + place + chosen
    others = [c for c in free if c not in known]
    return known + _strong(few, near, others, bases)


def _strong(
    few: StructureBench,
    near: Fit,
    others: Sequence[Candidate],
    bases: Sequence[_StartingBase],
) -> list[Candidate]:
    """Return candidates that are nearer to the records when strong than the fit is.

    Directed tests mislead about a stiff spring or a large mass at a point, which has
    the most sites; laws and effects that are always tried are left out.
    """
    if chi2_per_dof(few, near) < STRUCTURE_SEARCH.explaining_chi2:
        return []
    reached = []
    for c in others:
        if few.nonlinear((c,)) or len(c.effect.parameters) > 1:
            continue
        starts = _far_starts(few, near, c, _far(c), bases)
        if starts and (cost := min(s.cost for s in starts)) < near.cost:
            reached.append((cost, c))
    reached.sort(key=lambda one: one[0])
    return [c for _, c in reached[: STRUCTURE_SEARCH.strong_sites]]


def _starts(
    few: StructureBench,
    near: Fit,
    screening: Screening,
    candidate: Candidate,
    bases: Sequence[_StartingBase],
) -> list[CandidateFit]:
    """Return starts of a candidate, best first: along its tests, and far ones."""
    problem = make_problem(few, (*near.candidates, candidate))
    starts = [along(problem, near, d, SHORT) for d in screening.best(candidate, 2)]
    tails = (*_far(candidate), *few.hints(near, candidate))
    starts += _far_starts(few, near, candidate, tails, bases)
    return sorted(starts, key=lambda s: s.cost)


def _far_starts(
    few: StructureBench,
    near: Fit,
    candidate: Candidate,
    tails: Sequence[FloatArray],
    bases: Sequence[_StartingBase],
) -> list[CandidateFit]:
    """Return starts at coordinates of a candidate, from each of the bases."""
    candidates = (*near.candidates, candidate)
    problem = make_problem(few, candidates)
    starts = []
    for tail in tails:
        for base in bases:
            x = np.concatenate([base.x, tail])
            cost = cost_at(replace(problem, bench=base.bench), x, SHORT)
            starts.append(CandidateFit(problem, x, cost))
    return starts


def _far(candidate: Candidate) -> list[FloatArray]:
    """Return starts of a strong effect, where its directed test misleads."""
    first = candidate.effect.parameters[0]
    return [
        np.array([first.encode(amplitude), *shape[1:]])
        for amplitude in first.far
        for shape in start_grid(candidate)
    ]
