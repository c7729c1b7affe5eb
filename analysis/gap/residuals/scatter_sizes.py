# SPDX-License-Identifier: MIT
"""Sizes of scatter by restricted maximum likelihood, with limits from repeats."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_likelihood import (
    CompressedRecords,
    Weighed,
    deviance,
    weigh,
    without_systematic,
)


@dataclass(frozen=True, slots=True, eq=False)
class SizeProblem:
    """Records whose sizes of scatter are wanted.

    Attributes:
        records: compressed along the columns.
        direction: direction of each column, shape (n_columns,), 0-based; columns of one
            direction share their size.
        systematic: X, shape (n_records, n_columns, n_systematic).
        highest: largest size of each direction, shape (n_directions,).
        expected: size that is stated, same shape; 0 where none is.
        rho: correlation between successive hits [-].
    """

    records: CompressedRecords
    direction: IntArray
    systematic: FloatArray
    highest: FloatArray
    expected: FloatArray
    rho: float = 0.0

    def weighed(self, size: FloatArray) -> Weighed:
        """Weigh the records by the scatter of those sizes."""
        each = np.broadcast_to(size[self.direction] ** 2, self.records.along.shape)
        return weigh(self.records, each, self.rho)

    def deviance(self, size: FloatArray, *, restricted: bool = True) -> float:
        """Return -2 log likelihood of sizes, (n_directions,), with their prior."""
        bare = deviance(self.weighed(size), self.systematic, restricted=restricted)
        return bare + self.surprise(size)

    def surprise(self, size: FloatArray) -> float:
        """Return -2 log of the prior of sizes: normal in the log of a stated size."""
        off = self.off(size)
        return float(off @ off)

    def off(self, size: FloatArray) -> FloatArray:
        """Return the logs of sizes over the stated ones, in prior sd."""
        stated = self.expected > 0.0
        near = np.maximum(size[stated], RESIDUALS.smallest_scatter)
        off = np.zeros(size.size)
        off[stated] = np.log(near / self.expected[stated]) / RESIDUALS.stated_spread
        return off


def likeliest_sizes(problem: SizeProblem, start: FloatArray) -> FloatArray:
    """Return the likeliest sizes; a size is 0 unless it is significant.

    Args:
        problem: records and systematic values.
        start: sizes to start from, shape (n_directions,).
    """
    size = np.clip(start, RESIDUALS.smallest_scatter, problem.highest)
    size, value = descended(problem, size)
    for direction in np.argsort(size).tolist():
        without = size.copy()
        without[direction] = 0.0
        loss = problem.deviance(without) - value
        # Other directions may take over what one of them no longer explains.
        if size[direction] == 0.0 or loss > RESIDUALS.clear_scatter_gain:
            continue
        if problem.expected[direction] > 0.0:
            continue
        without, least = descended(problem, without)
        if least - value < RESIDUALS.scatter_gain:
            size, value = without, least
    return size


def descended(problem: SizeProblem, size: FloatArray) -> tuple[FloatArray, float]:
    """Minimise the deviance over the logarithms of the sizes; sizes of 0 remain.

    Source:
        Gilmour, Thompson and Cullis 1995, Biometrics 51, 1440: Newton's method with the
        average of observed and expected information.
    """
    free = np.flatnonzero(size > 0.0)
    weighed = problem.weighed(size)
    value = deviance(weighed, problem.systematic) + problem.surprise(size)
    damping = RESIDUALS.scatter_damping
    for _ in range(RESIDUALS.scatter_iterations if free.size else 0):
        slope, curvature = _slopes(problem, weighed, size, free)
        scale = np.diag(np.maximum(np.diag(curvature), RESIDUALS.scatter_settled))
        moved = False
        while not moved and damping < RESIDUALS.most_damping:
            step = -np.linalg.solve(curvature + damping * scale, slope)
            if slope @ step > -RESIDUALS.scatter_settled:
                return size, value
            step = np.clip(step, -RESIDUALS.longest_step, RESIDUALS.longest_step)
            tried = size.copy()
            tried[free] = np.clip(
                size[free] * np.exp(0.5 * step),
                RESIDUALS.smallest_scatter,
                problem.highest[free],
            )
            there = problem.weighed(tried)
            now = deviance(there, problem.systematic) + problem.surprise(tried)
            moved = now < value
            damping = damping / 5.0 if moved else 4.0 * damping + 0.1
        if not moved:
            break
        gain = value - now
        size, value, weighed = tried, now, there
        if gain < RESIDUALS.scatter_settled:
            break
    return size, value


def _slopes(
    problem: SizeProblem, weighed: Weighed, size: FloatArray, free: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return gradient and information of the deviance by the log variances."""
    left, score = without_systematic(weighed, problem.systematic)
    n, k = problem.records.along.shape
    blocks, values = left.reshape(n, k, n, k), score.reshape(n, k)
    order = np.arange(n)
    between = np.eye(n)
    if problem.rho > 0.0:
        between = problem.rho ** np.abs(order[:, None] - order[None, :])
    traces = np.einsum("ikjk,ij->k", blocks, between)
    along = between @ values
    squares = np.sum(values * along, axis=0)
    variance = size[free] ** 2
    own = problem.direction[None, :] == free[:, None]
    slope = variance * (own @ (traces - squares))
    parts = variance[:, None, None] * np.where(own[:, None, :], along[None], 0.0)
    flat = parts.reshape(free.size, n * k)
    curvature = flat @ left @ flat.T
    curvature += np.diag(np.abs(slope))
    stated = np.where(problem.expected[free] > 0.0, 0.5, 0.0)
    slope += problem.off(size)[free] / RESIDUALS.stated_spread
    return slope, curvature + np.diag(stated / RESIDUALS.stated_spread**2)


def regressed_sizes(records: CompressedRecords, direction: IntArray) -> FloatArray:
    """Return rough sizes, from a regression of each record on its columns."""
    each = np.linalg.pinv(records.factor, rcond=1e-5)
    u = np.einsum("ikl,il->ik", each, records.along)
    count = int(direction.max()) + 1
    return np.array([np.sqrt(np.mean(u[:, direction == d] ** 2)) for d in range(count)])


def of_repeats(problem: SizeProblem, groups: Sequence[IntArray]) -> SizeProblem:
    """Return the problem of repeated conditions alone, each with values of its own.

    Repeats share every missing effect, so that no effect speaks through them; but for
    a trend with time, which is fitted as well where it was found.
    """
    rows = np.concatenate(groups)
    condition = np.repeat(np.arange(len(groups)), [g.size for g in groups])
    columns = problem.direction.size
    own = np.zeros((rows.size, columns, len(groups), columns))
    for column in range(columns):
        own[np.arange(rows.size), column, condition, column] = 1.0
    means = own.reshape(rows.size, columns, -1)
    return SizeProblem(
        problem.records.some(rows),
        problem.direction,
        np.concatenate([means, problem.systematic[rows]], axis=2),
        np.full(problem.highest.size, np.inf),
        problem.expected,
    )


def bounded_by_repeats(
    problem: SizeProblem,
    repeats: SizeProblem,
    size: FloatArray,
    *,
    wider: float,
    likeliest: bool,
) -> tuple[SizeProblem, FloatArray]:
    """Return the problem with limits by repeats, and the likeliest sizes within them.

    Args:
        problem: all records, without limits.
        repeats: problem of the repeats alone.
        size: likeliest sizes without limits, shape (n_directions,).
        wider: factor on what repeats suggest and allow.
        likeliest: whether the limit of a size that repeats exclude is the size that
            they suggest, and not the largest that they allow.
    """
    own = likeliest_sizes(repeats, np.where(size > 0.0, size, 1e-4))
    # A direction may take over what another one, now bounded, no longer explains.
    for _ in range(size.size):
        limits = wider * _repeat_limits(repeats, own, size)
        if likeliest:
            limits = np.where(np.isfinite(limits), wider * own, limits)
        problem = replace(problem, highest=np.minimum(problem.highest, limits))
        if np.all(size <= problem.highest):
            break
        size = likeliest_sizes(problem, np.minimum(size, problem.highest))
    return problem, size


def _repeat_limits(
    repeats: SizeProblem, likeliest: FloatArray, size: FloatArray
) -> FloatArray:
    """Return the largest size of each direction that repeats do not exclude.

    Args:
        repeats: problem of the repeats alone.
        likeliest: sizes by the repeats, shape (n_directions,).
        size: wanted sizes, same shape: a limit above is not sought.
    """
    bound = repeats.deviance(likeliest) + RESIDUALS.repeat_limit
    limits = np.full(size.size, np.inf)
    for direction in np.flatnonzero(size > likeliest).tolist():
        tried = likeliest.copy()
        tried[direction] = size[direction]
        if repeats.deviance(tried) < bound:
            continue
        low = np.log(max(likeliest[direction], RESIDUALS.smallest_scatter))
        high = np.log(size[direction])
        while high - low > RESIDUALS.limit_accuracy:
            middle = 0.5 * (low + high)
            tried[direction] = np.exp(middle)
            if repeats.deviance(tried) < bound:
                low = middle
            else:
                high = middle
        limits[direction] = np.exp(low)
    return limits
