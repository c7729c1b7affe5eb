# SPDX-License-Identifier: MIT
"""Replace each effect of a fit by others: a pair may be half right."""

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
    """Remove each effect of a fit in turn and fit others in its place.

    The first effect of a pair is selected while the second is missing, so that it may
    imitate another one. With the second included, the directed tests are reliable.

    Args:
        bench: measurement and model.
        fit: of several effects, which does not explain the records.
        known: sets of effects that need no further fit.
        progress: receives the label of each candidate.

    Returns:
        Fits of as many effects, unordered.
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
