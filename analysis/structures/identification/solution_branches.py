# SPDX-License-Identifier: MIT
"""All admissible solutions around those that a search has found.

A solution that leaves an unknown open is one point of a branch, which is followed over
the box; and two directions of a joint may exchange their roles.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.structures.identification.stiffness_descent import (
    descend,
    with_value,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
)

# Two ends are one solution if every parameter agrees to this in ln.
_SAME = 0.02
# Most solutions whose directions are exchanged joint by joint.
_EXCHANGED = 4
# Most branches of solutions that are followed along undetermined unknowns ...
_FOLLOWED = 4
# ... and number of values of each such unknown over the whole box.
_HELD = 12
# Chi2 that differ by less than this are equal up to rounding.
_TIE = 1e-6
# More than this standard deviation in ln counts as not identifiable (100 %).
LARGEST_LOG_SD = 1.0


def followed(problem: StiffnessProblem, found: list[Optimum]) -> tuple[Optimum, ...]:
    """Return distinct ends, those along undetermined unknowns too.

    Solutions in which two directions of a joint have exchanged their roles are looked
    for from those that a search has found: starts at random miss some of them.
    """
    done: list[Optimum] = []
    found = _along_branches(problem, found, done)
    exchanged = [
        end
        for end in _exchanged(problem, found)
        if not any(_on_branch(end, branch) for branch in done)
    ]
    if exchanged:
        found = _along_branches(problem, found + exchanged, done)
    return _distinct(in_order(problem, found))


def _along_branches(
    problem: StiffnessProblem, found: list[Optimum], done: list[Optimum]
) -> list[Optimum]:
    """Add ends along undetermined unknowns, and the branches to those followed."""
    standing = admissible(found)
    limit = min(standing, key=lambda end: end.chi2).limit()
    for branch in _branches(problem, standing)[:_FOLLOWED]:
        if any(same_branch(branch, other) for other in done):
            continue
        done.append(branch)
        along = _open_ways(problem, branch, limit)
        if along:
            # Ends of random starts along undetermined unknowns are arbitrary.
            floor = min(end.chi2 for end in along) - _TIE * branch.noise()
            found = [end for end in found if not _idle(end, branch, floor)] + along
    return found


def _exchanged(problem: StiffnessProblem, found: Sequence[Optimum]) -> list[Optimum]:
    """Return admissible ends of descents with two directions of a joint exchanged."""
    limit = min(found, key=lambda end: end.chi2).limit()
    ends = [
        descend(problem, start)
        for end in _distinct(in_order(problem, admissible(found)))[:_EXCHANGED]
        for start in exchanged_starts(problem, end)
    ]
    return [end for end in ends if end.chi2 < limit]


def exchanged_starts(problem: StiffnessProblem, end: Optimum) -> list[FloatArray]:
    """Return the unknowns of an end with two directions of a joint exchanged.

    Args:
        problem: of the identification.
        end: of a search.

    Returns:
        Logarithms, each of shape (n_unknowns,), one for each pair of directions.
    """
    starts = []
    for one, other in combinations(range(problem.size), 2):
        if _joint_of(problem, one) == _joint_of(problem, other) != "":
            start = end.unknowns.copy()
            start[[one, other]] = start[[other, one]]
            starts.append(start)
    return starts


def _joint_of(problem: StiffnessProblem, at: int) -> str:
    """Return state and joint of a stiffness; empty for another unknown."""
    name = problem.names[at]
    return name.rpartition(".")[0] if name.endswith("_stiffness") else ""


def admissible(ends: Sequence[Optimum]) -> list[Optimum]:
    """Return the admissible ends."""
    limit = min(ends, key=lambda end: end.chi2).limit()
    return [end for end in ends if end.chi2 < limit]


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
        if is_open(one).any() and not any(same_branch(one, other) for other in kept):
            kept.append(one)
    return kept


def same_branch(one: Optimum, other: Optimum) -> bool:
    """Return whether two ends agree in all unknowns that both determine."""
    determined = ~(is_open(one) | is_open(other))
    return bool(np.all(np.abs(one.unknowns - other.unknowns)[determined] < _SAME))


def _idle(end: Optimum, branch: Optimum, floor: float) -> bool:
    """Return whether an end is only another point of a branch, and no better."""
    return _on_branch(end, branch) and end.chi2 >= floor


def _on_branch(end: Optimum, branch: Optimum) -> bool:
    """Return whether an end is another point of a branch."""
    return same_branch(end, branch) and bool(np.any(is_open(end)))


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
