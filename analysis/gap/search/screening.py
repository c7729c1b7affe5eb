# SPDX-License-Identifier: MIT
"""Directed tests: predicted drop of chi2 by each effect, and its null distribution.

The amplitude of an effect enters linearly at zero, so one evaluation gives its
direction in the space of residuals. With the base and its priors projected out, the
squared score along this direction is the expected drop of chi2, and the corresponding
amplitude is a start value. The largest drop over the catalogue is the statistic of the
null test; under the null hypothesis it is the maximum of correlated chi2 variables,
drawn with the correlation of the directions.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.residuals.bench_protocol import Bench, WhitensTogether
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.response.threads import each
from jointbench.analysis.gap.search.search_settings import SEARCH

_Start = tuple[Candidate, FloatArray]
"""An effect with coordinates at which it is tested."""
PROBE = SEARCH.probe_amplitude
SCREEN = Resolution(oversampling=SEARCH.screening_steps)


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """Directed test of one effect at one shape.

    Attributes:
        candidate: the effect and site.
        coordinates: start for a fit, shape (n_parameters,).
        shift: predicted change of the fitted coordinates, shape (n_x,).
        drop: predicted drop of chi2.
        one_sided: True if only one sign is allowed.
        suggested: True if the shape was derived from the residual, so that the drop
            is biased.
        amplitude: to first order, without bounds [coordinate].
        amplitude_sd: of it [coordinate]; infinite if the fit hides the effect.
    """

    candidate: Candidate
    coordinates: FloatArray
    shift: FloatArray
    drop: float
    one_sided: bool
    suggested: bool
    amplitude: float
    amplitude_sd: float


@dataclass(frozen=True, slots=True, eq=False)
class Screening:
    """All directed tests of a fit.

    Attributes:
        directions: by decreasing drop.
        threshold: drop that a complete model exceeds in 0.5 % of cases.
        largest: the largest drop.
    """

    directions: tuple[Direction, ...]
    threshold: float
    largest: float

    def leaders(self, count: int) -> list[Candidate]:
        """Return the candidates of the largest drops."""
        found: list[Candidate] = []
        for d in self.directions:
            if d.candidate not in found and len(found) < count:
                found.append(d.candidate)
        return found

    def best(self, candidate: Candidate, count: int) -> list[Direction]:
        """Return the best starts of a candidate."""
        own = [d for d in self.directions if d.candidate == candidate]
        return own[:count]


def screen(
    bench: Bench,
    fit: Fit,
    candidates: Sequence[Candidate],
    *,
    resolution: Resolution = SCREEN,
    seed: int = 0,
) -> Screening:
    """Test every candidate at every point of its start grid.

    Args:
        bench: measurement and model.
        fit: a minimum, with or without effects.
        candidates: to be tested.
        resolution: of the residual; the fit must have the same window.
        seed: of the null draws.
    """
    starts = [(c, u) for c in candidates for u in start_grid(c)]
    fixed = len(starts)
    if resolution.window is None:
        starts += [(c, u) for c in candidates for u in bench.hints(fit, c)]
    tangent = _tangent(fit)
    tested = _tested(bench, fit, starts, tangent, resolution, fixed)
    return _judge(bench, starts, tangent, tested, seed)


@dataclass(frozen=True, slots=True, eq=False)
class _Tangent:
    """Space spanned by the fitted parameters: slopes and priors, orthonormal.

    Attributes:
        q: orthonormal columns of slopes above priors, shape (n_rows + n_x, n_x).
        r: upper triangular factor, shape (n_x, n_x).
        residual: of the data, then of the priors, shape (n_rows + n_x,).
    """

    q: FloatArray
    r: FloatArray
    residual: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Tested:
    """Directions of the effects, projected on the space of the fit.

    Attributes:
        left: components outside that space, shape (n_starts, n_rows + n_x).
        taken: coordinates of the components inside it, shape (n_starts, n_x).
        norm: squared lengths of the directions, shape (n_starts,).
        fixed: number of grid points; the other starts were derived from the tested
            residual, so they are not part of the statistic.
    """

    left: NDArray[np.float32]
    taken: FloatArray
    norm: FloatArray
    fixed: int


def _tested(
    bench: Bench,
    fit: Fit,
    starts: Sequence[_Start],
    tangent: _Tangent,
    resolution: Resolution,
    fixed: int,
) -> _Tested:
    """Return the directions of effects at their starts, several whitened together.

    Args:
        bench: measurement and model.
        fit: that is tested.
        starts: effects and coordinates.
        tangent: space of the fit.
        resolution: of the residual.
        fixed: number of grid points among the starts.
    """
    base = bench.residual(fit.base, fit.terms, resolution)
    left = np.empty((len(starts), tangent.q.shape[0]), dtype=np.float32)
    taken = np.empty((len(starts), fit.x.size))
    norm = np.empty(len(starts))
    count = SEARCH.tests_together if isinstance(bench, WhitensTogether) else 1

    def test(block: int) -> None:
        own = slice(block * count, (block + 1) * count)
        probes = [(c, *_probe(c, u)) for c, u in starts[own]]
        every = [(*fit.terms, Term(c, probe)) for c, probe, _ in probes]
        units = np.array([unit for _, _, unit in probes])
        rows = np.zeros((len(probes), tangent.q.shape[0]))
        changed = rows[:, : base.size]
        changed[:] = _residuals(bench, fit.base, every, resolution)
        changed -= base
        changed /= units[:, None]
        taken[own] = rows @ tangent.q
        norm[own] = np.sum(rows**2, axis=1)
        left[own] = rows - taken[own] @ tangent.q.T

    each(test, -(-len(starts) // count))
    return _Tested(left, taken, norm, fixed)


def _residuals(
    bench: Bench,
    base: FloatArray,
    every: Sequence[Sequence[Term]],
    resolution: Resolution,
) -> FloatArray:
    """Return the residual with each of several sets of effects, (n_sets, n_rows)."""
    if isinstance(bench, WhitensTogether):
        return bench.residuals(base, every, resolution)
    return np.array([bench.residual(base, terms, resolution) for terms in every])


def _tangent(fit: Fit) -> _Tangent:
    root = np.sqrt(fit.prior)
    q, r = np.linalg.qr(np.concatenate([fit.jacobian, np.diag(root)]))
    residual = np.concatenate([fit.residual, root * (fit.x - fit.centre)])
    # Column by column: projections on it take half the time.
    return _Tangent(np.asfortranarray(q), np.asarray(r), residual)


def _probe(candidate: Candidate, u: FloatArray) -> tuple[FloatArray, float]:
    """Return coordinates with a small amplitude of the effect, and that amplitude."""
    first = candidate.effect.parameters[0]
    probe = u.copy()
    if first.starts:
        return probe, 1.0
    probe[0] = PROBE
    return probe, PROBE


def start_grid(candidate: Candidate) -> list[FloatArray]:
    """Return the start grid of a candidate, amplitude 0 if a score test sets it."""
    axes = [
        [p.encode(s) for s in p.starts] or [0.0] for p in candidate.effect.parameters
    ]
    return [np.array(point) for point in itertools.product(*axes)]


def _judge(
    bench: Bench,
    starts: Sequence[_Start],
    tangent: _Tangent,
    tested: _Tested,
    seed: int,
) -> Screening:
    gram = (tested.left @ tested.left.T).astype(np.float64)
    score = tested.left @ tangent.residual
    left = np.diag(gram).copy()
    left = np.where(
        left > SEARCH.least_direction * np.maximum(tested.norm, 1e-300), left, np.inf
    )
    amplitude = -score / left
    minimum = tangent.q.T @ tangent.residual
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
        moved = start[0] if not first.starts else 1.0
        shift = -_solve(tangent.r, minimum + tested.taken[k] * moved)
        directions.append(
            Direction(
                candidate,
                start,
                shift,
                drop,
                bool(one_sided[k]),
                k >= tested.fixed,
                float(amplitude[k]),
                _sd(float(left[k])),
            )
        )
    counted = np.array([bench.phases(c) == 0 for c, _ in starts])
    counted[tested.fixed :] = False
    left = np.where(counted, left, np.inf)
    sided = one_sided & np.isfinite(left)
    threshold = null_threshold(gram, sided, left, seed, chance=bench.policy.null_chance)
    largest = max((d.drop for d in directions[: tested.fixed]), default=0.0)
    directions.sort(key=lambda d: -d.drop)
    return Screening(tuple(directions), threshold, largest)


def _sd(left: float) -> float:
    """Return the sd of an amplitude from the squared length of its direction."""
    return float(1.0 / np.sqrt(left)) if np.isfinite(left) else np.inf


def _solve(r: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a triangular system, singular if a parameter has no influence."""
    return np.asarray(np.linalg.lstsq(r, right, rcond=1e-13)[0])


def _phase_drop(drop: float, phases: int) -> float:
    """Correct the drop of an effect for the phases that it fits.

    Under the null hypothesis the amplitude is the mean of `phases` Rayleigh variables,
    not 0.
    """
    mean, sd = np.sqrt(np.pi / 2), np.sqrt(2 - np.pi / 2)
    excess = (np.sqrt(drop) - np.sqrt(phases) * mean) / sd
    return float(max(excess, 0.0) ** 2)


def null_threshold(
    gram: FloatArray,
    one_sided: BoolArray,
    left: FloatArray,
    seed: int,
    *,
    chance: float = STANDARD.null_chance,
) -> float:
    """Draw the largest drop under the null hypothesis; return its upper quantile.

    Args:
        gram: inner products of the projected directions, shape (n, n).
        one_sided: True if only one sign is allowed, shape (n,).
        left: their squared norms, inf if the base hides them, shape (n,).
        seed: of the draws.
        chance: that a draw exceeds the quantile [-].
    """
    keep = np.isfinite(left)
    if not keep.any():
        return 0.0
    size = np.sqrt(left[keep])
    correlation = gram[np.ix_(keep, keep)] / np.outer(size, size)
    values, vectors = np.linalg.eigh(correlation)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(seed)
    draws = rng.standard_normal((SEARCH.null_draws, root.shape[1])) @ root.T
    draws = np.where(one_sided[keep] & (draws < 0), 0.0, draws)
    return float(np.quantile(np.max(draws**2, axis=1), 1.0 - chance))
