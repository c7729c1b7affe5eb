# SPDX-License-Identifier: MIT
"""Laws of friction that continue where the shape of another one ends.

Micro-slip and macro-slip are one law, divided at a shape of its strengths. A fit that
ends at that bound is on its way to the other one, from a start that neither its
directed tests nor its grid has.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench


def with_continued(
    few: StructureBench,
    fits: Sequence[Fit],
    window: Resolution,
    steps: int,
    *,
    rival: float | None = None,
) -> list[Fit]:
    """Return fits, laws that ended at a common bound replaced by those beyond it.

    The law beyond the bound is fitted from there. The better one of its fits stays, and
    replaces the fit at the bound if it is better than that.

    Args:
        few: one record of each condition.
        fits: in a window.
        window: in which they were fitted.
        steps: most steps of a fit.
        rival: cost that a fit should reach, if any.
    """
    found = list(fits)
    for fit in fits:
        start = continued(few, fit)
        if start is None:
            continue
        candidates, x = start
        own = few.at(fit.base, fit.terms, few.landing, few.floor)
        problem = make_problem(own, candidates)
        beyond = minimise(
            problem, x, window, iterations=steps, rival=rival, exact_slopes=False
        )
        alike = [f for f in found if f.candidates == candidates]
        best = min([*alike, beyond], key=lambda f: f.cost)
        found = [f for f in found if all(f is not one for one in alike)]
        if best.cost < fit.cost:
            found = [f for f in found if f is not fit]
        found.append(best)
    return found


def continued(
    few: StructureBench, fit: Fit
) -> tuple[tuple[Candidate, ...], FloatArray] | None:
    """Return effects and start of the law beyond the bound at which a fit ended.

    Args:
        few: bench with the catalogue.
        fit: of any effects.

    Returns:
        None if no law of the fit ended at such a bound.
    """
    for k, term in enumerate(fit.terms):
        for other in few.candidates:
            if _beyond(term, other):
                candidates = list(fit.candidates)
                candidates[k] = other
                tails = [t.coordinates for t in fit.terms]
                tails[k] = _same_values(term, other)
                return tuple(candidates), np.concatenate([fit.base, *tails])
    return None


def one_of_each_law(fits: Sequence[Fit]) -> list[Fit]:
    """Return fits without those whose law continues that of one before, at its sites.

    A second effect beside both would be sought beside one law twice.

    Args:
        fits: best first.
    """
    kept: list[Fit] = []
    for fit in fits:
        if not any(_one_law(fit, other) for other in kept):
            kept.append(fit)
    return kept


def _one_law(fit: Fit, other: Fit) -> bool:
    """Return whether all effects of two fits are sliders, at the same sites."""
    both = (*fit.candidates, *other.candidates)
    same = [c.site for c in fit.candidates] == [c.site for c in other.candidates]
    return same and all(c.effect.has_sliders for c in both)


def _beyond(term: Term, other: Candidate) -> bool:
    """Return whether a law of sliders begins where the shape of a term ended."""
    own = term.candidate
    if not (own.effect.has_sliders and other.effect.has_sliders) or own == other:
        return False
    if other.site != own.site:
        return False
    theirs = {p.name: p.bounds for p in other.effect.parameters}
    for p, value in zip(own.effect.parameters, term.coordinates, strict=True):
        low, high = p.bounds
        if p.name not in theirs or theirs[p.name] == p.bounds:
            continue
        if (value == high and theirs[p.name][0] == high) or (
            value == low and theirs[p.name][1] == low
        ):
            return True
    return False


def _same_values(term: Term, other: Candidate) -> FloatArray:
    """Return coordinates of another law with the values of a term, within bounds."""
    names = [p.name for p in term.candidate.effect.parameters]
    known = dict(zip(names, term.coordinates, strict=True))
    found = [
        known[p.name] if p.name in known else p.encode(p.starts[0])
        for p in other.effect.parameters
    ]
    limits = [p.bounds for p in other.effect.parameters]
    return np.array(
        [min(max(v, low), high) for v, (low, high) in zip(found, limits, strict=True)]
    )
