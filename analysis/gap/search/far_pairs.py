# SPDX-License-Identifier: MIT
"""Pairs of great effects: searched under short windows, where nothing is out of phase.

Where one effect alone leaves a misfit of many times the noise, its fit has dragged the
base far off its sheet, and directed tests from there point anywhere. The first few
milliseconds after a hit are still in phase, and cheap. So pairs are put together
there: the best second to each first, then others in the place of each, until no
exchange helps.
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
    """Search for pairs of great effects.

    Args:
        bench: measurement and model.
        progress: told what is being tried.

    Returns:
        The best pairs, fitted under a window that holds several periods of the first
        modes: starts for a race over the whole records.
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
    """Return a fit less one effect, its base left where it is.

    Args:
        bench: measurement and model.
        fit: of several effects.
        k: which of them.
        resolution: of the slopes.
    """
    terms = [t for i, t in enumerate(fit.terms) if i != k]
    problem = make_problem(bench, [t.candidate for t in terms])
    start = np.concatenate([fit.base, *(t.coordinates for t in terms)])
    return minimise(problem, start, resolution, iterations=0)


def _with_one_more(bench: Bench, fit: Fit, count: int, progress: Progress) -> list[Fit]:
    """Return short fits of the effects that directed tests put first."""
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
