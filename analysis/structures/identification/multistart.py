# SPDX-License-Identifier: MIT
"""Least-squares descents from many starts, and their distinct ends."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.frf_gains import EXACT
from jointbench.analysis.structures.identification.solution_branches import (
    admissible,
    followed,
    in_order,
    is_open,
    same_branch,
)
from jointbench.analysis.structures.identification.stiffness_descent import (
    descend,
    joined,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
    states_apart,
)

# Damping starts at this fraction of stiffness over frequency.
_DAMPING_START = 1e-2
# Ends with nominal masses that are used where masses are unknown.
_MOST_ENDS = 8
# Most further sets of starts, while some solution was reached by a single one.
_MORE_SETS = 3
_SEEDS_APART = 1000


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
    plain = _with_exact_gains(problem)
    if plain is not None:
        ends = find_optima(plain, starts=starts, seed=seed)[:_MOST_ENDS]
        return followed(problem, [descend(problem, one.unknowns) for one in ends])
    searched = [
        _search(part, starts, seed + at)
        for at, (part, _) in enumerate(states_apart(problem))
    ]
    if len(searched) == 1:
        return searched[0]
    best = [ends[0] for ends in searched]
    rivals = [
        joined(problem, [*best[:at], rival, *best[at + 1 :]])
        for at, ends in enumerate(searched)
        for rival in ends[1:]
    ]
    return (joined(problem, best), *(in_order(problem, rivals) if rivals else ()))


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
    return followed(problem, found)


def _with_exact_gains(problem: StiffnessProblem) -> StiffnessProblem | None:
    """Return the problem with exact gains of FRFs; None where they are exact.

    Far from its end, a fit that is free to scale FRFs stops at resonances of its own.
    """
    if all(one.gains == EXACT for one in problem.evidence):
        return None
    exact = tuple(replace(one, gains=EXACT) for one in problem.evidence)
    return replace(problem, evidence=exact)


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
    """Search an undivided problem; see `find_optima`.

    A solution that one start alone has reached shows that others may be missed (Good
    1953, Biometrika 40, 237-264): further sets of starts are then used.
    """
    found = [
        descend(problem, start) for start in starting_points(problem, starts, seed)
    ]
    for more in range(1, _MORE_SETS + 1):
        if not _reached_once(admissible(found)):
            break
        # Seeds of other states are the next numbers.
        points = starting_points(problem, starts, seed + more * _SEEDS_APART)
        found += [descend(problem, start) for start in points]
    return followed(problem, found)


def _reached_once(ends: Sequence[Optimum]) -> bool:
    """Return whether one of the solutions is the end of a single start."""
    for one in ends:
        if sum(_same_solution(one, other) for other in ends) == 1:
            return True
    return False


def _same_solution(one: Optimum, other: Optimum) -> bool:
    """Return whether ends are equal, or points of one branch."""
    if not np.array_equal(is_open(one), is_open(other)):
        return False
    return same_branch(one, other)


def starting_points(
    problem: StiffnessProblem, count: int, seed: int
) -> list[FloatArray]:
    """Spread stiffness over the box; damping follows at light damping ratios.

    Args:
        problem: of the identification.
        count: number of points.
        seed: of the Latin hypercube.

    Returns:
        Logarithms, each of shape (n_unknowns,).
    """
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
