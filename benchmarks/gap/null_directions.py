# SPDX-License-Identifier: MIT
"""Directions of the null test, projected again: its check and what widens it."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import prepare_excitation
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.search.screening import PROBE, SCREEN, start_grid

HIDDEN = 1e-7
"""Share of a direction that must be left when the base has taken its part."""


@dataclass(frozen=True, slots=True, eq=False)
class Directions:
    """What each effect would change, with the base projected out, of length 1.

    Attributes:
        rows: shape (n_directions, n_rows + n_base), residuals and then priors.
        one_sided: where only one sign is allowed, shape (n_directions,).
    """

    rows: FloatArray
    one_sided: BoolArray


def fixed_starts(bench: LumpedBench) -> list[tuple[Candidate, FloatArray]]:
    """Return the start grid of every effect without a phase of its own."""
    return [
        (candidate, start)
        for candidate in bench.candidates
        if bench.phases(candidate) == 0
        for start in start_grid(candidate)
    ]


def directions(bench: LumpedBench, fit: Fit) -> Directions:
    """Project the directions off base and priors by least squares.

    The engine keeps what is left in single precision; this is its check in double.
    """
    plain = bench.residual(fit.base, (), SCREEN)
    prior = np.diag(np.sqrt(fit.prior))
    base, _ = np.linalg.qr(np.concatenate([fit.jacobian, prior]))
    kept, one_sided = [], []
    for candidate, start in fixed_starts(bench):
        first = candidate.effect.parameters[0]
        probe = start.copy()
        if not first.starts:
            probe[0] = PROBE
        moved = bench.residual(fit.base, (Term(candidate, probe),), SCREEN)
        row = np.concatenate([moved - plain, np.zeros(fit.n_base)])
        left = row - base @ (base.T @ row)
        if left @ left > HIDDEN * (row @ row):
            kept.append(left / np.linalg.norm(left))
            one_sided.append(first.lower >= 0.0)
    return Directions(np.array(kept), np.array(one_sided))


def linearised_drops(
    tested: Directions, count: int, rng: np.random.Generator
) -> FloatArray:
    """Draw the largest drop of chi2 under the null, shape (count,)."""
    values, vectors = np.linalg.eigh(tested.rows @ tested.rows.T)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = rng.standard_normal((count, len(root))) @ root.T
    draws = np.where(tested.one_sided & (draws < 0), 0.0, draws)
    return np.asarray(np.max(draws**2, axis=1))


def score_variance(bench: LumpedBench, fit: Fit, tested: Directions) -> FloatArray:
    """Return the variance of each score, 1 where the noise is as whitened.

    The force noise is propagated sample by sample inside the time gate, in place of the
    few smooth shapes that the engine whitens.

    Returns:
        Shape (n_directions,).
    """
    first, last = bench.time_gate
    width, records = last - first, bench.campaign.hit.size
    force = np.zeros((width, bench.campaign.force.shape[1]))
    force[:, first:last] = bench.noise.force_sigma * np.eye(width)
    rows = tested.rows[:, : -fit.n_base].reshape(len(tested.rows), records, -1)
    variance = np.ones(len(rows))
    for k, hit in enumerate(bench.campaign.hit):
        excitation = prepare_excitation(
            force,
            np.full(width, hit),
            bench.campaign.sample_rate,
            HitConditions(np.ones(width), np.zeros(width)),
        )
        shaken = respond(bench.campaign.model, bench.theta(fit.base), excitation)
        bench.mask(shaken)
        shaken = (shaken / bench.noise.sigma[k][None, :, None]).reshape(width, -1)
        basis, shrink = bench.basis[k], bench.shrink[k][:, 0]
        along = rows[:, k] @ basis.T
        seen = rows[:, k] - (along * shrink) @ basis
        variance += np.sum((seen @ shaken.T) ** 2, axis=1)
        variance += np.sum(along**2 * ((1.0 - shrink) ** 2 - 1.0), axis=1)
    return variance
