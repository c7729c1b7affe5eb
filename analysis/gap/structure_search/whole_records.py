# SPDX-License-Identifier: MIT
"""Fits of effects to whole records: which of them are worth it, and their judgement."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.fit_records import Fit, without_slopes
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.structure_fits import (
    accept_structure,
    approached,
    near_records,
    settled,
)


@dataclass(frozen=True, slots=True, eq=False)
class JudgedFit:
    """A fit to whole records on its own bench, with its acceptance."""

    bench: StructureBench
    fit: Fit
    acceptance: Acceptance


def in_whole_records(
    bench: StructureBench,
    few: StructureBench,
    base: Fit,
    carried: Sequence[Fit],
    progress: Progress,
) -> list[JudgedFit]:
    """Fit the best candidates to whole records, accepted ones first.

    One record of each condition decides which of them are fitted to all.

    Args:
        bench: all records.
        few: one record of each condition.
        base: fit without effects.
        carried: fits in the longer window, best first.
        progress: receives one line for each fit.
    """
    few = replace(few, reach=bench.reach)
    near: list[tuple[StructureBench, Fit]] = []
    for fit in _worth_it(carried):
        explained = any(_explains(one) for one in near)
        if explained and fit.cost > STRUCTURE.explained_cost_ratio * carried[0].cost:
            continue
        progress(f"{words_of(fit.candidates)} in whole records")
        own, found = approached(few, fit.x, fit.candidates)
        near.append((own, without_slopes(found)))
    near.sort(key=lambda one: one[1].cost)
    done: list[JudgedFit] = []
    for own, fit in near:
        if fit.cost > near[0][1].cost + STRUCTURE.cost_above_best:
            break
        progress(f"{words_of(fit.candidates)} in all records")
        whole, found = settled(
            bench, fit.x, fit.candidates, near=near_records(own, fit)
        )
        done.append(JudgedFit(whole, found, accept_structure(whole, found, base)))
        done.sort(key=lambda one: (not one.acceptance.passed, one.fit.cost))
        # The slopes of all records are needed of the best fit alone.
        done[1:] = [replace(one, fit=without_slopes(one.fit)) for one in done[1:]]
    return done


def _explains(found: tuple[StructureBench, Fit]) -> bool:
    """Return whether a fit explains one record of each condition."""
    bench, fit = found
    limit = bench.policy.floor_chi2 * fit.residual.size
    return fit.chi2 * bench.coherence < limit


def _worth_it(carried: Sequence[Fit]) -> list[Fit]:
    """Return the fits that may be the best over whole records."""
    if not carried:
        return []
    best = carried[0].cost
    return [
        f
        for f in carried[: STRUCTURE.whole_fits]
        if f.cost < STRUCTURE.whole_cost_ratio * best
    ]
