# SPDX-License-Identifier: MIT
"""Estimate the noise of a lumped bench at a solution: channels, force, scatter."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.campaign import TAIL
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.converter_edge import with_converter_edge
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Settled
from jointbench.analysis.gap.residuals.hit_scatter import (
    gain_scatter,
    regress,
    repeat_groups,
    without_trend,
)
from jointbench.analysis.gap.residuals.joint_settling import (
    hit_stiffness,
    joint_at,
    mean_stiffness,
)
from jointbench.analysis.gap.residuals.lumped_residual import SomeBench, settle
from jointbench.analysis.gap.residuals.noise_models import (
    FORCE_SHAPES,
    Noise,
    channel_sigma,
    whitening_basis,
)
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import prepare_excitation
from jointbench.analysis.gap.response.predict_records import respond


def refine_noise(
    bench: SomeBench,
    base: FloatArray,
    terms: Sequence[Term],
    *,
    diverged: bool = False,
) -> SomeBench:
    """Return the bench with its noise estimated at a solution.

    Args:
        bench: measurement and model.
        base: of the solution, shape (n_base,).
        terms: of the solution.
        diverged: expand about the settling of the hits even if the solution is far
            from the records.
    """
    at = with_converter_edge(_centred(bench, base, terms), base, terms)
    model = at.response(base, terms)
    residual = model - bench.campaign.response
    bench.mask(residual)
    sigma = _channel_noise(at, model, residual)
    columns = _force_columns(bench, base, sigma)
    ways = _scatter_ways(at, base, terms, model, sigma)
    noise = replace(bench.noise, sigma=sigma)
    none = tuple(0.0 for _ in range(ways.shape[1]))
    bare = _with_noise(at, replace(noise, scatter=none), columns, ways)
    coefficients, variances = regress(
        (residual / sigma[:, :, None]).reshape(len(sigma), -1),
        ways,
        bare.basis,
        bare.shrink,
    )
    rise = at.rise(terms)
    known = at.excitation.conditions.settling
    if known is not None:
        coefficients[:, 1] -= np.log((np.exp(known) + rise) / (1.0 + rise))
    scatter = _scatter_of(at, coefficients, variances)
    noise = replace(noise, scatter=scatter)
    refined = _with_noise(at, noise, columns, ways)
    lost = np.linalg.norm(residual) > RESIDUALS.uninformative_share * np.linalg.norm(
        model
    )
    if len(scatter) < 2 or scatter[1] == 0.0 or lost:
        return settle(refined, None)
    share = scatter[1] ** 2 / (scatter[1] ** 2 + variances[:, 1])
    off = -coefficients[:, 1] * share / scatter[1]
    if diverged and np.abs(off).max() > RESIDUALS.diverged_reach:
        return settle(refined, None)
    off = np.clip(off, -RESIDUALS.settling_reach, RESIDUALS.settling_reach) * scatter[1]
    settling = np.log(
        np.maximum(np.exp(off) * (1.0 + rise) - rise, RESIDUALS.least_stiffness_factor)
    )
    expanded = _expanded(refined, settling, base, terms, columns)
    left = expanded.residual(base, terms, FULL)
    if left @ left > bench.policy.far_chi2 * bench.blocks.dof and not diverged:
        return settle(refined, None)
    return expanded


def _centred(bench: SomeBench, base: FloatArray, terms: Sequence[Term]) -> SomeBench:
    """Return the bench with the stiffness of each hit relative to the base's mean.

    A settling is the part of that stiffness that base and laws do not explain.
    """
    if bench.settled is None:
        return bench
    model = bench.campaign.model
    mean = mean_stiffness(model, base, bench.settled)
    hits = hit_stiffness(bench.excitation.conditions, bench.settled)
    kept = np.exp(mean - base[joint_at(model)] + hits)
    rest = np.maximum(kept - bench.rise(terms), RESIDUALS.least_stiffness_factor)
    return settle(bench, np.log(rest))


def _channel_noise(
    bench: SomeBench, model: FloatArray, residual: FloatArray
) -> FloatArray:
    """Return the noise of each record and channel, (n_records, n_channels)."""
    peak = np.abs(model).max(axis=2)
    sigma = channel_sigma(residual[:, :, bench.campaign.lead : -TAIL], peak)
    if bench.campaign.repeatability is not None:
        sigma = np.hypot(sigma, bench.campaign.repeatability * peak)
    return sigma


def _scatter_of(
    bench: SomeBench, coefficients: FloatArray, variances: FloatArray
) -> tuple[float, ...]:
    """Return the scatter along each way."""
    campaign = bench.campaign
    count = len(coefficients.T)
    if campaign.repeatability is not None:
        return (0.0,) * count
    groups = repeat_groups(campaign.hit, campaign.level, campaign.preload)
    patterns = _patterns(bench.excitation.conditions)
    return tuple(
        gain_scatter(
            without_trend(coefficients[:, i], variances[:, i], patterns, bench.policy),
            variances[:, i],
            groups,
            bench.policy,
        )
        for i in range(count)
    )


def _expanded(
    bench: SomeBench,
    settling: FloatArray,
    base: FloatArray,
    terms: Sequence[Term],
    columns: list[FloatArray],
) -> SomeBench:
    """Return the bench expanded about a settling, with its scatter whitened there.

    The slope of the expansion is then the same direction that is whitened, so that no
    part of the settling remains.
    """
    there = settle(bench, settling)
    sigma = bench.noise.sigma
    moved = there.response(base, terms)
    ways = _scatter_ways(there, base, terms, moved, sigma)
    slope = ways[:, 1].reshape(*sigma.shape, -1) * sigma[:, :, None]
    whitened = _with_noise(there, bench.noise, columns, ways)
    settled = Settled(base.copy(), slope, there.rise(terms))
    return replace(whitened, settled=settled)


def _patterns(conditions: HitConditions) -> FloatArray:
    """Return possible trends of a joint over the records, shape (2, n_records)."""
    return np.stack([np.log(conditions.preload), conditions.progress])


def _force_columns(
    bench: SomeBench, base: FloatArray, sigma: FloatArray
) -> list[FloatArray]:
    """Return responses to force noise over sigma, one array for each record."""
    first, last = bench.time_gate
    n, records = bench.excitation.growth.size, sigma.shape[0]
    if last - first >= n or bench.noise.force_sigma <= 0:
        return [np.zeros((0, sigma.shape[1] * n))] * records
    force = np.zeros((1, n))
    force[0, first] = bench.noise.force_sigma
    cases, grams = {}, {}
    for hit in sorted(set(bench.campaign.hit.tolist())):
        still = HitConditions(np.ones(1), np.zeros(1))
        rate = bench.campaign.sample_rate
        shaken = prepare_excitation(force, np.array([hit]), rate, still)
        y = respond(bench.campaign.model, bench.theta(base), shaken)[0]
        cases[hit] = _shifted(y, last - first)
        bench.mask(cases[hit])
        rows = cases[hit].transpose(1, 0, 2)
        grams[hit] = rows @ rows.transpose(0, 2, 1)
    return [
        _leading(cases[h], grams[h], s)
        for h, s in zip(bench.campaign.hit.tolist(), sigma, strict=True)
    ]


def _shifted(response: FloatArray, count: int) -> FloatArray:
    """Return a response delayed by 0 to count - 1 samples, (count, *its shape)."""
    out = np.zeros((count, *response.shape))
    for k in range(count):
        out[k, :, k:] = response[:, : response.shape[1] - k]
    return out


def _leading(rows: FloatArray, grams: FloatArray, sigma: FloatArray) -> FloatArray:
    """Return the few directions with most of the variance of unit noise.

    Args:
        rows: shape (count, n_channels, n_samples).
        grams: of the rows, channel by channel, shape (n_channels, count, count).
        sigma: noise that the rows are taken over, shape (n_channels,).
    """
    last = len(rows) - 1
    _, vectors = scipy.linalg.eigh(
        np.tensordot(sigma**-2.0, grams, 1),
        subset_by_index=(max(last + 1 - FORCE_SHAPES, 0), last),
    )
    shapes = np.tensordot(vectors.T, rows, 1) / sigma[:, None]
    return np.asarray(shapes.reshape(len(shapes), -1))


def _scatter_ways(
    bench: SomeBench,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
    sigma: FloatArray,
) -> FloatArray:
    """Return the ways in which hits scatter, over sigma, (n_records, n_ways, n_rows).

    First the operator: the acting force differs slightly from the measured one. Then
    each joint: its stiffness settles differently in each hit.
    """
    ways = [_harder(bench, base, terms, model)]
    n = len(bench.campaign.model.bodies)
    for i, link in enumerate(bench.campaign.model.links):
        if link.joint and not bench.campaign.continuous:
            moved = base.copy()
            moved[n + i] += RESIDUALS.scatter_step
            ways.append((bench.response(moved, terms) - model) / RESIDUALS.scatter_step)
    stacked = np.stack(ways, axis=1)
    bench.mask(stacked)
    stacked /= sigma[:, None, :, None]
    return stacked.reshape(len(sigma), len(ways), -1)


def _harder(
    bench: SomeBench, base: FloatArray, terms: Sequence[Term], model: FloatArray
) -> FloatArray:
    """Return the change of the response per relative change of the force.

    A clipped sample does not change.
    """
    entries = [a.entry for a in bench.actions(terms)]
    if all(e.law is None and e.shape is None for e in entries):
        return model.copy()
    spectrum = bench.excitation.spectrum * (1.0 + RESIDUALS.scatter_step)
    pushed = replace(bench, excitation=replace(bench.excitation, spectrum=spectrum))
    return (pushed.response(base, terms) - model) / RESIDUALS.scatter_step


def _with_noise(
    bench: SomeBench, noise: Noise, columns: list[FloatArray], ways: FloatArray
) -> SomeBench:
    """Return the bench with the whitening of `noise`."""
    parts = []
    for own, way in zip(columns, ways, strict=True):
        spread = [s * w[None, :] for s, w in zip(noise.scatter, way, strict=True) if s]
        parts.append(whitening_basis(np.concatenate([own, *spread])))
    kept = max(b.shape[0] for b, _ in parts)
    basis = np.zeros((len(parts), kept, ways.shape[2]))
    shrink = np.zeros((len(parts), kept, 1))
    for k, (b, s) in enumerate(parts):
        basis[k, : b.shape[0]] = b
        shrink[k, : b.shape[0], 0] = s
    return replace(bench, noise=noise, basis=basis, shrink=shrink, short={})
