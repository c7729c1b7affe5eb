# SPDX-License-Identifier: MIT
"""Directed tests: how much chi2 would each effect take, and is that more than noise?

The amplitude of an effect enters linearly at OFF, so that one evaluation gives its
direction in the space of residuals. With the base and its priors projected out, the
squared score along it is the drop of chi2 to be expected, and the amplitude that goes
with it is a start value. The largest drop over the catalogue is the statistic of the
null test; under the null it is the maximum of correlated chi2 variables, drawn from
the directions' own correlation.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.bench import Bench, Stage
from jointbench.analysis.gap.effects import Candidate, Term
from jointbench.analysis.gap.fit import Fit

PROBE = 1e-3
SCREEN = Stage(oversampling=2)
DRAWS = 4000
QUANTILE = 0.995


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """One effect at one shape, tested.

    Attributes:
        candidate: the effect and site.
        coordinates: start for a fit, shape (n_parameters,).
        drop: chi2 that it is predicted to take.
        one_sided: True where only one sign is allowed.
    """

    candidate: Candidate
    coordinates: FloatArray
    drop: float
    one_sided: bool


@dataclass(frozen=True, slots=True, eq=False)
class Screening:
    """All directed tests of a fit.

    Attributes:
        directions: by falling drop.
        threshold: drop that a fit without a missing effect exceeds in 0.5 % of cases.
        largest: the largest drop met.
    """

    directions: tuple[Direction, ...]
    threshold: float
    largest: float

    def best(self, candidate: Candidate, count: int) -> list[Direction]:
        """Return the best starts of a candidate."""
        own = [d for d in self.directions if d.candidate == candidate]
        return own[:count]


def screen(
    bench: Bench,
    fit: Fit,
    candidates: Sequence[Candidate],
    *,
    seed: int = 0,
) -> Screening:
    """Test every candidate at every point of its start grid.

    Args:
        bench: measurement and model.
        fit: a minimum, possibly with effects switched on.
        candidates: what to test.
        seed: of the null draws.
    """
    starts = [(c, u) for c in candidates for u in start_grid(c)]
    base = bench.residual(fit.base, fit.terms, SCREEN)
    rows = np.empty((len(starts), base.size), dtype=np.float32)
    units = np.empty(len(starts))
    for k, (candidate, u) in enumerate(starts):
        probe, units[k] = _probe(candidate, u)
        terms = (*fit.terms, Term(candidate, probe))
        rows[k] = (bench.residual(fit.base, terms, SCREEN) - base) / units[k]
    return _judge(bench, fit, starts, rows, seed)


def _probe(candidate: Candidate, u: FloatArray) -> tuple[FloatArray, float]:
    """Return coordinates that switch the effect on a little, and by how much."""
    first = candidate.effect.parameters[0]
    probe = u.copy()
    if first.starts:
        return probe, 1.0
    probe[0] = PROBE
    return probe, PROBE


def start_grid(candidate: Candidate) -> list[FloatArray]:
    """Return the start coordinates of a candidate, amplitude 0 where it is scored."""
    axes = [
        [p.encode(s) for s in p.starts] or [0.0] for p in candidate.effect.parameters
    ]
    return [np.array(point) for point in itertools.product(*axes)]


def _judge(
    bench: Bench,
    fit: Fit,
    starts: Sequence[tuple[Candidate, FloatArray]],
    rows: NDArray[np.float32],
    seed: int,
) -> Screening:
    j = fit.jacobian
    hessian = j.T @ j + np.diag(fit.prior)
    inverse = np.linalg.pinv(hessian, hermitian=True)
    gradient = j.T @ fit.residual + fit.prior * (fit.x - fit.centre)
    cross = rows.astype(np.float64) @ j if rows.size < 2e7 else rows @ j
    gram = (rows @ rows.T).astype(np.float64)
    norm = np.diag(gram).copy()
    gram -= cross @ inverse @ cross.T
    score = rows.astype(np.float64) @ fit.residual - cross @ inverse @ gradient
    left = np.diag(gram).copy()
    seen = left > 1e-7 * np.maximum(norm, 1e-300)
    left = np.where(seen & (left > 0), left, np.inf)
    amplitude = -score / left
    directions = []
    one_sided = np.zeros(len(starts), dtype=bool)
    for k, (candidate, u) in enumerate(starts):
        first = candidate.effect.parameters[0]
        one_sided[k] = first.lower >= 0.0
        drop = float(score[k] ** 2 / left[k])
        start = u.copy()
        if not first.starts:
            low, high = first.bounds
            start[0] = np.clip(amplitude[k], 0.9 * low, 0.9 * high)
        if one_sided[k] and amplitude[k] <= 0:
            drop = 0.0
            start[0] = start[0] if first.starts else 1e-3
        phases = bench.phases(candidate)
        if phases:
            drop = _phase_drop(drop, phases)
        directions.append(Direction(candidate, start, drop, bool(one_sided[k])))
    fixed = np.array([bench.phases(c) == 0 for c, _ in starts])
    left = np.where(fixed, left, np.inf)
    threshold = null_threshold(gram, one_sided & np.isfinite(left), left, seed)
    directions.sort(key=lambda d: -d.drop)
    largest = directions[0].drop if directions else 0.0
    return Screening(tuple(directions), threshold, largest)


def _phase_drop(drop: float, phases: int) -> float:
    """Return the drop of an effect that chose its own phases, as one free of choice.

    Under the null the amplitude is the mean of `phases` Rayleigh variables, not 0.
    """
    mean, sd = np.sqrt(np.pi / 2), np.sqrt(2 - np.pi / 2)
    excess = (np.sqrt(drop) - np.sqrt(phases) * mean) / sd
    return float(max(excess, 0.0) ** 2)


def null_threshold(
    gram: FloatArray, one_sided: BoolArray, left: FloatArray, seed: int
) -> float:
    """Draw the largest drop under the null and return its upper quantile.

    Args:
        gram: inner products of the projected directions, shape (n, n).
        one_sided: where only one sign counts, shape (n,).
        left: their squared norms, inf where the base hides them, shape (n,).
        seed: of the draws.
    """
    keep = np.isfinite(left)
    if not keep.any():
        return 0.0
    size = np.sqrt(left[keep])
    correlation = gram[np.ix_(keep, keep)] / np.outer(size, size)
    values, vectors = np.linalg.eigh(correlation)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(seed)
    draws = rng.standard_normal((DRAWS, root.shape[1])) @ root.T
    draws = np.where(one_sided[keep] & (draws < 0), 0.0, draws)
    return float(np.quantile(np.max(draws**2, axis=1), QUANTILE))
