# SPDX-License-Identifier: MIT
"""Other effects in the place of one: a pair may be half right."""

from collections.abc import Collection

from jointbench.analysis.gap.model.effect import labels_of, may_join
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.far_pairs import without
from jointbench.analysis.gap.search.screening import screen
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.selection_round import Progress, run_selection


def exchanged(
    bench: Bench,
    fit: Fit,
    known: Collection[frozenset[str]],
    progress: Progress,
) -> list[Fit]:
    """Take each effect out of a fit and race others for its place.

    The first effect of a pair is chosen while the second is missing, so that one may
    stand in for another. With its partner in, the directed tests see clearly.

    Args:
        bench: measurement and model.
        fit: of several effects, which does not explain the records.
        known: sets of effects that need no other race.
        progress: told what is being tried.

    Returns:
        Fits of as many effects, in no order.
    """
    found: list[Fit] = []
    for k, candidate in enumerate(fit.candidates):
        kept = without(bench, fit, k, MIDDLE)
        others = [
            c
            for c in bench.candidates
            if c != candidate and may_join(c, kept.candidates)
        ]
        screening = screen(bench, kept, others)
        tried = [
            c
            for c in screening.leaders(SEARCH.exchange_candidates)
            if labels_of((*kept.candidates, c)) not in known
        ]
        found += run_selection(bench, kept, screening, tried, progress)
    return found
