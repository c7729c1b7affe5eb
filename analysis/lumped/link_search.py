# SPDX-License-Identifier: MIT
"""Find all distinct solutions of a joint identification, from many starts."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.link_problem import JointProblem, residuals, split

# Range of the starts, as a factor beyond the stiffnesses m omega^2 of the bench.
_START_SPREAD = 100.0
# Bounds of stiffness, as a factor beyond the starts.
_BOUND_SPREAD = 1e6
# Residual of a model that has lost an oscillating mode, above any measured one.
_FAR = 1e6
# Singular values below this mean a standard deviation of 1e8 in ln: not determined.
_FLAT = 1e-8
# A direction this uncertain in ln, 1e5, is open: solutions form a continuum.
_OPEN = 1e-5
# A point is no optimum if the next step predicts a decrease of chi2 above this ...
_STILL_FALLS = 1e-3
# ... or than this share of it.
_STILL_FALLS_SHARE = 1e-3
# Relative change of unknowns and of chi2 that ends a search from a start, ...
_ROUGH = 1e-6, 1e-8
# ... and the one that continues it from each distinct optimum.
_FINE = 1e-12, 1e-14
# Two optima are one if their distance in standard deviations is below this ...
_SAME_DISTANCE = 1.0
# ... or if all stiffnesses agree to this, whatever the uncertainty.
_SAME_LOG = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class LinkOptimum:
    """One local solution.

    Attributes:
        unknowns: see `JointProblem`, shape (size,).
        chi2: sum of the squared residuals [-].
        slopes: derivatives of the residuals, shape (n_rows, size).
        arrived: whether the search converged; in a narrow valley it may reach the step
            limit.
    """

    unknowns: FloatArray
    chi2: float
    slopes: FloatArray
    arrived: bool = True

    @property
    def flat(self) -> bool:
        """Whether the solution is one of a continuum: a direction is not determined."""
        size = np.linalg.svd(self.slopes, compute_uv=False)
        return bool(size.size < self.unknowns.size or size.min() < _OPEN)

    def covariance(self) -> FloatArray:
        """Return the covariance of the unknowns, large where undetermined."""
        _, size, directions = np.linalg.svd(self.slopes, full_matrices=True)
        floor = np.full(self.unknowns.size, _FLAT)
        floor[: size.size] = np.maximum(size, _FLAT)
        return np.asarray((directions.T / floor**2) @ directions)


def find_optima(
    problem: JointProblem, *, starts: int, seed: int
) -> tuple[LinkOptimum, ...]:
    """Search from many starts and keep the distinct optima.

    Args:
        problem: unknowns and measured modes.
        starts: number of starts, a Latin hypercube over decades of stiffness.
        seed: of the Latin hypercube.

    Returns:
        Distinct local solutions, the best first.

    Raises:
        BadData: the model has too few oscillating modes at every start.
    """
    rough = _descents(problem, _starts(problem, starts, seed), _ROUGH)
    if not rough:
        raise BadData(
            f"mode {problem.mode_numbers.max() + 1} was measured, but the model has "
            "fewer oscillating modes for every stiffness tried; "
            "link a body to the ground, or narrow the band"
        )
    distinct = [one.unknowns for one in _distinct(problem, rough)]
    return _distinct(problem, _descents(problem, distinct, _FINE))


def _descents(
    problem: JointProblem, starts: Sequence[FloatArray], ends: tuple[float, float]
) -> list[LinkOptimum]:
    """Return the optima reached from starts at which the model can be evaluated."""
    reached = (_descend(problem, start, ends) for start in starts)
    return [optimum for optimum in reached if optimum is not None]


def _distinct(
    problem: JointProblem, found: Sequence[LinkOptimum]
) -> tuple[LinkOptimum, ...]:
    """Return the best optimum, and all others that the data separate, by chi2."""
    kept: list[LinkOptimum] = []
    ranked = sorted(found, key=lambda one: one.chi2)
    for optimum in [ranked[0], *(one for one in ranked[1:] if one.arrived)]:
        if not any(_same(problem, optimum, other) for other in kept):
            kept.append(optimum)
    return tuple(kept)


def _starts(problem: JointProblem, count: int, seed: int) -> list[FloatArray]:
    """Return start points: the model's own values first, if it has them."""
    low, high = _stiffness_range(problem)
    random = np.random.default_rng(seed)
    links = [problem.model.links[i] for i in problem.stiff]
    points = []
    if links and all(link.stiffness > 0 for link in links):
        points.append(np.log([link.stiffness for link in links]))
    strata = random.permuted(
        np.tile(np.arange(count), (len(links), 1)), axis=1
    ) + random.random((len(links), count))
    points.extend((low + (high - low) * strata / max(count, 1)).T)
    middle = 0.5 * (low + high)
    rest = np.zeros(problem.weighed.size)
    return [
        # Damping grows with stiffness, so that no mode starts overdamped.
        np.concatenate([logs, _damping_start(problem, logs - middle), rest])
        for logs in points
    ]


def _damping_start(problem: JointProblem, relative: FloatArray) -> FloatArray:
    """Return start values of the damping unknowns, strictly inside their bounds."""
    if not problem.damped.size:
        return np.zeros(0)
    return np.asarray(np.exp(np.clip(0.5 * relative, -5, 5)))


def _stiffness_range(problem: JointProblem) -> tuple[float, float]:
    """Return ln of the softest and the stiffest start."""
    omega = 2 * np.pi * problem.measured.natural_frequency
    mass = [body.mass for body in problem.model.bodies]
    low = math.log(min(mass) * omega.min() ** 2 / _START_SPREAD)
    return low, math.log(max(mass) * omega.max() ** 2 * _START_SPREAD)


def _descend(
    problem: JointProblem, start: FloatArray, ends: tuple[float, float]
) -> LinkOptimum | None:
    """Return the optimum reached from one start, or None if it cannot be evaluated.

    Args:
        problem: unknowns and measured modes.
        start: shape (size,).
        ends: relative changes of the unknowns and of chi2 that end the search [-].
    """
    first = residuals(problem, start)
    if first is None:
        return None
    n_rows = first[0].size
    low, high = _stiffness_range(problem)
    n_stiff, n_damped = problem.stiff.size, problem.damped.size
    reach = math.log(_BOUND_SPREAD)
    lower = np.full(problem.size, -np.inf)
    upper = np.full(problem.size, np.inf)
    lower[:n_stiff], upper[:n_stiff] = low - reach, high + reach
    lower[n_stiff : n_stiff + n_damped] = 0.0
    evaluate = _remember_last(problem, n_rows)

    def values(unknowns: FloatArray) -> FloatArray:
        return evaluate(unknowns)[0]

    def slopes(unknowns: FloatArray) -> FloatArray:
        return evaluate(unknowns)[1]

    result = least_squares(
        values,
        np.clip(start, lower, upper),
        jac=slopes,
        bounds=(lower, upper),
        x_scale="jac",
        xtol=ends[0],
        ftol=ends[1],
        gtol=1e-12,
        max_nfev=200,
    )
    ended = residuals(problem, result.x)
    if ended is None:
        return None
    free = (result.x > lower) & (result.x < upper)
    arrived = _arrived(ended[0], ended[1][:, free])
    return LinkOptimum(result.x, float(ended[0] @ ended[0]), ended[1], arrived)


def _arrived(left: FloatArray, slopes: FloatArray) -> bool:
    """Return whether a Gauss-Newton step would not lower chi2 significantly."""
    directions, size, _ = np.linalg.svd(slopes, full_matrices=False)
    falls = float(np.sum((directions[:, size > _OPEN].T @ left) ** 2))
    return falls <= _STILL_FALLS + _STILL_FALLS_SHARE * float(left @ left)


def _remember_last(
    problem: JointProblem, n_rows: int
) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    """Return an evaluation that caches values and slopes of the last point."""
    last: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def evaluate(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        key = unknowns.tobytes()
        if key not in last:
            last.clear()
            far = np.full(n_rows, _FAR), np.zeros((n_rows, unknowns.size))
            last[key] = residuals(problem, unknowns) or far
        return last[key]

    return evaluate


def _same(problem: JointProblem, one: LinkOptimum, other: LinkOptimum) -> bool:
    """Return whether two optima are one: equal, or not separable by the data."""
    logs = split(problem, one.unknowns)[0] - split(problem, other.unknowns)[0]
    if np.all(np.abs(logs) < _SAME_LOG):
        return True
    way = one.unknowns - other.unknowns
    return any(
        float(np.sum((end.slopes @ way) ** 2)) < _SAME_DISTANCE**2
        for end in (one, other)
    )
