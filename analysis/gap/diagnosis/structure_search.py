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

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.judgement.rivals import rivals
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FINE,
    FULL,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import CandidateFit, along
from jointbench.analysis.gap.search.descent import cost_at, minimise
from jointbench.analysis.gap.search.screening import Screening, screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.structure_bench.hit_campaign import HitRecords
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE

SHORT = Resolution(STRUCTURE.base_windows[1])
LONGER = Resolution(STRUCTURE.base_windows[2])


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
    whole, base = _base_in_whole_records(bench, few, start)
    first = accept_structure(whole, base, base)
    progress("directed tests")
    near = minimise(make_problem(few, ()), start, SHORT, iterations=8)
    screening = screen(few, near, few.candidates, resolution=SHORT)
    none = SearchOutcome(whole, base, first, screening, base, first, (), (base,))
    if first.passed:
        return StructureOutcome(none, whole, whole)
    carried = _carried(few, near, screening, progress)
    done = _in_whole_records(bench, few, base, carried, progress)
    if not done:
        return StructureOutcome(none, whole, whole)
    best = done[0]
    return StructureOutcome(_judged(none, done), best.bench, whole)


def one_of_each(hits: HitRecords) -> IntArray:
    """Return the first record of each combination of point, torque and level."""
    seen: dict[tuple[float, ...], int] = {}
    for k in range(len(hits.names)):
        key = (float(hits.point[k]), float(hits.torque[k]), float(hits.level[k]))
        seen.setdefault(key, k)
    return np.array(sorted(seen.values()), dtype=np.int64)


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
    reach = STRUCTURE.final_reach
    r = make_problem(few, ()).residual(start, LONGER)
    if float(r @ r) * few.coherence < STRUCTURE.near_chi2 * r.size:
        return settled(replace(bench, reach=reach), start, (), bench.table_floor)
    x = _whole(replace(few, reach=reach), start, ()).x
    whole = replace(bench, reach=reach).at(x, (), bench.landing, bench.table_floor)
    return whole, minimise(make_problem(whole, ()), x, FULL, iterations=0)


def settled(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    floor: float,
) -> tuple[StructureBench, Fit]:
    """Fit whole records, in turn with where each hit landed.

    Args:
        bench: all records.
        start: base coordinates, then those of the effects.
        candidates: effects.
        floor: error of the model, as a share of the peak [-].
    """
    bench = _met(bench, start, candidates, floor)
    fit = _whole(bench, start, candidates)
    for _ in range(STRUCTURE.settling_rounds):
        landing = bench.landing
        near = fit.chi2 < STRUCTURE.near_chi2 * bench.blocks.dof
        if near:
            landing, _ = bench.landed(fit.base, fit.terms)
        bench = bench.at(fit.base, fit.terms, landing, floor)
        before, fit = fit.cost, _whole(bench, fit.x, candidates)
        least = STRUCTURE.settled_share if near else STRUCTURE.approach_share
        if before - fit.cost < least * fit.cost:
            break
    return bench, _fine(bench, fit.x, candidates, STRUCTURE.fine_iterations)


def _met(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    floor: float,
) -> StructureBench:
    """Return the bench at a start; with laws, about where its hits landed.

    Laws have approached the records: a fit to hits at their points would move them
    away again.
    """
    n = bench.base_sd.size
    terms = split(start, n, candidates)
    bench = bench.at(start[:n], terms, bench.landing, floor)
    if not bench.nonlinear(candidates):
        return bench
    for window in STRUCTURE.landing_windows:
        landing, _ = bench.landed(start[:n], terms, window)
        bench = bench.at(start[:n], terms, landing, floor)
    return bench


def _fine(
    bench: StructureBench, x: FloatArray, candidates: Sequence[Candidate], steps: int
) -> Fit:
    """Fit whole records with the time integration that is judged.

    Args:
        bench: all records.
        x: coordinates.
        candidates: effects.
        steps: most steps, if a law is integrated at all.
    """
    problem = make_problem(bench, candidates)
    if not bench.nonlinear(candidates):
        return minimise(problem, x, FULL, iterations=0)
    return minimise(
        problem,
        x,
        FINE,
        iterations=steps,
        jacobian_resolution=FULL,
        exact_slopes=False,
    )


def _whole(
    bench: StructureBench, start: FloatArray, candidates: Sequence[Candidate]
) -> Fit:
    """Fit whole records, hits as expanded."""
    return minimise(
        make_problem(bench, candidates),
        start,
        FULL,
        iterations=STRUCTURE.whole_iterations,
        exact_slopes=False,
    )


def _carried(
    few: StructureBench, near: Fit, screening: Screening, progress: Progress
) -> list[Fit]:
    """Fit candidates in short windows, then the best of them in longer ones."""
    fits: list[Fit] = []
    for candidate in _chosen(few, screening):
        progress(f"{candidate.label} in a short window")
        starts = _starts(few, near, screening, candidate)
        found = [
            minimise(
                s.problem,
                s.x,
                SHORT,
                iterations=STRUCTURE.short_iterations,
                exact_slopes=False,
            )
            for s in starts[: STRUCTURE.starts_kept]
        ]
        fits += sorted(found, key=lambda f: f.cost)[:1]
    fits.sort(key=lambda f: score(few, f))
    longer = []
    for fit in fits[: STRUCTURE.longer_fits]:
        progress(f"{fit.candidates[0].label} in a longer window")
        own = few.at(fit.base, fit.terms, few.landing, few.floor)
        problem = make_problem(own, fit.candidates)
        longer.append(
            minimise(
                problem,
                fit.x,
                LONGER,
                iterations=STRUCTURE.longer_iterations,
                exact_slopes=False,
            )
        )
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


@dataclass(frozen=True, slots=True, eq=False)
class _WholeFit:
    """A fit to whole records on its own bench, with its acceptance."""

    bench: StructureBench
    fit: Fit
    acceptance: Acceptance


def _in_whole_records(
    bench: StructureBench,
    few: StructureBench,
    base: Fit,
    carried: Sequence[Fit],
    progress: Progress,
) -> list[_WholeFit]:
    """Fit the best candidates to whole records, accepted ones first."""
    done: list[_WholeFit] = []
    bench = replace(bench, reach=STRUCTURE.final_reach)
    for fit in _worth_it(carried):
        progress(f"{fit.candidates[0].label} in whole records")
        start = _approached(few, fit)
        own, found = settled(bench, start, fit.candidates, bench.table_floor)
        done.append(_WholeFit(own, found, accept_structure(own, found, base)))
    return sorted(done, key=lambda one: (not one.acceptance.passed, one.fit.cost))


def _approached(few: StructureBench, fit: Fit) -> FloatArray:
    """Return a start in whole records: with nonlinear laws, window by window."""
    if not few.nonlinear(fit.candidates):
        return fit.x
    for window in STRUCTURE.law_windows:
        few, fit = _settled_in(few, fit, Resolution(window))
    return fit.x


def _settled_in(
    few: StructureBench, fit: Fit, window: Resolution
) -> tuple[StructureBench, Fit]:
    """Fit a window, in turn with where each hit landed."""
    landing = few.landing
    for _ in range(STRUCTURE.law_rounds):
        few = few.at(fit.base, fit.terms, landing, few.floor)
        problem = make_problem(few, fit.candidates)
        before = cost_at(problem, fit.x, window)
        fit = minimise(
            problem,
            fit.x,
            window,
            iterations=STRUCTURE.law_iterations,
            exact_slopes=False,
        )
        if before - fit.cost < STRUCTURE.settled_share * fit.cost and landing.any():
            break
        if fit.chi2 > STRUCTURE.near_chi2 * fit.residual.size:
            break
        landing, _ = few.landed(fit.base, fit.terms, window.window)
    return few, fit


def _judged(none: SearchOutcome, done: Sequence[_WholeFit]) -> SearchOutcome:
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


def _alike(best: _WholeFit, fit: Fit) -> Fit:
    """Return a rival under the whitening of the best fit."""
    if best.bench.nonlinear(fit.candidates):
        return _fine(best.bench, fit.x, fit.candidates, 3)
    problem = make_problem(best.bench, fit.candidates)
    return minimise(problem, fit.x, FULL, iterations=3, exact_slopes=False)


def accept_structure(bench: StructureBench, fit: Fit, base: Fit) -> Acceptance:
    """Judge a fit of whole records by its chi2 and by the deviations of its base.

    A base can take over a loose bolt at an inconspicuous chi2 if one of its parameters
    deviates by many sd, so chi2 alone does not decide.

    Args:
        bench: on which the fit was found.
        fit: to be judged.
        base: fit without effects.
    """
    dof = bench.blocks.dof / bench.coherence
    chi2 = fit.chi2 / dof
    policy = bench.policy
    allowed = policy.floor_chi2
    if fit.candidates:
        allowed += policy.floor_chi2_share * max(base.chi2 / dof - 1.0, 0.0)
    deviation = float(np.abs(fit.prior_deviations).max())
    reason = ""
    if chi2 > allowed:
        reason = f"chi2/dof is {chi2:.4g}, the limit is {allowed:.4g}"
    elif deviation > policy.floor_prior_limit:
        worst = bench.base_names[int(np.argmax(np.abs(fit.prior_deviations)))]
        reason = f"{worst} is {deviation:.1f} sd from its nominal value"
    return Acceptance(
        passed=not reason,
        reason=reason,
        excess=chi2 - 1.0,
        allowed=allowed - 1.0,
        remaining=None,
        remaining_allowed=0.0,
        unexplained=bool(reason),
        left=None,
    )
