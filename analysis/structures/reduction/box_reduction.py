# SPDX-License-Identifier: MIT
"""Reduce an assembly once more, by its modes at points of the box of its joints."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.reduction.dense_modes import shifted_inverse
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)

# Trial points of the box, in addition to its corners of equal joints.
_TRIALS = 128
# Points tried before the basis grows again.
_AT_ONCE = 16
# Part of a direction outside of the basis below which it is dropped.
_DEPENDENT = 1e-6
# Modes beyond the wanted ones that are taken at each point.
_SPARE = 2
# The bound of the assembly may be this share of the tolerance, at most.
_OWN_SHARE = 0.5
# A second reduction to more than this share of the coordinates is not worth it.
_WORTH_IT = 0.6


@dataclass(frozen=True, slots=True)
class ReductionStep:
    """Result of one added point.

    Attributes:
        worst: largest bound of the points tried, relative frequency [-].
        size: of the basis.
    """

    worst: float
    size: int


@dataclass(frozen=True, slots=True, eq=False)
class BoxReduction:
    """A model for a whole box of joints.

    Attributes:
        model: the reduced model.
        weak: points whose bound the assembly itself keeps above the tolerance, the
            worst first.
        worst: the largest of these bounds, relative frequency [-].
    """

    model: ReducedModel
    weak: tuple[FloatArray, ...]
    worst: float


def reduce_box(
    whole: ReducedModel,
    tolerance: float,
    *,
    loads: FloatArray | None = None,
    progress: Callable[[ReductionStep], None] | None = None,
) -> BoxReduction:
    """Reduce to the modes of an assembly in a box of joint stiffnesses.

    The modes of the point with the largest bound are added until the bound of all trial
    points is within tolerance, or as good as that of the assembly. With many joints
    that takes all coordinates: then the assembly is kept as it is.

    Args:
        whole: the model of the assembly.
        tolerance: of the bound, relative frequency [-].
        loads: rows where forces act or motion is read, shape (n_loads, r): the response
            of the bodies to them is kept.
        progress: called after every point.

    Returns:
        The model.

    Source:
        Rozza et al. 2008, Arch. Comput. Methods Eng. 15, 229-275 (greedy choice).
    """
    turn = _start(whole, loads)
    trials = trial_points(len(whole.names), whole.box)
    weak: list[tuple[float, FloatArray]] = []
    point = trials[0]
    while trials:
        turn, own = _grown(whole, turn, point, tolerance)
        if own > _OWN_SHARE * tolerance:
            weak.append((own, point))
        if turn.shape[1] > _WORTH_IT * whole.size:
            weak += weak_points(whole, trials, tolerance)
            return _sorted(whole, weak)
        model = whole.restricted(turn)
        known = [one for _, one in weak] + ([point] if own <= tolerance else [])
        trials = [one for one in trials if not _among(one, known)]
        worst, trials = _open_points(model, trials, tolerance)
        if progress is not None:
            progress(ReductionStep(worst, model.size))
        if trials:
            point = trials[0]
    return _sorted(model, weak)


def _start(whole: ReducedModel, loads: FloatArray | None) -> FloatArray:
    """Return rigid motions and modes of the bodies, and their responses to loads.

    The bound relies on the order of the modes: with the bodies' own modes in the basis
    none is missing.
    """
    still = whole.strains.shape[1]
    stiffest = np.full(len(whole.names), whole.box[1])
    top = solve_reduced(whole, stiffest).eigenvalue[-1]
    own = np.flatnonzero(np.diag(whole.stiffness) <= top)
    turn = np.eye(whole.size)[:, np.union1d(np.arange(still), own)]
    if loads is None or not loads.shape[0]:
        return turn
    solve = shifted_inverse(whole.stiffness, whole.shift)
    first = solve(loads.T)
    return _extended(_extended(turn, first, still), solve(first), still)


def _sorted(model: ReducedModel, weak: list[tuple[float, FloatArray]]) -> BoxReduction:
    weak = sorted(weak, key=lambda one: -one[0])
    worst = weak[0][0] if weak else 0.0
    return BoxReduction(model, tuple(point for _, point in weak), worst)


def _among(point: FloatArray, others: list[FloatArray]) -> bool:
    return any(point is one for one in others)


def weak_points(
    whole: ReducedModel, points: list[FloatArray], tolerance: float
) -> list[tuple[float, FloatArray]]:
    """Return the points whose bound is too large for a second reduction."""
    bounds = [(relative_bound(whole, point), point) for point in points]
    return [one for one in bounds if one[0] > _OWN_SHARE * tolerance]


def _grown(
    whole: ReducedModel, turn: FloatArray, point: FloatArray, tolerance: float
) -> tuple[FloatArray, float]:
    """Append the modes of a point; return the assembly's own bound there."""
    modes = solve_reduced(whole, point, min(whole.modes + _SPARE, whole.size))
    still = whole.strains.shape[1]
    return _extended(turn, modes.shapes, still), relative_bound(whole, point)


def trial_points(count: int, box: tuple[float, float]) -> list[FloatArray]:
    """Spread points evenly over the logarithm of the box; two corners first."""
    from scipy.stats import qmc  # slow to import

    low, high = np.log(box[0]), np.log(box[1])
    corners = np.stack([np.zeros(count), np.ones(count)])
    if not count:
        return [np.zeros(0)]
    share = qmc.Sobol(count, seed=0).random(_TRIALS)
    return list(np.exp(low + (high - low) * np.concatenate([corners, share])))


def relative_bound(model: ReducedModel, point: FloatArray) -> float:
    """Return the largest bound over the frequency of all elastic modes [-]."""
    frequency, bound = frequency_bound(model, point)
    elastic = frequency > 0
    return float((bound[elastic] / frequency[elastic]).max(initial=0.0))


def _open_points(
    model: ReducedModel, points: list[FloatArray], tolerance: float
) -> tuple[float, list[FloatArray]]:
    """Return the worst bound found, and the remaining points, the worst first.

    A growing basis only improves: a point within tolerance remains so.
    """
    while points:
        some, rest = points[:_AT_ONCE], points[_AT_ONCE:]
        bounds = np.array([relative_bound(model, point) for point in some])
        order = [at for at in np.argsort(-bounds) if bounds[at] > tolerance]
        points = [*(some[at] for at in order), *rest]
        if order:
            return float(bounds[order[0]]), points
    return 0.0, points


def _extended(turn: FloatArray, shapes: FloatArray, still: int) -> FloatArray:
    """Append shapes without their part in the first coordinates, orthonormal."""
    new = shapes.copy()
    new[:still] = 0.0
    # A soft joint's mode is nearly rigid: its small elastic part counts as much.
    new /= np.maximum(np.linalg.norm(new, axis=0), 1e-300)
    for limit in (_DEPENDENT, 0.5):
        new = new - turn @ (turn.T @ new)
        vector, size, _ = np.linalg.svd(new, full_matrices=False)
        new = vector[:, size > limit]
    return np.concatenate([turn, new], axis=1)
