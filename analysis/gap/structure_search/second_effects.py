# SPDX-License-Identifier: MIT
"""A second effect beside the best single ones, where these leave much of the hits."""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.gap.judgement.amplitudes import (
    amplitude_sizes,
    weakest_amplitude,
)
from jointbench.analysis.gap.model.effect import labels_of, words_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.continued_laws import one_of_each_law
from jointbench.analysis.gap.structure_search.short_windows import (
    LONGER,
    SHORT,
    CostsToReach,
    carried,
    tested,
)
from jointbench.analysis.gap.structure_search.slopes_again import with_covariance
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    chi2_per_dof,
    settled,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    far_beyond_limit,
    in_whole_records,
)


def second_effects(
    bench: StructureBench,
    few: StructureBench,
    base: Fit,
    singles: Sequence[Fit],
    best: JudgedFit,
    progress: Progress,
) -> list[JudgedFit]:
    """Return accepted fits of two effects, or of the one to which a pair led.

    Beside a law it takes minutes: one is sought there unless a pair with a law, found
    beside a linear effect, is accepted.

    Args:
        bench: all records.
        few: one record of each condition.
        base: fit to all records without effects.
        singles: fits of one effect in the longer window, best first.
        best: the best one of them in all records.
        progress: receives one line for each step.

    Returns:
        Best first; empty if no pair is accepted.
    """
    firsts = one_of_each_law(singles)[: STRUCTURE_SEARCH.first_effects]
    laws = [first for first in firsts if few.nonlinear(first.candidates)]
    linear = [first for first in firsts if not few.nonlinear(first.candidates)]
    pairs = [pair for first in linear for pair in _beside(few, first, progress)]
    far, two = far_beyond_limit(best), list[JudgedFit]()
    worth = that_take(pairs, singles) if far else pairs
    if laws and any(_near_with_law(few, pair) for pair in worth):
        two = in_whole_records(bench, few, base, _best_pairs(few, worth), progress)
        found = _accepted(bench, base, two)
        if found and few.nonlinear(found[0].fit.candidates):
            return found
    if far:
        worth = _that_take_beside(few, laws, pairs, singles, progress)
    else:
        pairs += [pair for first in laws for pair in _beside(few, first, progress)]
        worth = pairs
    two = in_whole_records(bench, few, base, _best_pairs(few, worth), progress, two)
    return _accepted(bench, base, two)


def leaves_much(best: JudgedFit) -> bool:
    """Return whether a fit leaves enough for a second effect.

    Of a law whose chi2 is within its limit, the base or a mark is refused, which no
    second effect mends; each fit of a pair integrates the law again. The limit allows a
    share of what the base leaves, and beside a strong effect a weak one fits into it.

    Args:
        best: the best fit of a single effect to all records.
    """
    judged = best.acceptance
    if best.bench.nonlinear(best.fit.candidates) and judged.excess <= judged.allowed:
        return False
    return not (judged.passed and explains_plainly(best))


def explains_plainly(one: JudgedFit) -> bool:
    """Return whether a fit would explain the hits without a share of the base's chi2.

    Args:
        one: fit to all records.
    """
    return one.acceptance.excess <= one.bench.policy.floor_chi2 - 1.0


def _near_with_law(few: StructureBench, pair: Fit) -> bool:
    """Return whether a pair with a law comes near the hits in the longer window."""
    limit = STRUCTURE_SEARCH.explaining_chi2
    return few.nonlinear(pair.candidates) and chi2_per_dof(few, pair) < limit


def _beside(few: StructureBench, first: Fit, progress: Progress) -> list[Fit]:
    """Return fits of a second effect beside a first one in the longer window."""
    own, near = _in_short_window(few, first, progress)
    return carried(own, near, tested(own, near), progress)


def _that_take_beside(
    few: StructureBench,
    laws: Sequence[Fit],
    pairs: Sequence[Fit],
    singles: Sequence[Fit],
    progress: Progress,
) -> list[Fit]:
    """Return pairs that take most of what is left, where laws are far beyond a limit.

    A law is fitted in the longer window from where a second effect is sought beside it,
    so that a pair takes nothing that the law takes there alone; a descent ends where it
    would hardly take enough.

    Args:
        few: one record of each condition.
        laws: fits of laws in the longer window.
        pairs: fits of pairs beside linear effects.
        singles: fits of single effects.
        progress: receives one line for each step.
    """
    found, alone = list(pairs), list(singles)
    steps, left = STRUCTURE_SEARCH.longer_iterations, 1.0 - STRUCTURE_SEARCH.pair_share
    for first in laws:
        own, near = _in_short_window(few, first, progress)
        problem = make_problem(own, first.candidates)
        law = minimise(problem, near.x, LONGER, iterations=steps, exact_slopes=False)
        costs = CostsToReach(left * near.cost, left * law.cost)
        found += carried(own, near, tested(own, near), progress, costs)
        alone.append(law)
    return that_take(found, alone)


def _in_short_window(
    few: StructureBench, first: Fit, progress: Progress
) -> tuple[StructureBench, Fit]:
    """Return the bench about a first effect, and its fit in the short window."""
    own = few.at(first.base, first.terms, few.landing, few.floor)
    progress(f"directed tests beside {words_of(first.candidates)}")
    near = minimise(
        make_problem(own, first.candidates),
        first.x,
        SHORT,
        iterations=STRUCTURE_SEARCH.short_iterations,
    )
    return own, near


def _best_pairs(few: StructureBench, pairs: Sequence[Fit]) -> list[Fit]:
    """Return the best fit of each pair that is fitted to whole records, best first."""
    different = {labels_of(f.candidates): f for f in reversed(_best_first(few, pairs))}
    return affordable(few, _best_first(few, list(different.values())))


def _accepted(
    bench: StructureBench, base: Fit, two: list[JudgedFit]
) -> list[JudgedFit]:
    """Return accepted fits of pairs, best first; empty if the best one is not.

    Args:
        bench: all records.
        base: fit without effects.
        two: fits of pairs to all records, best first.
    """
    if two and (one := alone(bench, base, two[0])):
        return [one]
    if two and two[0].acceptance.passed and _both_matter(two[0]):
        return two
    return []


def alone(bench: StructureBench, base: Fit, pair: JudgedFit) -> JudgedFit | None:
    """Return the accepted fit of a single effect to which a pair led, if it did.

    Where the second effect of a pair is nearly off, it was a further start for the
    first.

    Args:
        bench: all records.
        base: fit without effects.
        pair: fit of two effects.
    """
    sizes = amplitude_sizes(with_covariance(pair.bench, pair.fit))
    if not pair.acceptance.passed or min(sizes) >= STRUCTURE_SEARCH.plain_amplitude:
        return None
    kept = pair.fit.terms[int(np.argmax(sizes))]
    start = np.concatenate([pair.fit.base, kept.coordinates])
    own, fit = settled(bench, start, (kept.candidate,), near=True)
    judged = JudgedFit(own, fit, accept_structure(own, fit, base))
    return judged if judged.acceptance.passed else None


def that_take(pairs: Sequence[Fit], singles: Sequence[Fit]) -> list[Fit]:
    """Return pairs that take most of what single effects leave there.

    Beside a law that leaves many times its limit, a second effect that is missing takes
    most of it; others would be fitted to whole records for nothing.

    Args:
        pairs: fits in the longer window.
        singles: fits there of single effects.
    """
    left = min(fit.cost for fit in singles)
    return [f for f in pairs if f.cost < (1.0 - STRUCTURE_SEARCH.pair_share) * left]


def affordable(few: StructureBench, pairs: Sequence[Fit]) -> list[Fit]:
    """Return pairs for whole records: few with a law, which is integrated there."""
    laws = [f for f in pairs if few.nonlinear(f.candidates)]
    left = laws[STRUCTURE_SEARCH.law_pairs :]
    return [f for f in pairs if all(f is not one for one in left)]


def _best_first(few: StructureBench, fits: Sequence[Fit]) -> list[Fit]:
    return sorted(fits, key=lambda f: score(few, f))


def _both_matter(judged: JudgedFit) -> bool:
    """Return whether each effect of a pair is clearly on."""
    amplitude = weakest_amplitude(with_covariance(judged.bench, judged.fit))
    return amplitude >= judged.bench.policy.amplitude_limit
