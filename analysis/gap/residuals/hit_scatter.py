# SPDX-License-Identifier: MIT
"""Scatter from hit to hit: of the operator, of the joint, and trends."""

import itertools

import numpy as np
import scipy.stats

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS


def repeat_groups(
    hit: IntArray, level: FloatArray, preload: FloatArray
) -> list[IntArray]:
    """Return the records of each condition that was measured more than once."""
    keys = list(zip(hit.tolist(), level.tolist(), preload.tolist(), strict=True))
    groups = []
    for key in sorted(set(keys)):
        rows = np.array([i for i, k in enumerate(keys) if k == key])
        if rows.size > 1:
            groups.append(rows)
    return groups


def gain_scatter(
    gains: FloatArray,
    variances: FloatArray,
    groups: list[IntArray],
    policy: Policy = STANDARD,
) -> float:
    """Estimate the relative gain scatter from hit to hit.

    Repeats of a condition differ by scatter and noise alone, but they are few; all
    records together contain more information, but also the influence of a missing
    effect. The estimate from all records is therefore limited to the range between the
    likeliest value and the upper limit from the repeats: steps^2/(v + s^2) is a chi2
    pivot.

    Args:
        gains: regression of each residual on its response [-], shape (n_records,).
        variances: of the gains by noise alone, same shape.
        groups: records that repeat a condition.
        policy: with the least scatter, and the chance of its upper limit.

    Returns:
        Standard deviation of the gain [-].
    """
    grid = _scatter_grid() ** 2
    everywhere = _deviance(gains, variances, grid)
    wide = float(grid[int(np.argmin(everywhere))])
    pairs = [(i, j) for rows in groups for i, j in itertools.pairwise(rows.tolist())]
    if not pairs:
        return _significant(np.sqrt(wide), policy)
    first, second = (np.array(x) for x in zip(*pairs, strict=True))
    steps = (gains[first] - gains[second]) / np.sqrt(2.0)
    spread = (variances[first] + variances[second]) / 2
    low = float(grid[int(np.argmin(_deviance(steps, spread, grid)))])
    pivot = np.sum(steps**2 / (spread + grid[:, None]), axis=1)
    allowed = grid[pivot > scipy.stats.chi2.ppf(policy.scatter_chance, steps.size)]
    high = max(float(allowed.max(initial=0.0)), low)
    return _significant(np.sqrt(np.clip(wide, low, high)), policy)


def _significant(scatter: float, policy: Policy) -> float:
    """Return a scatter, or 0 if it is below that of any operator and joint."""
    return float(scatter) if scatter >= policy.least_scatter else 0.0


def without_trend(
    values: FloatArray,
    variances: FloatArray,
    patterns: FloatArray,
    policy: Policy = STANDARD,
) -> FloatArray:
    """Subtract the pattern that best explains the values of all records, if any.

    A trend over the records is not scatter, but would be counted as scatter and so be
    hidden. Only a pattern that is unlikely to occur by chance is subtracted. The
    information in a record varies (a soft hit has hardly any), so each is weighted by
    its own variance and the remaining scatter. Their weighted mean is kept: the fit of
    the base has already brought it to zero.

    Args:
        values: shape (n_records,).
        variances: of the values by noise alone, same shape.
        patterns: possible trends over the records, shape (n_patterns, n_records).
        policy: with the chance below which a pattern is a trend.

    Returns:
        Values minus their dependence on one pattern, shape (n_records,).
    """
    best, least = values, policy.trend_chance
    for pattern in patterns:
        q = pattern - pattern.mean()
        if q @ q < 1e-12 or values.size < 4:
            continue
        slope, squared, middle = _trend(values, variances, q)
        chance = float(scipy.stats.f.sf(squared, 1, values.size - 2))
        if chance < least:
            best, least = values - slope * (q - middle), chance
    return best


def _trend(
    values: FloatArray, variances: FloatArray, q: FloatArray
) -> tuple[float, float, float]:
    """Return the slope along a pattern, its squared ratio to its sd, and the mean.

    The mean is the weighted mean of the pattern.

    Source:
        Weighted least squares of a mean and a slope, the scatter by restricted
        maximum likelihood (Patterson and Thompson 1971) on the grid of scatters.
    """
    grid = _scatter_grid() ** 2
    total = variances + grid[:, None]
    weight = 1 / total
    columns = np.stack([np.ones_like(q), q], axis=1)
    normal = np.einsum("sr,ri,rj->sij", weight, columns, columns)
    right = np.einsum("sr,ri,r->si", weight, columns, values)
    solution = np.linalg.solve(normal, right[:, :, None])[:, :, 0]
    left = values - solution @ columns.T
    deviance = np.sum(left**2 * weight + np.log(total), axis=1)
    deviance += np.linalg.slogdet(normal)[1]
    at = int(np.argmin(deviance))
    slope = float(solution[at, 1])
    middle = float(weight[at] @ q / weight[at].sum())
    return slope, slope**2 / float(np.linalg.inv(normal[at])[1, 1]), middle


def _scatter_grid() -> FloatArray:
    """Return the grid of scatters [-]; the first is zero."""
    return np.concatenate(
        [
            [0.0],
            np.geomspace(RESIDUALS.smallest_scatter, RESIDUALS.largest_scatter, 360),
        ]
    )


def _deviance(x: FloatArray, v: FloatArray, grid: FloatArray) -> FloatArray:
    """Return -2 log likelihood of x ~ N(0, v + grid), shape of grid."""
    total = v[None, :] + grid[:, None]
    return np.asarray(np.sum(x**2 / total + np.log(total), axis=1))


def regress(
    residual: FloatArray, ways: FloatArray, basis: FloatArray, shrink: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Regress residuals on the ways to scatter, after whitening the force noise.

    Args:
        residual: over sigma, shape (n_records, n_rows).
        ways: over sigma, shape (n_records, n_ways, n_rows).
        basis: of the force noise, shape (n_records, n_kept, n_rows).
        shrink: of it, shape (n_records, n_kept, 1).

    Returns:
        Coefficients [-] and their variances, shape (n_records, n_ways) each.
    """
    both = np.concatenate([residual[:, None, :], ways], axis=1).transpose(0, 2, 1)
    both = both - basis.transpose(0, 2, 1) @ (shrink * (basis @ both))
    r, w = both[:, :, :1], both[:, :, 1:]
    turned = w.transpose(0, 2, 1)
    inverse = np.linalg.pinv(turned @ w)
    coefficients = (inverse @ (turned @ r))[:, :, 0]
    return coefficients, np.diagonal(inverse, axis1=1, axis2=2).copy()
