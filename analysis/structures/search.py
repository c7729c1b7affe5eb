# SPDX-License-Identifier: MIT
"""Many starts, one least-squares descent each, and what is distinct among the ends."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.structures.problem import (
    Optimum,
    Problem,
    residuals,
    states_apart,
)

# Damping starts at this fraction of stiffness over frequency.
_DAMPING_START = 1e-2
# Two ends are one solution if every parameter agrees to this in ln.
_SAME = 0.02
_MOST_STEPS = 100
# So many of the best ends are followed along what is open.
_FOLLOWED = 3
# Open parameters are held at these multiples of their best value.
_HELD_AWAY = (0.03, 0.1, 0.3, 3.0, 10.0, 30.0)


def descend(problem: Problem, start: FloatArray, fixed: Sequence[int] = ()) -> Optimum:
    """Go down from one start, some unknowns held.

    Args:
        problem: what is sought.
        start: logarithms, shape (n_unknowns,).
        fixed: numbers of the unknowns that stay.

    Returns:
        Where it ends.
    """
    parts = states_apart(problem)
    if len(parts) == 1:
        return _descend(problem, start, fixed)
    ends = []
    for part, own in parts:
        held = np.flatnonzero(np.isin(own, np.asarray(fixed, np.int64)))
        ends.append(_descend(part, start[own], held.tolist()))
    return _joined(problem, ends)


def _joined(problem: Problem, ends: Sequence[Optimum]) -> Optimum:
    """Put the ends of all states together."""
    unknowns = np.empty(problem.size)
    rows = sum(end.slopes.shape[0] for end in ends)
    slopes, begin = np.zeros((rows, problem.size)), 0
    for (_, own), end in zip(states_apart(problem), ends, strict=True):
        unknowns[own] = end.unknowns
        after = begin + end.slopes.shape[0]
        slopes[begin:after, own] = end.slopes
        begin = after
    return Optimum(unknowns, sum(end.chi2 for end in ends), slopes)


def _descend(problem: Problem, start: FloatArray, fixed: Sequence[int]) -> Optimum:
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


def find_optima(problem: Problem, *, starts: int, seed: int) -> tuple[Optimum, ...]:
    """Search from many starts and keep what is distinct, the best first.

    Args:
        problem: what is sought.
        starts: points of a Latin hypercube over the logarithms of the box.
        seed: of the points.

    Returns:
        Distinct ends. Where states share nothing each is searched on its own, and a
        rival is another end of one state beside the best of all others.
    """
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
    rivals.sort(key=lambda end: end.chi2)
    return (_joined(problem, best), *rivals)


def _search(problem: Problem, starts: int, seed: int) -> tuple[Optimum, ...]:
    """Search a problem as it is; see `find_optima`."""
    found = [descend(problem, start) for start in _starts(problem, starts, seed)]
    for one in sorted(found, key=lambda end: end.chi2)[:_FOLLOWED]:
        found += _open_ways(problem, one)
    kept: list[Optimum] = []
    for one in sorted(found, key=lambda end: end.chi2):
        if not any(
            np.all(np.abs(one.unknowns - other.unknowns) < _SAME) for other in kept
        ):
            kept.append(one)
    return tuple(kept)


def _open_ways(problem: Problem, best: Optimum) -> list[Optimum]:
    """Return fits with what nothing decides held elsewhere: they show how open it is.

    A descent along a valley stops wherever it begins, so that chance starts alone may
    all end within a narrow part of it.
    """
    spread = np.sqrt(np.diag(best.covariance()))
    ends = []
    for at in np.flatnonzero(spread > 1.0):
        for factor in _HELD_AWAY:
            start = best.unknowns.copy()
            start[at] += np.log(factor)
            if problem.low[at] < start[at] < problem.high[at]:
                ends.append(descend(problem, start, fixed=[int(at)]))
    return ends


def _starts(problem: Problem, count: int, seed: int) -> list[FloatArray]:
    """Spread stiffness over the box; damping follows at light damping ratios."""
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
