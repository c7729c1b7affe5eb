# SPDX-License-Identifier: MIT
"""Search for the effect that a model of bolted bodies lacks.

The base is fitted in short windows from its nominal values, then to whole records.
Missing effects are sought in the first milliseconds, where model and measurement are in
phase and a base bounded to its priors cannot take them over. The best few are carried
to longer windows; the winner is fitted to whole records with every hit met where it
landed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.structure_fits import (
    accept_structure,
    approached,
    fitted_finely,
    near_records,
    one_of_each,
    settled,
)
from jointbench.analysis.gap.judgement.amplitudes import weakest_amplitude
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.judgement.rivals import rivals
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import CandidateFit, along
from jointbench.analysis.gap.search.descent import cost_at, minimise
from jointbench.analysis.gap.search.screening import Screening, screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE

SHORT = Resolution(STRUCTURE.base_windows[1])
LONGER = Resolution(STRUCTURE.base_windows[2])
UNTESTED = Screening((), 0.0, 0.0)
"""No directed tests: a base that explains the hits needs none."""


@dataclass(frozen=True, slots=True, eq=False)
class StructureOutcome:
    """Outcome of a search on bolted bodies.

    Attributes:
        outcome: base, best fit and its rivals.
        bench: on which the best fit was found.
        base_bench: on which the base was found.
    """

    outcome: SearchOutcome
    bench: StructureBench
    base_bench: StructureBench


@dataclass(frozen=True, slots=True, eq=False)
class JudgedFit:
    """A fit to whole records on its own bench, with its acceptance."""

    bench: StructureBench
    fit: Fit
    acceptance: Acceptance


@one_thread()
def search_structure(bench: StructureBench, progress: Progress) -> StructureOutcome:
    """Fit the base, and search for a missing effect if it does not explain the hits.

    Args:
        bench: as made, at the coarse floor.
        progress: receives one line for each step.
    """
    progress("base in short windows")
    few = bench.chosen(one_of_each(bench.campaign.hits))
    start = _base_in_windows(few)
    few = few.at(start, (), few.landing, few.table_floor)
    progress("base in whole records")
    bench = replace(bench, reach=STRUCTURE.final_reach)
    whole, base = _base_in_whole_records(bench, few, start)
    first = accept_structure(whole, base, base)
    if first.passed:
        return _complete(whole, base, first, UNTESTED)
    progress("directed tests")
    near = minimise(make_problem(few, ()), start, SHORT, iterations=8)
    screening = screen(few, near, few.candidates, resolution=SHORT)
    carried = _carried(few, near, screening, progress)
    done = _in_whole_records(bench, few, base, carried, progress)
    none = _complete(whole, base, first, screening)
    if not done:
        return none
    if found := needless(done[0], screening):
        return found
    return StructureOutcome(_judged(none.outcome, done), done[0].bench, whole)


def _complete(
    bench: StructureBench, base: Fit, judged: Acceptance, screening: Screening
) -> StructureOutcome:
    """Return the outcome that nothing is missing, or that nothing was found."""
    none = SearchOutcome(bench, base, judged, screening, base, judged, (), (base,))
    return StructureOutcome(none, bench, bench)


def needless(best: JudgedFit, screening: Screening) -> StructureOutcome | None:
    """Return the outcome without an effect where the best one is nearly off.

    Such a fit has found the records by its base, which is a further start for the base
    alone. What the base does not explain either is no reason to name the effect.
    """
    amplitude = weakest_amplitude(best.fit)
    if amplitude >= STRUCTURE.plain_amplitude:
        return None
    bench, base = settled(best.bench, best.fit.base, (), near=True)
    judged = accept_structure(bench, base, base)
    nothing = amplitude < bench.policy.amplitude_limit and best.acceptance.passed
    if not (judged.passed or nothing):
        return None
    return _complete(bench, base, judged, screening)


def _base_in_windows(few: StructureBench) -> FloatArray:
    """Fit the base from its nominal values, coarse to fine."""
    x = np.zeros(few.base_sd.size)
    for window in STRUCTURE.base_windows:
        floor = max(STRUCTURE.coarse_floor, few.table_floor)
        few = few.at(x, (), few.landing, floor)
        problem = make_problem(few, ())
        x = minimise(problem, x, Resolution(window), iterations=8, exact_slopes=False).x
    return x


def _base_in_whole_records(
    bench: StructureBench, few: StructureBench, start: FloatArray
) -> tuple[StructureBench, Fit]:
    """Fit the base to whole records: to all of them, unless it is far off.

    A base far off is fitted to one record of each condition, and its chi2 is that of
    all records.
    """
    few, fit = approached(replace(few, reach=bench.reach), start, ())
    if fit.chi2 * few.coherence < STRUCTURE.explaining_chi2 * fit.residual.size:
        return settled(bench, fit.x, (), near=True)
    whole = bench.at(fit.x, (), bench.landing, bench.table_floor)
    return whole, minimise(make_problem(whole, ()), fit.x, FULL, iterations=0)


def _carried(
    few: StructureBench, near: Fit, screening: Screening, progress: Progress
) -> list[Fit]:
    """Fit candidates in short windows, then the best of them in longer ones.

    A descent ends where it would hardly reach the best one so far.
    """
    fits: list[Fit] = []
    rival: float | None = None
    for candidate in _chosen(few, screening):
        progress(f"{candidate.label} in a short window")
        starts = _starts(few, near, screening, candidate)
        found = [
            minimise(
                s.problem,
                s.x,
                SHORT,
                iterations=STRUCTURE.short_iterations,
                rival=rival,
                exact_slopes=False,
            )
            for s in starts[: STRUCTURE.starts_kept]
        ]
        fits += sorted(found, key=lambda f: f.cost)[:1]
        rival = min(f.cost for f in fits)
    fits.sort(key=lambda f: score(few, f))
    longer: list[Fit] = []
    rival = None
    for fit in fits[: STRUCTURE.longer_fits]:
        progress(f"{fit.candidates[0].label} in a longer window")
        own = few.at(fit.base, fit.terms, few.landing, few.floor)
        longer.append(
            minimise(
                make_problem(own, fit.candidates),
                fit.x,
                LONGER,
                iterations=STRUCTURE.longer_iterations,
                rival=rival,
                exact_slopes=False,
            )
        )
        rival = min(f.cost for f in longer)
    return sorted(longer, key=lambda f: score(few, f))


def _chosen(few: StructureBench, screening: Screening) -> list[Candidate]:
    """Return the leaders of the directed tests, and those that are always tried.

    An effect leads at a few sites at most, else one that follows any residual would
    fill all places.
    """
    always = {e.effect.name for e in few.entries if e.always}
    chosen = [c for c in few.candidates if c.effect.name in always]
    others: list[Candidate] = []
    for c in screening.leaders(len(few.candidates)):
        same = sum(c.effect.name == one.effect.name for one in others)
        if c not in chosen and same < STRUCTURE.leading_sites:
            others.append(c)
    return others[: STRUCTURE.leaders] + chosen


def _starts(
    few: StructureBench, near: Fit, screening: Screening, candidate: Candidate
) -> list[CandidateFit]:
    """Return starts of a candidate, best first: along its tests, and far ones."""
    problem = make_problem(few, (candidate,))
    starts = [along(problem, near, d, SHORT) for d in screening.best(candidate, 2)]
    first = candidate.effect.parameters[0]
    for amplitude in first.far:
        for shape in start_grid(candidate):
            tail = shape.copy()
            tail[0] = first.encode(amplitude)
            for base in (np.zeros_like(near.x), near.x):
                x = np.concatenate([base, tail])
                starts.append(CandidateFit(problem, x, cost_at(problem, x, SHORT)))
    return sorted(starts, key=lambda s: s.cost)


def _in_whole_records(
    bench: StructureBench,
    few: StructureBench,
    base: Fit,
    carried: Sequence[Fit],
    progress: Progress,
) -> list[JudgedFit]:
    """Fit the best candidates to whole records, accepted ones first.

    One record of each condition decides which of them are fitted to all.
    """
    few = replace(few, reach=bench.reach)
    near: list[tuple[StructureBench, Fit]] = []
    for fit in _worth_it(carried):
        explained = any(_explains(one) for one in near)
        if explained and fit.cost > STRUCTURE.explained_cost_ratio * carried[0].cost:
            continue
        progress(f"{fit.candidates[0].label} in whole records")
        near.append(approached(few, fit.x, fit.candidates))
    near.sort(key=lambda one: one[1].cost)
    done: list[JudgedFit] = []
    for own, fit in near:
        if fit.cost > near[0][1].cost + STRUCTURE.cost_above_best:
            break
        progress(f"{fit.candidates[0].label} in all records")
        whole, found = settled(
            bench, fit.x, fit.candidates, near=near_records(own, fit)
        )
        done.append(JudgedFit(whole, found, accept_structure(whole, found, base)))
    return sorted(done, key=lambda one: (not one.acceptance.passed, one.fit.cost))


def _explains(found: tuple[StructureBench, Fit]) -> bool:
    """Return whether a fit explains one record of each condition."""
    bench, fit = found
    limit = bench.policy.floor_chi2 * fit.residual.size
    return fit.chi2 * bench.coherence < limit


def _judged(none: SearchOutcome, done: Sequence[JudgedFit]) -> SearchOutcome:
    """Compare the best fit with its rivals under one whitening."""
    best = done[0]
    fits = [best.fit, *(_alike(best, one.fit) for one in done[1:])]
    fits.sort(key=lambda f: score(best.bench, f))
    level = tuple(rivals(best.bench, fits)) if best.acceptance.passed else (best.fit,)
    return replace(
        none,
        bench=best.bench,
        best=best.fit,
        acceptance=best.acceptance,
        ranked=tuple(fits),
        level=level,
    )


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


def _alike(best: JudgedFit, fit: Fit) -> Fit:
    """Return a rival under the whitening of the best fit."""
    if best.bench.nonlinear(fit.candidates):
        return fitted_finely(best.bench, fit.x, fit.candidates, 3)
    problem = make_problem(best.bench, fit.candidates)
    return minimise(problem, fit.x, FULL, iterations=3, exact_slopes=False)
