# SPDX-License-Identifier: MIT
"""Least-squares descents from many starts, and their distinct ends."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
    residuals,
    states_apart,
)

# Damping starts at this fraction of stiffness over frequency.
_DAMPING_START = 1e-2
# Two ends are one solution if every parameter agrees to this in ln.
_SAME = 0.02
_MOST_STEPS = 100
# Ends with nominal masses that are used where masses are unknown.
_MOST_ENDS = 8
# Most branches of solutions that are followed along undetermined unknowns ...
_FOLLOWED = 4
# ... and number of values of each such unknown over the whole box.
_HELD = 12
# Chi2 that differ by less than this are equal up to rounding.
_TIE = 1e-6
# More than this standard deviation in ln counts as not identifiable (100 %).
LARGEST_LOG_SD = 1.0


def descend(
    problem: StiffnessProblem, start: FloatArray, fixed: Sequence[int] = ()
) -> Optimum:
    """Minimise from one start, with some unknowns fixed.

    Args:
        problem: of the identification.
        start: logarithms, shape (n_unknowns,).
        fixed: numbers of the fixed unknowns.

    Returns:
        The end of the descent.
    """
    parts = states_apart(problem)
    if len(parts) == 1:
        return _descend(problem, start, fixed)
    ends = []
    for part, own in parts:
        held = np.flatnonzero(np.isin(own, np.asarray(fixed, np.int64)))
        ends.append(_descend(part, start[own], held.tolist()))
    return _joined(problem, ends)


def _joined(problem: StiffnessProblem, ends: Sequence[Optimum]) -> Optimum:
    """Join the ends of all states."""
    unknowns = np.empty(problem.size)
    rows = sum(end.slopes.shape[0] for end in ends)
    slopes, begin = np.zeros((rows, problem.size)), 0
    for (_, own), end in zip(states_apart(problem), ends, strict=True):
        unknowns[own] = end.unknowns
        after = begin + end.slopes.shape[0]
        slopes[begin:after, own] = end.slopes
        begin = after
    return Optimum(unknowns, sum(end.chi2 for end in ends), slopes)


def _descend(
    problem: StiffnessProblem, start: FloatArray, fixed: Sequence[int]
) -> Optimum:
    free = np.setdiff1d(np.arange(problem.size), np.asarray(fixed, np.int64))
    base = np.clip(start, problem.low, problem.high)
    last: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def evaluate(part: FloatArray) -> tuple[FloatArray, FloatArray]:
        key = part.tobytes()
        if key not in last:
            last.clear()
            whole = base.copy()
            whole[free] = part
            last[key] = residuals(problem, whole)
        return last[key]

    def rows(part: FloatArray) -> FloatArray:
        return evaluate(part)[0]

    def slopes_of(part: FloatArray) -> FloatArray:
        return np.asarray(evaluate(part)[1][:, free])

    end = base.copy()
    if free.size:
        result = least_squares(
            rows,
            base[free],
            jac=slopes_of,
            bounds=(problem.low[free], problem.high[free]),
            x_scale="jac",
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-10,
            max_nfev=_MOST_STEPS,
        )
        end[free] = result.x
    left, slopes = residuals(problem, end)
    return Optimum(end, float(left @ left), slopes)


def find_optima(
    problem: StiffnessProblem, *, starts: int, seed: int
) -> tuple[Optimum, ...]:
    """Search from many starts and keep the distinct ends, the best first.

    Args:
        problem: of the identification.
        starts: points of a Latin hypercube over the logarithms of the box.
        seed: of the points.

    Returns:
        Distinct ends. States without shared unknowns are searched separately; a rival
        is then another end of one state with the best of all others.
    """
    if problem.masses is not None:
        return _with_masses(problem, starts, seed)
    searched = [
        _search(part, starts, seed + at)
        for at, (part, _) in enumerate(states_apart(problem))
    ]
    if len(searched) == 1:
        return searched[0]
    best = [ends[0] for ends in searched]
    rivals = [
        _joined(problem, [*best[:at], rival, *best[at + 1 :]])
        for at, ends in enumerate(searched)
        for rival in ends[1:]
    ]
    return (_joined(problem, best), *(in_order(problem, rivals) if rivals else ()))


def _with_masses(
    problem: StiffnessProblem, starts: int, seed: int
) -> tuple[Optimum, ...]:
    """Search with the nominal masses, then from the ends with the masses unknown.

    Masses of sensors couple all states, but move their unknowns little.
    """
    ends = find_optima(_without_masses(problem), starts=starts, seed=seed)
    missing = np.zeros(problem.size - ends[0].unknowns.size)
    found = [
        descend(problem, np.concatenate([one.unknowns, missing]))
        for one in ends[:_MOST_ENDS]
    ]
    return _followed(problem, found)


def _without_masses(problem: StiffnessProblem) -> StiffnessProblem:
    """Return the problem with the nominal masses of all sensors."""
    count = 0 if problem.masses is None else len(problem.masses.names)
    kept = slice(0, problem.size - count)
    return replace(
        problem,
        names=problem.names[kept],
        damping=problem.damping[kept],
        low=problem.low[kept],
        high=problem.high[kept],
        prior=problem.prior[kept],
        prior_sd=problem.prior_sd[kept],
        masses=None,
    )


def _search(problem: StiffnessProblem, starts: int, seed: int) -> tuple[Optimum, ...]:
    """Search an undivided problem; see `find_optima`."""
    found = [descend(problem, start) for start in _starts(problem, starts, seed)]
    return _followed(problem, found)


def _followed(problem: StiffnessProblem, found: list[Optimum]) -> tuple[Optimum, ...]:
    """Follow undetermined unknowns from the ends of a search; return distinct ends."""
    limit = min(found, key=lambda end: end.chi2).limit()
    standing = [end for end in found if end.chi2 < limit]
    for branch in _branches(problem, standing)[:_FOLLOWED]:
        along = _open_ways(problem, branch, limit)
        if along:
            # Ends of random starts along undetermined unknowns are arbitrary.
            floor = min(end.chi2 for end in along) - _TIE * branch.noise()
            found = [end for end in found if not _idle(end, branch, floor)] + along
    return _distinct(in_order(problem, found))


def in_order(problem: StiffnessProblem, ends: Sequence[Optimum]) -> list[Optimum]:
    """Sort ends, the best first.

    Differences of chi2 far below one are rounding and must not decide: among equal ends
    the least determined is first, then the one closest to the middle of the box.
    """
    best = min(ends, key=lambda end: end.chi2)
    tie = best.chi2 + _TIE * best.noise()
    middle = 0.5 * (problem.low + problem.high)

    def rank(end: Optimum) -> tuple[float, int, float]:
        away = float(np.abs(end.unknowns - middle).sum())
        chi2 = best.chi2 if end.chi2 <= tie else end.chi2
        return chi2, -int(np.count_nonzero(is_open(end))), round(away, 3)

    return sorted(ends, key=rank)


def is_open(end: Optimum) -> BoolArray:
    """Return which unknowns are not determined around an end."""
    return np.asarray(np.diag(end.covariance()) * end.noise() >= LARGEST_LOG_SD**2)


def _branches(problem: StiffnessProblem, ends: Sequence[Optimum]) -> list[Optimum]:
    """Return one end of each branch with an undetermined unknown."""
    kept: list[Optimum] = []
    for one in in_order(problem, ends) if ends else []:
        if is_open(one).any() and not any(_same_branch(one, other) for other in kept):
            kept.append(one)
    return kept


def _same_branch(one: Optimum, other: Optimum) -> bool:
    """Return whether two ends agree in all unknowns that both determine."""
    determined = ~(is_open(one) | is_open(other))
    return bool(np.all(np.abs(one.unknowns - other.unknowns)[determined] < _SAME))


def _idle(end: Optimum, branch: Optimum, floor: float) -> bool:
    """Return whether an end is only another point of a branch, and no better."""
    along = _same_branch(end, branch) and bool(np.any(is_open(end)))
    return along and end.chi2 >= floor


def _distinct(ends: Sequence[Optimum]) -> tuple[Optimum, ...]:
    kept: list[Optimum] = []
    for one in ends:
        if not any(
            np.all(np.abs(one.unknowns - other.unknowns) < _SAME) for other in kept
        ):
            kept.append(one)
    return tuple(kept)


def _open_ways(
    problem: StiffnessProblem, branch: Optimum, limit: float
) -> list[Optimum]:
    """Return the admissible fits with each undetermined unknown fixed over the box.

    A descent in a valley stops near its start, so random starts alone find an arbitrary
    part of it.
    """
    ends = []
    for at in np.flatnonzero(is_open(branch)):
        share = (np.arange(_HELD) + 0.5) / _HELD
        held = problem.low[at] + share * (problem.high[at] - problem.low[at])
        centre = branch.unknowns[at]
        for way in (held[held >= centre], held[held < centre][::-1]):
            last = branch.unknowns
            for value in way:
                end = descend(problem, with_value(last, int(at), value), [int(at)])
                if end.chi2 < limit:
                    last = end.unknowns
                    ends.append(end)
    return ends


def with_value(unknowns: FloatArray, at: int, value: float) -> FloatArray:
    """Return unknowns with one value replaced."""
    moved = unknowns.copy()
    moved[at] = value
    return moved


def _starts(problem: StiffnessProblem, count: int, seed: int) -> list[FloatArray]:
    """Spread stiffness over the box; damping follows at light damping ratios."""
    from scipy.stats import qmc  # slow to import

    low, high = np.log(problem.model.box[0]), np.log(problem.model.box[1])
    share = qmc.LatinHypercube(problem.size, seed=seed).random(count)
    points = low + (high - low) * share
    light = np.log(_DAMPING_START / np.sqrt(problem.model.shift))
    by_name = {name: at for at, name in enumerate(problem.names)}
    for at, name in enumerate(problem.names):
        if problem.damping[at]:
            partner = by_name.get(name.removesuffix("_damping") + "_stiffness")
            level = points[:, partner] if partner is not None else 0.5 * (low + high)
            points[:, at] = level + light
    return list(points)
