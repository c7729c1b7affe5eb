# SPDX-License-Identifier: MIT
"""Outcome of a search on bolted bodies: the best fit beside the base and its rivals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.judgement.rivals import rival_within, rivals
from jointbench.analysis.gap.residuals.evaluation_resolutions import FINE, FULL
from jointbench.analysis.gap.residuals.fit_records import Fit, without_slopes
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import fit_at, minimise
from jointbench.analysis.gap.search.screening import Screening
from jointbench.analysis.gap.search.selection_round import score
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.fit_summary import FitSummary
from jointbench.analysis.gap.structure_search.sensors_from_base import of_table
from jointbench.analysis.gap.structure_search.slopes_again import (
    with_covariance,
    with_slopes,
)
from jointbench.analysis.gap.structure_search.structure_fits import fitted_finely
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
)


@dataclass(frozen=True, slots=True, eq=False)
class StructureOutcome:
    """Outcome of a search on bolted bodies.

    Attributes:
        outcome: base, best fit and its rivals.
        bench: on which the best fit was found.
        base_bench: on which the base was found.
        before: gap and parameters of the base.
    """

    outcome: SearchOutcome
    bench: StructureBench
    base_bench: StructureBench
    before: FitSummary


def without_effects(
    bench: StructureBench,
    base: Fit,
    judged: Acceptance,
    screening: Screening,
    before: FitSummary,
) -> StructureOutcome:
    """Return the outcome that nothing is missing, or that nothing was found.

    Args:
        bench: all records, on which the base was found.
        base: fit without effects.
        judged: its acceptance.
        screening: directed tests.
        before: gap and parameters of the base.
    """
    none = SearchOutcome(bench, base, judged, screening, base, judged, (), (base,))
    return StructureOutcome(none, bench, bench, before)


def compared(none: SearchOutcome, done: Sequence[JudgedFit]) -> SearchOutcome:
    """Compare the best fit with its rivals under one whitening.

    Args:
        none: outcome without effects.
        done: fits at rest, best first.
    """
    best = done[0]
    fits = [best.fit, *(_alike(best, one.fit) for one in done[1:])]
    fits.sort(key=lambda f: score(best.bench, f))
    level, shown = [best.fit], with_covariance(best.bench, best.fit)
    if best.acceptance.passed:
        level = _alike_by_size(best, rivals(best.bench, fits))
        shown = with_slopes(best.bench, best.fit)
    return replace(
        none,
        bench=best.bench,
        best=shown,
        acceptance=best.acceptance,
        ranked=tuple(shown if f is best.fit else f for f in fits),
        level=tuple(shown if f is best.fit else f for f in level),
    )


def _alike_by_size(best: JudgedFit, level: Sequence[Fit]) -> list[Fit]:
    """Return rivals, those at the same channel in units of what is left there."""
    first, bench = level[0], best.bench
    limit = rival_within(first, bench.policy) * of_table(bench, first)
    return [
        one
        for one in level
        if {c.site for c in one.candidates} != {c.site for c in first.candidates}
        or score(bench, one) - score(bench, first) < limit
    ]


def _alike(best: JudgedFit, fit: Fit) -> Fit:
    """Return a rival under the whitening of the best fit, with the slopes of a law.

    Steps of a law, which take long, are made where they decide between rivals.
    """
    problem = make_problem(best.bench, fit.candidates)
    if best.bench.nonlinear(fit.candidates):
        if not best.acceptance.passed:
            return fit_at(problem, fit.x, FINE)
        return fitted_finely(best.bench, fit.x, fit.candidates, 3)
    # Frequencies that a table leaves open are those of the closed modes of the best.
    steps = STRUCTURE_SEARCH.whole_iterations if best.bench.uncertain else 3
    found = minimise(problem, fit.x, FULL, iterations=steps, exact_slopes=False)
    return without_slopes(found)
