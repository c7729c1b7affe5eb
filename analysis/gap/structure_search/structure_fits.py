# SPDX-License-Identifier: MIT
"""Fits of hits on bolted bodies to whole records.

Records are approached on one of each condition, window by window, each hit met where it
landed; only then are all of them fitted.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FINE,
    FULL,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import (
    Fit,
    split,
    without_late_slopes,
    without_slopes,
)
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.search.descent import (
    Descent,
    cost_at,
    descend,
    fit_at,
    minimise,
)
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.slopes_on_hand import SlopesOnHand
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.hit_frames import window_count
from jointbench.analysis.gap.structure_search.slopes_again import with_slopes
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def in_windows(
    few: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    *,
    rival: float | None = None,
) -> tuple[StructureBench, Fit]:
    """Fit one record of each condition in windows; one far off in the first alone.

    Args:
        few: one record of each condition.
        start: base coordinates, then those of the effects.
        candidates: effects.
        rival: cost per row of the best fit so far, which a descent should reach.
    """
    x = start
    for window in STRUCTURE_SEARCH.approach_windows:
        few, fit = _settled_in(few, x, candidates, Resolution(window), rival=rival)
        x = fit.x
        if not near_records(few, fit):
            break
    return few, fit


def in_full(
    few: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    *,
    rival: float | None = None,
) -> tuple[StructureBench, Fit]:
    """Fit one record of each condition whole, from a fit in windows.

    Args:
        few: one record of each condition.
        start: base coordinates, then those of the effects.
        candidates: effects.
        rival: cost per row which a descent should reach.
    """
    return _settled_in(few, start, candidates, FULL, rival=rival)


def chi2_per_dof(bench: StructureBench, fit: Fit) -> float:
    """Return chi2 of a fit in a window, over the numbers as which its samples count.

    Args:
        bench: on which it was found.
        fit: with or without effects.
    """
    return float(fit.chi2 * bench.coherence / fit.residual.size)


def near_records(bench: StructureBench, fit: Fit) -> bool:
    """Return whether a fit is so near the records that they show where hits landed."""
    return chi2_per_dof(bench, fit) < STRUCTURE_SEARCH.near_chi2


def _settled_in(
    few: StructureBench,
    x: FloatArray,
    candidates: Sequence[Candidate],
    window: Resolution,
    *,
    rival: float | None = None,
) -> tuple[StructureBench, Fit]:
    """Fit a window, in turn with where each hit landed."""
    rows = _rows(few, window)
    landing = few.landing
    given: SlopesOnHand | None = None
    for k in range(STRUCTURE_SEARCH.approach_rounds):
        terms = split(x, few.base_sd.size, candidates)
        base = x[: few.base_sd.size]
        few = few.at(base, terms, landing, few.floor, window.window)
        problem = _weighed(few, candidates, window)
        before = cost_at(problem, x, window)
        how = Descent(
            window,
            iterations=STRUCTURE_SEARCH.approach_iterations,
            rival=None if rival is None else rival * rows,
            exact_slopes=False,
            least_drop=_least_drop(few, candidates, window),
            dof=_dof(few, window),
            sparing=few.uncertain,
            followed=_has_own_slopes_next(few, candidates) and k == 0,
        )
        fit = _stated(few, descend(problem, x, how, given))
        x = fit.x
        if k and before - fit.cost < STRUCTURE_SEARCH.settled_share * fit.cost:
            break
        if not near_records(few, fit) or _base_is_far_off(few, fit):
            break
        landing, _ = few.landed(fit.base, fit.terms, window.window)
        fit, given = _left_to_next(few, fit)
    return few, fit


def _base_is_far_off(few: StructureBench, fit: Fit) -> bool:
    """Return whether a base is so far off that it is not fitted to all records.

    Its chi2 need not be exact then. With an exact table, each step is cheaper.
    """
    if fit.candidates or not few.uncertain:
        return False
    return chi2_per_dof(few, fit) > STRUCTURE_SEARCH.explaining_chi2


def _left_to_next(bench: StructureBench, fit: Fit) -> tuple[Fit, SlopesOnHand | None]:
    """Return a fit without slopes, and slopes with which the next one may begin.

    Slopes are the largest array there is: none are kept twice. With laws they cost more
    than all else, so those of the last round do.
    """
    law = fit.jacobian.size and bench.nonlinear(fit.candidates)
    return without_slopes(fit), SlopesOnHand(fit.jacobian) if law else None


def _has_own_slopes_next(
    bench: StructureBench, candidates: Sequence[Candidate]
) -> bool:
    """Return whether a second round begins with slopes of its own.

    With laws it takes those of the first, and with an exact table each round is fitted
    to its end.
    """
    return bench.uncertain and not bench.nonlinear(candidates)


def _least_drop(
    bench: StructureBench, candidates: Sequence[Candidate], window: Resolution
) -> float:
    """Return the drop of the cost below which a fit need not continue."""
    least = STRUCTURE_SEARCH.table_drop if bench.uncertain else 0.0
    if not bench.nonlinear(candidates):
        return least
    return max(least, STRUCTURE_SEARCH.law_drop * _rows(bench, window))


def _dof(bench: StructureBench, window: Resolution) -> float | None:
    """Return as how many numbers records count where the modal table is uncertain.

    Frequencies of closed modes make the valleys of the cost long and narrow: a base far
    off crept along them for minutes.
    """
    return _rows(bench, window) / bench.coherence if bench.uncertain else None


def _rows(bench: StructureBench, window: Resolution) -> int:
    """Return the samples of all records in a window."""
    records, channels, _ = bench.blocks.shape
    return records * channels * window_count(bench.campaign.hits, window.window)


def settled(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    *,
    near: bool,
    rival: float | None = None,
) -> tuple[StructureBench, Fit]:
    """Fit all whole records, in turn with where each hit landed.

    Args:
        bench: all records.
        start: base coordinates, then those of the effects.
        candidates: effects.
        near: whether the start is near the records: each hit is met where it landed
            before the first step, which would move such a start away again.
        rival: cost that is to be reached; a fit that would need very many more steps
            is left where it is, and its slopes are those of the step before.
    """
    bench = _landed(bench, start, candidates, near=near)
    followed = _has_own_slopes_next(bench, candidates)
    fit = _whole(bench, start, candidates, rival=rival, followed=followed)
    for _ in range(STRUCTURE_SEARCH.settling_rounds):
        landing, before = bench.landing, fit.cost
        fit, given = _left_to_next(bench, fit)
        near = near_records(bench, fit)
        if near:
            landing, _ = bench.landed(fit.base, fit.terms)
        bench = bench.at_rest()  # or it keeps its whitening beside the next one
        bench = bench.at(fit.base, fit.terms, landing, bench.floor)
        fit = _whole(bench, fit.x, candidates, given, rival=rival)
        if rival is not None and fit.cost - rival > SEARCH.patience * abs(
            before - fit.cost
        ):
            break
        least = (
            STRUCTURE_SEARCH.settled_share if near else STRUCTURE_SEARCH.approach_share
        )
        if before - fit.cost < least * fit.cost:
            break
    if near and not bench.nonlinear(candidates):
        if rival is not None:
            return bench, fit
        fit = without_late_slopes(fit)  # or they are kept beside those at the end
        return bench, with_slopes(bench, fit)
    fit, given = _left_to_next(bench, fit)
    steps = STRUCTURE_SEARCH.fine_iterations
    return bench, fitted_finely(bench, fit.x, candidates, steps, given)


def met_at(
    bench: StructureBench, start: FloatArray, candidates: Sequence[Candidate]
) -> tuple[StructureBench, Fit]:
    """Return the fit of all whole records at a start, each hit met where it landed.

    It has no slopes, which take ten times as long where a law is integrated.

    Args:
        bench: all records.
        start: base coordinates, then those of the effects.
        candidates: effects.
    """
    bench = _landed(bench, start, candidates, near=True)
    return bench, fit_at(make_problem(bench, candidates), start, FINE)


def _landed(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    *,
    near: bool,
) -> StructureBench:
    """Return the bench at a start, about where its hits landed if that is near."""
    n = bench.base_sd.size
    terms = split(start, n, candidates)
    windows = (*STRUCTURE_SEARCH.landing_windows, None) if near else (None,)
    bench = bench.at(start[:n], terms, bench.landing, bench.table_floor, windows[0])
    for window, following in pairwise(windows):
        landing, _ = bench.landed(start[:n], terms, window)
        bench = bench.at(start[:n], terms, landing, bench.floor, following)
    return bench


def fitted_finely(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    steps: int,
    known: SlopesOnHand | None = None,
) -> Fit:
    """Fit whole records with the time integration that is judged.

    Args:
        bench: all records.
        start: coordinates.
        candidates: effects.
        steps: most steps, if a law is integrated at all.
        known: slopes there, which laws keep until a step fails; see `descend`.
    """
    problem = _weighed(bench, candidates, FINE)
    if not bench.nonlinear(candidates):
        return minimise(problem, start, FULL, iterations=0)
    how = Descent(FINE, iterations=steps, jacobian_resolution=FULL, exact_slopes=False)
    return _stated(bench, descend(problem, start, how, known))


def _whole(
    bench: StructureBench,
    start: FloatArray,
    candidates: Sequence[Candidate],
    known: SlopesOnHand | None = None,
    *,
    rival: float | None = None,
    followed: bool = False,
) -> Fit:
    """Fit whole records, hits as expanded."""
    law = bench.nonlinear(candidates)
    how = Descent(
        FULL,
        iterations=STRUCTURE_SEARCH.whole_iterations,
        rival=rival,
        exact_slopes=False,
        least_drop=_least_drop(bench, candidates, FULL),
        dof=_dof(bench, FULL),
        sparing=bench.uncertain,
        followed=followed,
        promises=None if law else STRUCTURE_SEARCH.promises,
    )
    problem = _weighed(bench, candidates, FULL)
    return _stated(bench, descend(problem, start, how, known))


def _weighed(
    bench: StructureBench, candidates: Sequence[Candidate], window: Resolution
) -> FitProblem:
    """Return a least-squares problem; beside friction, masses stay as weighed.

    Friction of a joint is that of no formula. What a law leaves is the same in all hits
    of a point, and in a record it is one amplitude and one phase of each mode, but
    samples count as independent. With masses, stiffnesses and slip in proportion the
    responses hardly change, so that a percent of the masses was worth less than the
    error of the law. Priors that are as narrow as those of weighed bodies count as
    often as samples show such an error.

    Args:
        bench: measurement and model.
        candidates: effects.
        window: of the records.
    """
    problem = make_problem(bench, candidates)
    if not any(c.effect.has_sliders for c in candidates):
        return problem
    hits, prior = bench.campaign.hits, problem.prior.copy()
    modes = len(bench.campaign.bodies.modes_near(hits.band))
    count = window_count(hits, window.window)
    of_point = len(hits.names) / np.unique(hits.point).size
    alike = of_point * count / max(2 * modes, 1)
    weighed = np.flatnonzero(bench.base_sd < STRUCTURE_SEARCH.weighed_sd)
    prior[weighed] *= max(alike / bench.coherence, 1.0)
    return replace(problem, prior=prior)


def _stated(bench: StructureBench, fit: Fit) -> Fit:
    """Return a fit with the priors as stated."""
    problem = make_problem(bench, fit.candidates)
    return replace(fit, prior=problem.prior, cost=fit.chi2 + problem.penalty(fit.x))
