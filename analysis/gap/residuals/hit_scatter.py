# SPDX-License-Identifier: MIT
"""Scatter from hit to hit: its sizes, its trends, and the hits that stand out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.tail_probabilities import f_above, f_limit
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.noise_models import chi2_sd
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_likelihood import (
    CompressedRecords,
    weigh,
    without_systematic,
)
from jointbench.analysis.gap.residuals.scatter_record import (
    HitScatter,
    ScatterDirection,
)
from jointbench.analysis.gap.residuals.scatter_sizes import (
    SizeProblem,
    bounded_by_repeats,
    descended,
    likeliest_sizes,
    of_repeats,
    regressed_sizes,
)


@dataclass(frozen=True, slots=True, eq=False)
class HitsSeen:
    """What is known of the hits, to distinguish scatter from trends.

    Attributes:
        patterns: possible trends over the records, shape (n_patterns, n_records).
        groups: records of each condition that was measured more than once.
        joints: directions that are the stiffness of a joint.
        unexplained: whether the records leave the model by more than noise beside every
            direction; it may then do so along them as well, in every repeat.
    """

    patterns: FloatArray
    groups: tuple[IntArray, ...]
    joints: frozenset[int] = frozenset()
    unexplained: bool = False


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


def estimate_scatter(
    records: CompressedRecords,
    directions: tuple[ScatterDirection, ...],
    seen: HitsSeen,
    dof: int,
    policy: Policy = STANDARD,
) -> HitScatter:
    """Estimate how far hits scatter along each direction.

    The mean of all hits is not scatter, neither is a trend: what varies at random is.
    All records together bear on the sizes, but a missing effect influences them;
    repeats bound the sizes, because repeats share every missing effect. A size that
    repeats exclude is the one they suggest if the model does not fit beside the
    directions either, and otherwise the largest that they allow. Where the records are
    far from the model even so, repeats alone count.

    Args:
        records: compressed along the columns.
        directions: in the order of their columns.
        seen: patterns and repeats.
        dof: number of residuals with weight.
        policy: thresholds.
    """
    direction = _direction_of_columns(directions)
    problem = SizeProblem(
        records,
        direction,
        _intercepts(records.along.shape),
        np.full(len(directions), np.inf),
        np.array([d.expected / d.scale for d in directions]),
    )
    joints = frozenset(k for k, d in enumerate(directions) if d.is_joint)
    beside = 1.0 + policy.chi2_limit * chi2_sd(dof)
    unexplained = bool(records.beside.sum() > beside * dof)
    seen = replace(seen, joints=joints, unexplained=unexplained)
    start = np.maximum(regressed_sizes(records, direction), 1e-4)
    found = _Estimate(problem, likeliest_sizes(problem, start), ())
    found = _within_repeats(found, seen)
    found = _with_systematic(found, seen, policy)
    trends = found.problem
    found = _correlated(found, problem.systematic, seen)
    found = _within_repeats(found, seen)
    size = np.where(found.size < policy.least_scatter, 0.0, found.size)
    problem, outstanding = found.problem, found.outstanding
    if problem.weighed(size).chi2 > policy.far_chi2 * dof and seen.groups:
        # Far off, a trend is not taken for scatter with a memory.
        size = likeliest_sizes(of_repeats(trends, seen.groups), start)
        size = np.where(size < policy.least_scatter, 0.0, size)
        problem, outstanding = replace(problem, rho=0.0), ()
    sd, values = _each_hit(problem, size, outstanding)
    return HitScatter(directions, size, problem.rho, sd, values, outstanding)


def with_unseen_hits(
    found: HitScatter, records: CompressedRecords, kept: IntArray
) -> HitScatter:
    """Return the scatter of all hits by the sizes of those that were seen.

    Args:
        found: of the hits seen.
        records: all of them, compressed.
        kept: hits that were seen, shape (n_seen,).
    """
    direction = _direction_of_columns(found.directions)
    sd = np.tile(found.size[direction], (len(records.along), 1))
    sd[kept] = found.sd
    hits = tuple((int(kept[record]), column) for record, column in found.outstanding)
    values = weigh(records, sd**2, found.rho).predicted
    return replace(found, sd=sd, values=values, outstanding=hits)


def _intercepts(shape: tuple[int, ...]) -> FloatArray:
    """Return X of one mean for each column: the mean of all hits is no scatter."""
    x = np.zeros((*shape, shape[1]))
    columns = np.arange(shape[1])
    x[:, columns, columns] = 1.0
    return x


def _each_hit(
    problem: SizeProblem,
    size: FloatArray,
    outstanding: tuple[tuple[int, int], ...],
) -> tuple[FloatArray, FloatArray]:
    """Return sd and expected deviation of each hit, (n_records, n_columns)."""
    sd = np.tile(size[problem.direction], (problem.records.along.shape[0], 1))
    for record, column in outstanding:
        sd[record, column] = RESIDUALS.outstanding_sd
    values = weigh(problem.records, sd**2, problem.rho).predicted
    for record, column in outstanding:
        usual = float(size[problem.direction[column]])
        sd[record, column] = np.hypot(usual, float(values[record, column]))
    return sd, values


@dataclass(frozen=True, slots=True, eq=False)
class _Estimate:
    """Sizes, with the systematic values and the hits that stand out so far."""

    problem: SizeProblem
    size: FloatArray
    outstanding: tuple[tuple[int, int], ...]


def _within_repeats(found: _Estimate, seen: HitsSeen) -> _Estimate:
    """Return the estimate with its sizes within what repeats allow."""
    if not seen.groups or not np.any(found.size > 0.0):
        return found
    free = replace(found.problem, highest=np.full(found.size.size, np.inf))
    repeats = of_repeats(_less(free, found.outstanding), seen.groups)
    wider = 1.0
    if free.rho > 0.0:
        # Correlated repeats differ by less than their scatter.
        lag = np.concatenate([np.diff(rows) for rows in seen.groups])
        wider = 1.0 / np.sqrt(1.0 - float(np.mean(free.rho**lag)))
    bound, size = bounded_by_repeats(
        free, repeats, found.size, wider=wider, likeliest=seen.unexplained
    )
    return replace(found, problem=bound, size=size)


def _less(problem: SizeProblem, outstanding: Sequence[tuple[int, int]]) -> SizeProblem:
    """Return the problem with the deviations of outstanding hits taken out."""
    if not outstanding:
        return problem
    sd = np.zeros(problem.records.along.shape)
    for record, column in outstanding:
        sd[record, column] = RESIDUALS.outstanding_sd
    values = weigh(problem.records, sd**2).predicted
    return replace(problem, records=problem.records.moved(values))


def _correlated(found: _Estimate, intercepts: FloatArray, seen: HitsSeen) -> _Estimate:
    """Return the estimate with correlated hits and no trends, if that is likelier.

    A slow drift of the scatter resembles a trend; the restricted likelihood, which
    charges for each systematic value, decides. It charges a trend as if one of 100 %
    were as likely as none; a joint that loosens does so by less, and what its trend is
    overcharged is given back. Of the correlations that the records do not exclude the
    largest is taken: a few hits hardly resolve it, and the mean of hits with a long
    memory is the least certain.
    """
    size = found.size
    if not np.any(size > 0.0) or len(found.problem.records.along) > (
        RESIDUALS.most_correlated
    ):
        return found
    least = found.problem.deviance(size) - RESIDUALS.correlation_gain
    least += 2.0 * _joint_trends(found, seen) * np.log(RESIDUALS.usual_trend)
    own_hits = _hits(intercepts.shape, found.outstanding)
    plain = replace(
        found.problem, systematic=np.concatenate([intercepts, own_hits], axis=2)
    )
    free = replace(plain, highest=np.full(size.size, np.inf))
    tried = [replace(free, rho=rho) for rho in RESIDUALS.correlations]
    # Trends have taken their share of the sizes; the steps between hits remain.
    white = likeliest_sizes(free, np.where(size > 0.0, size, 1e-4))
    starts = [white / np.sqrt(1.0 - problem.rho**2) for problem in tried]
    first = [p.deviance(own) for p, own in zip(tried, starts, strict=True)]
    reach = free.deviance(white) + RESIDUALS.correlation_reach
    best = found
    for at in np.argsort(first).tolist():
        if first[at] > reach:
            break
        own = likeliest_sizes(tried[at], starts[at])
        if (now := tried[at].deviance(own)) < least:
            best, least = _Estimate(tried[at], own, found.outstanding), now
    least += RESIDUALS.correlation_doubt
    for problem in tried if best is not found else ():
        if problem.rho > best.problem.rho:
            own = likeliest_sizes(problem, best.size)
            if problem.deviance(own) < least:
                best = _Estimate(problem, own, found.outstanding)
    return best


def _joint_trends(found: _Estimate, seen: HitsSeen) -> int:
    """Return how many of the systematic values are trends of the stiffness of a joint.

    All records deviate along a trend, those of the middle hit aside.
    """
    systematic = found.problem.systematic
    beyond = systematic[:, :, systematic.shape[1] :]
    trends = np.count_nonzero(beyond, axis=0) > 1
    columns = np.isin(found.problem.direction, list(seen.joints))
    return int(np.count_nonzero(trends[columns]))


@dataclass(frozen=True, slots=True, eq=False)
class _Systematic:
    """A possible systematic value: its column of X, and the hit if it is one hit's."""

    column: FloatArray
    hit: tuple[int, int] | None


def _with_systematic(found: _Estimate, seen: HitsSeen, policy: Policy) -> _Estimate:
    """Add trends and outstanding hits to X, one at a time, while they are unlikely."""
    if not np.any(found.size > 0.0):
        return found
    candidates = [*_trends(found.problem, seen), *_single_hits(found.problem)]
    for _ in range(RESIDUALS.most_systematic):
        best = _likeliest(found, candidates, seen, policy) if candidates else None
        if best is None:
            break
        chosen, found = best
        candidates = [c for c in candidates if c is not chosen]
    return found


def _likeliest(
    found: _Estimate,
    candidates: Sequence[_Systematic],
    seen: HitsSeen,
    policy: Policy,
) -> tuple[_Systematic, _Estimate] | None:
    """Return the systematic value that raises the likelihood most, if unlikely."""
    problem, size = found.problem, found.size
    left, score = without_systematic(problem.weighed(size), problem.systematic)
    columns = np.stack([c.column.ravel() for c in candidates], axis=1)
    information = np.einsum("rc,rc->c", columns, left @ columns)
    gain = (columns.T @ score) ** 2 / (1.0 + information)
    before = problem.deviance(size, restricted=False)
    hits = len(problem.records.along)
    best, least = None, 1.0
    for at in _most_likely(gain, candidates):
        chosen = candidates[at]
        if gain[at] < RESIDUALS.systematic_share * _least_gain(hits, policy):
            continue
        if chosen.hit and not _stands_out(found, chosen.hit, seen):
            continue
        more = np.concatenate([problem.systematic, chosen.column[:, :, None]], axis=2)
        tried = replace(problem, systematic=more)
        own, _ = descended(tried, size)
        chance = _chance(before - tried.deviance(own, restricted=False), hits)
        limit = policy.outstanding_chance if chosen.hit else policy.trend_chance
        if chance / limit < least:
            bad = (*found.outstanding, chosen.hit) if chosen.hit else found.outstanding
            own = likeliest_sizes(tried, own)
            best, least = (chosen, _Estimate(tried, own, bad)), chance / limit
    return best


def _most_likely(gain: FloatArray, candidates: Sequence[_Systematic]) -> list[int]:
    """Return the trends and the hits with the largest gains by first order."""
    order = np.argsort(-gain).tolist()
    trends = [at for at in order if candidates[at].hit is None]
    hits = [at for at in order if candidates[at].hit is not None]
    most = RESIDUALS.systematic_tried
    return [*trends[:most], *hits[:most]]


def _least_gain(count: int, policy: Policy) -> float:
    """Return the gain by first order of a trend whose chance is that of the policy.

    The sizes have absorbed the trend: it gains at most one unit a hit.
    """
    free = max(count - 2, 1)
    squared = f_limit(policy.trend_chance, 1, free)
    return count * squared / (squared + free)


def _chance(drop: float, count: int) -> float:
    """Return the chance of a drop of -2 log likelihood by one value of many hits."""
    free = max(count - 2, 1)
    squared = free * np.expm1(min(max(drop, 0.0) / max(count, 1), 50.0))
    return f_above(squared, 1, free)


def _trends(problem: SizeProblem, seen: HitsSeen) -> list[_Systematic]:
    """Return a trend of each column with each pattern."""
    found = []
    n, k = problem.records.along.shape
    for pattern in seen.patterns:
        q = pattern - pattern.mean()
        if q @ q < 1e-12 or n < RESIDUALS.least_hits:
            continue
        for column in range(k):
            x = np.zeros((n, k))
            x[:, column] = q / np.sqrt(np.mean(q**2))
            found.append(_Systematic(x, None))
    return found


def _single_hits(problem: SizeProblem) -> list[_Systematic]:
    """Return a deviation of each hit along each column."""
    n, k = problem.records.along.shape
    if n < RESIDUALS.least_hits:
        return []
    every = [(record, column) for record in range(n) for column in range(k)]
    columns = _hits((n, k), every)
    return [_Systematic(columns[:, :, at], hit) for at, hit in enumerate(every)]


def _hits(shape: tuple[int, ...], hits: Sequence[tuple[int, int]]) -> FloatArray:
    """Return X of a deviation of each of some hits along its column."""
    x = np.zeros((*shape[:2], len(hits)))
    for at, (record, column) in enumerate(hits):
        x[record, column, at] = 1.0
    return x


def _stands_out(found: _Estimate, hit: tuple[int, int], seen: HitsSeen) -> bool:
    """Return whether a hit deviates by itself, and not its whole condition.

    A condition that was hit once may show a missing effect, which changes the joint.
    """
    problem, (record, column) = found.problem, hit
    sd = np.tile(found.size[problem.direction], (len(problem.records.along), 1))
    sd[record, column] = RESIDUALS.outstanding_sd
    values = weigh(problem.records, sd**2, problem.rho).predicted[:, column]
    if abs(values[record]) < RESIDUALS.least_outstanding:
        return False
    own = [rows for rows in seen.groups if record in rows]
    if not own:
        return int(problem.direction[column]) not in seen.joints
    rest = np.mean([values[i] for i in own[0] if i != record])
    return bool(abs(values[record] - rest) > 0.5 * abs(values[record]))


def _direction_of_columns(directions: Sequence[ScatterDirection]) -> IntArray:
    """Return the direction of each column, shape (n_columns,)."""
    return np.concatenate(
        [np.full(len(d.columns), k) for k, d in enumerate(directions)]
    )
