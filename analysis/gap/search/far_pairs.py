# SPDX-License-Identifier: MIT
"""Search for pairs of large effects under short windows.

If one effect alone leaves a residual of many times the noise, the base of its fit is
far from its nominal parameters, and directed tests at that base are unreliable. In the
first few milliseconds after a hit, model and measurement are still in phase, and the
prediction is fast. Pairs are therefore formed there: the best second effect for each
first one, then exchanges of each effect, until no exchange lowers the cost.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.gap.model.effect import labels_of, may_join, words_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import along
from jointbench.analysis.gap.search.descent import fit_coarse_to_fine, minimise
from jointbench.analysis.gap.search.screening import screen
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.selection_round import Progress

_SHORT = Resolution(SEARCH.short_window, SEARCH.screening_steps)
_LONGER = Resolution(SEARCH.longer_window, SEARCH.screening_steps)


def far_pairs(bench: Bench, progress: Progress) -> list[Fit]:
    """Search for pairs of large effects.

    Args:
        bench: measurement and model.
        progress: receives the label of each candidate.

    Returns:
        The best pairs, fitted under a window of several periods of the first modes:
        starts for a selection over the whole records.
    """
    problem = make_problem(bench, ())
    base = fit_coarse_to_fine(
        problem, np.zeros(problem.n_base), ((_SHORT, SEARCH.pair_iterations),)
    )
    singles = _best(
        _with_one_more(bench, base, SEARCH.pair_singles, progress), SEARCH.pair_firsts
    )
    pairs: list[Fit] = []
    for first in singles:
        pairs += _with_one_more(bench, first, SEARCH.pair_seconds, progress)
    pairs = _best(pairs, SEARCH.pairs_kept)
    for _ in range(SEARCH.pair_exchanges if pairs else 0):
        leader = pairs[0]
        for k in range(len(leader.candidates)):
            kept = without(bench, leader, k, _SHORT)
            pairs += _with_one_more(bench, kept, SEARCH.pair_seconds, progress)
        pairs = _best(pairs, SEARCH.pairs_kept)
        if pairs[0] is leader:
            break
    return [_longer(bench, f) for f in pairs]


def without(bench: Bench, fit: Fit, k: int, resolution: Resolution) -> Fit:
    """Return a fit without one effect, with its base unchanged.

    Args:
        bench: measurement and model.
        fit: of several effects.
        k: index of the effect.
        resolution: of the slopes.
    """
    terms = [t for i, t in enumerate(fit.terms) if i != k]
    problem = make_problem(bench, [t.candidate for t in terms])
    start = np.concatenate([fit.base, *(t.coordinates for t in terms)])
    return minimise(problem, start, resolution, iterations=0)


def _with_one_more(bench: Bench, fit: Fit, count: int, progress: Progress) -> list[Fit]:
    """Return short fits of the effects with the largest directed tests."""
    others = [c for c in bench.candidates if may_join(c, fit.candidates)]
    screening = screen(bench, fit, others, resolution=_SHORT)
    found = []
    for candidate in screening.leaders(count):
        problem = make_problem(bench, (*fit.candidates, candidate))
        progress(f"{words_of(problem.candidates)} (first milliseconds)")
        starts = [along(problem, fit, d, _SHORT) for d in screening.best(candidate, 2)]
        start = min(starts, key=lambda r: r.cost)
        found.append(
            minimise(problem, start.x, _SHORT, iterations=SEARCH.pair_iterations)
        )
    return found


def _longer(bench: Bench, fit: Fit) -> Fit:
    problem = make_problem(bench, fit.candidates)
    return minimise(
        problem, fit.x, _LONGER, iterations=SEARCH.pair_iterations, exact_slopes=False
    )


def _best(fits: Sequence[Fit], count: int) -> list[Fit]:
    """Return the best fits, each set of effects once."""
    found: dict[frozenset[str], Fit] = {}
    for f in sorted(fits, key=lambda f: f.cost):
        if np.isfinite(f.cost):
            found.setdefault(labels_of(f.candidates), f)
    return list(found.values())[:count]
