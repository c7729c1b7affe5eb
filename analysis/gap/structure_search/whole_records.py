# SPDX-License-Identifier: MIT
"""Fits of effects to whole records: which of them are worth it, and their judgement."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.model.effect import Candidate, labels_of, words_of
from jointbench.analysis.gap.residuals.fit_records import (
    Fit,
    with_covariance_alone,
    without_slopes,
)
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.continued_laws import continued
from jointbench.analysis.gap.structure_search.retuned_modes import retuned_as_near
from jointbench.analysis.gap.structure_search.slopes_again import with_slopes
from jointbench.analysis.gap.structure_search.sought_frequencies import (
    from_other_frequencies,
)
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
    allowed_chi2,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    chi2_per_dof,
    in_full,
    in_windows,
    met_at,
    near_records,
    settled,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


@dataclass(frozen=True, slots=True, eq=False)
class JudgedFit:
    """A fit to whole records on its own bench, with its acceptance."""

    bench: StructureBench
    fit: Fit
    acceptance: Acceptance


_Found = tuple[StructureBench, Fit]
"""A fit with the bench on which it was found."""


def in_whole_records(
    bench: StructureBench,
    few: StructureBench,
    base: Fit,
    carried: Sequence[Fit],
    progress: Progress,
    judged: Sequence[JudgedFit] = (),
) -> list[JudgedFit]:
    """Fit the best candidates to whole records, accepted ones first.

    One record of each condition decides which of them are fitted to all, unless they
    are already. Fits are at rest.

    Args:
        bench: all records.
        few: one record of each condition.
        base: fit without effects.
        carried: fits in the longer window, best first.
        progress: receives one line for each fit.
        judged: fits to all records, which are among those returned.
    """
    known = {labels_of(one.fit.candidates) for one in judged}
    few = replace(few, reach=bench.reach)
    met = _met_in_windows(few, carried, progress)
    near: list[_Found] = []
    for own, fit in met:
        limit = STRUCTURE_SEARCH.whole_cost_ratio
        if any(_explains(one) for one in near):
            limit = STRUCTURE_SEARCH.explained_cost_ratio
        if _cost_per_row(fit) > limit * _cost_per_row(met[0][1]):
            continue
        progress(f"{words_of(fit.candidates)} in whole records")
        own, start = retuned_as_near(own, fit.x, fit.candidates)
        own, found = in_full(own, start, fit.candidates)
        near.append((own.at_rest(), with_covariance_alone(found)))
    near.sort(key=lambda one: one[1].cost)
    near = _from_other_frequencies(near, progress)
    done: list[JudgedFit] = []
    for own, fit in near:
        if fit.cost > near[0][1].cost + STRUCTURE_SEARCH.cost_above_best:
            break
        if labels_of(fit.candidates) in known:
            continue
        progress(f"{words_of(fit.candidates)} in all records")
        # Slopes of all records are the largest array there is.
        done[:1] = [at_rest(one) for one in done[:1]]
        done = best_first([*done, _in_all_records(bench, own, fit, base)])
    done = _beyond_bounds(done, base, progress)
    return [at_rest(one) for one in best_first([*done, *judged])]


def _in_all_records(
    bench: StructureBench, few: StructureBench, near: Fit, base: Fit
) -> JudgedFit:
    """Fit all records from a fit to one of each condition, and judge the fit.

    A law that is far beyond its limit there explains all records no better. Each hit is
    met where it landed, but no step is made and no slopes are computed, which take
    seconds: its covariance stays that of one record of each condition.

    Args:
        bench: all records.
        few: one record of each condition.
        near: fit to these.
        base: fit to all records without effects.
    """
    whole = replace(bench, layout=few.layout)
    if _law_far_beyond(few, near, allowed_chi2(bench, base)):
        whole, fit = met_at(whole, near.x, near.candidates)
        fit = replace(fit, kept=near.kept)
    else:
        near_it = near_records(few, near)
        whole, fit = settled(whole, near.x, near.candidates, near=near_it)
    return _judged(whole, fit, base)


def far_beyond_limit(judged: JudgedFit) -> bool:
    """Return whether a fit with a law leaves far more than its limit of chi2/dof.

    Args:
        judged: fit to all records.
    """
    allowed = judged.acceptance.allowed + 1.0
    return _law_far_beyond(judged.bench, judged.fit, allowed)


def _law_far_beyond(bench: StructureBench, fit: Fit, allowed: float) -> bool:
    """Return whether a fit with a law leaves far more than its limit of chi2/dof."""
    far = STRUCTURE_SEARCH.far_beyond * allowed
    return bench.nonlinear(fit.candidates) and chi2_per_dof(bench, fit) > far


def _judged(bench: StructureBench, fit: Fit, base: Fit) -> JudgedFit:
    """Judge a fit to all records beside their base."""
    return JudgedFit(bench.at_rest(), fit, accept_structure(bench, fit, base))


def _beyond_bounds(
    done: list[JudgedFit], base: Fit, progress: Progress
) -> list[JudgedFit]:
    """Return fits with the law beyond the bound at which the best one ended.

    In windows either law may be the better one; all records decide, unless the best one
    is far beyond its limit.

    Args:
        done: fits to all records, best first.
        base: fit without effects.
        progress: receives one line for the fit, if there is one.
    """
    start = continued(done[0].bench, done[0].fit) if done else None
    if start is None:
        return done
    best = done[0]
    if far_beyond_limit(best):
        return done
    candidates, x = start
    progress(f"{words_of(candidates)} in all records")
    rest = [at_rest(one) for one in done]
    bench, fit = settled(best.bench, x, candidates, near=True, rival=best.fit.cost)
    return best_first([*rest, _judged(bench, fit, base)])


def _from_other_frequencies(near: Sequence[_Found], progress: Progress) -> list[_Found]:
    """Return fits, best first, the best one from frequencies that it had lost.

    With laws each frequency that is tried is a time integration, so they keep theirs.

    Args:
        near: fits to one record of each condition, best first.
        progress: receives one line for the fit, if there is one.
    """
    if not near or _explains(near[0]):
        return list(near)
    own, fit = near[0]
    if not own.uncertain or own.nonlinear(fit.candidates):
        return list(near)
    progress(f"{words_of(fit.candidates)} from other frequencies")
    own, fit = from_other_frequencies(own, fit) or (own, fit)
    return [(own.at_rest(), without_slopes(fit)), *near[1:]]


def first_with_slopes(done: Sequence[JudgedFit]) -> list[JudgedFit]:
    """Return fits, the first one with its slopes, which a verdict needs.

    Args:
        done: fits, best first.
    """
    first = [replace(one, fit=with_slopes(one.bench, one.fit)) for one in done[:1]]
    return [*first, *done[1:]]


def best_first(done: Sequence[JudgedFit]) -> list[JudgedFit]:
    """Return fits, accepted ones first; the slopes of all but the first go.

    Args:
        done: fits, one of them for each explanation or more; the best one counts.
    """
    ranked = sorted(done, key=lambda one: (not one.acceptance.passed, one.fit.cost))
    best = {labels_of(one.fit.candidates): one for one in reversed(ranked)}
    ranked = [one for one in ranked if best[labels_of(one.fit.candidates)] is one]
    rest = [replace(one, fit=without_slopes(one.fit)) for one in ranked[1:]]
    return ranked[:1] + rest


def at_rest(one: JudgedFit) -> JudgedFit:
    """Return a fit with its covariance alone, and with the slopes of laws.

    These take long.

    Args:
        one: fit to all records.
    """
    if one.bench.nonlinear(one.fit.candidates):
        return one
    return replace(one, fit=with_covariance_alone(one.fit))


def _met_in_windows(
    few: StructureBench, carried: Sequence[Fit], progress: Progress
) -> list[_Found]:
    """Fit candidates in windows, each hit met where it landed, best first.

    Before that, the linear model of where hits landed decides between laws: friction
    that slips as a whole left ten times the chi2 of a wrong law.
    """
    found: list[_Found] = []
    rival: float | None = None
    for fit in worth_it(few, carried):
        progress(f"{words_of(fit.candidates)} where hits landed")
        own, start = retuned_as_near(few, fit.x, fit.candidates)
        # A linear fit costs little, and its first steps mislead about where it ends.
        law = own.nonlinear(fit.candidates)
        own, here = in_windows(own, start, fit.candidates, rival=rival if law else None)
        rival = min(_cost_per_row(here), rival or np.inf)
        further = continued(own, here)
        if further and not any(_is_better(one, further[0], here) for one in found):
            progress(f"{words_of(further[0])} where hits landed")
            beyond, other = in_windows(own, further[1], further[0], rival=rival)
            if _cost_per_row(other) < _cost_per_row(here):
                own, here = beyond, other
                rival = min(_cost_per_row(here), rival)
        found.append((own, without_slopes(here)))
    found.sort(key=lambda one: _cost_per_row(one[1]))
    best = {labels_of(fit.candidates): (own, fit) for own, fit in reversed(found)}
    return sorted(best.values(), key=lambda one: _cost_per_row(one[1]))


def _is_better(found: _Found, candidates: Sequence[Candidate], fit: Fit) -> bool:
    """Return whether other effects have a fit already, and a better one than these."""
    known = found[1]
    same = known.candidates == tuple(candidates)
    return same and _cost_per_row(known) < _cost_per_row(fit)


def _cost_per_row(fit: Fit) -> float:
    """Return the cost over the rows: a fit far off has those of the first window."""
    return fit.cost / fit.residual.size


def _explains(found: _Found) -> bool:
    """Return whether a fit explains one record of each condition."""
    bench, fit = found
    limit = bench.policy.floor_chi2 * fit.residual.size
    return fit.chi2 * bench.coherence < limit


def worth_it(few: StructureBench, carried: Sequence[Fit]) -> list[Fit]:
    """Return the fits that may be the best over whole records.

    Laws of the family of the best one take their turn, however far they seem.
    """
    if not carried:
        return []
    best = carried[0]
    family = {c.effect.family for c in best.candidates if few.nonlinear((c,))}
    near = [
        f
        for f in carried[: STRUCTURE_SEARCH.whole_fits]
        if f.cost < STRUCTURE_SEARCH.whole_cost_ratio * best.cost
    ]
    turn: dict[frozenset[str], Fit] = {}
    for fit in carried:
        laws = [c for c in fit.candidates if few.nonlinear((c,))]
        if laws and {c.effect.family for c in laws} <= family:
            turn.setdefault(frozenset(c.effect.name for c in fit.candidates), fit)
    return near + [f for f in turn.values() if all(f is not one for one in near)]
