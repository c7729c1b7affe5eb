# SPDX-License-Identifier: MIT
"""Estimate the noise of a lumped bench at a solution: channels, force, scatter."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.model.campaign import TAIL, Campaign
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.converter_edge import with_converter_edge
from jointbench.analysis.gap.residuals.converter_gains import (
    clips,
    gain_columns,
    gains_of,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import HitGains, Settled
from jointbench.analysis.gap.residuals.hit_scatter import (
    HitsSeen,
    estimate_scatter,
    repeat_groups,
    with_unseen_hits,
)
from jointbench.analysis.gap.residuals.joint_settling import (
    hit_stiffness,
    joint_at,
    mean_stiffness,
)
from jointbench.analysis.gap.residuals.lumped_residual import (
    LumpedResidual,
    SomeBench,
    settle,
)
from jointbench.analysis.gap.residuals.noise_models import (
    FORCE_SHAPES,
    Noise,
    channel_sigma,
    whitening_basis,
    whitening_of_all,
)
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_directions import (
    scatter_columns,
    scatter_directions,
)
from jointbench.analysis.gap.residuals.scatter_likelihood import (
    CompressedRecords,
    compress,
)
from jointbench.analysis.gap.residuals.scatter_record import (
    CHANNEL_GAIN,
    HitScatter,
    ScatterDirection,
    no_scatter,
)
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import prepare_excitation
from jointbench.analysis.gap.response.predict_records import respond


def refine_noise(
    bench: SomeBench,
    base: FloatArray,
    terms: Sequence[Term],
    *,
    without: Sequence[int] = (),
) -> SomeBench:
    """Return the bench with its noise estimated at a solution.

    Args:
        bench: measurement and model.
        base: of the solution, shape (n_base,).
        terms: of the solution.
        without: records that are held out of the estimate.
    """
    if not clips(bench, terms):
        return _refined(replace(bench, gains=None, short={}), base, terms, without)
    # Gains estimated beside wrong gains are wrong to second order.
    for _ in range(RESIDUALS.gain_rounds):
        bench = _at_gains(_refined(bench, base, terms, without), base, terms)
    return bench


def _at_gains(bench: SomeBench, base: FloatArray, terms: Sequence[Term]) -> SomeBench:
    """Return the bench expanded about the gains of its hits, if that fits better."""
    scatter = bench.noise.scatter
    if not np.any(scatter.sd[:, list(gain_columns(scatter))] > 0.0):
        return bench
    ahead = [
        t
        for t, a in zip(terms, bench.actions(terms), strict=True)
        if a.entry.shape is None
    ]
    anchor = replace(bench, gains=None).response(base, ahead)
    gains = HitGains(gains_of(bench, terms, scatter), anchor, np.zeros_like(anchor))
    there = replace(bench, gains=gains, short={})
    ways = scatter_columns(there, base, terms, there.response(base, terms))
    slope = ways[:, list(gain_columns(scatter))].reshape(
        len(ways), anchor.shape[1], *anchor.shape[1:]
    )
    slope = np.einsum("rccn->rcn", slope) * bench.noise.sigma[:, :, None]
    columns = _force_columns(there, base, bench.noise.sigma)
    whitened = _with_noise(there, bench.noise, columns, ways)
    expanded = replace(whitened, gains=replace(gains, slope=slope))
    before, after = (b.residual(base, terms, FULL) for b in (bench, expanded))
    return expanded if after @ after < before @ before else bench


def _refined(
    bench: SomeBench, base: FloatArray, terms: Sequence[Term], without: Sequence[int]
) -> SomeBench:
    """Return the bench with its noise estimated at a solution and at known gains."""
    seen = ~np.isin(np.arange(len(bench.campaign.hit)), without)
    at = with_converter_edge(_centred(bench, base, terms), base, terms)
    model = at.response(base, terms)
    residual = model - bench.campaign.response
    bench.mask(residual)
    if not np.isfinite(np.vdot(residual, residual)):
        return settle(bench, None)  # a joint that diverges shows nothing of the noise
    sigma = _channel_noise(at, model, residual, seen)
    columns = _force_columns(bench, base, sigma)
    at = replace(at, noise=replace(bench.noise, sigma=sigma))
    ways = scatter_columns(at, base, terms, model)
    scatter = _scatter(at, residual, ways, columns, terms, seen)
    refined = _with_noise(at, replace(at.noise, scatter=scatter), columns, ways)
    lost = np.linalg.norm(residual) > RESIDUALS.uninformative_share * np.linalg.norm(
        model
    )
    if scatter.joint_size == 0.0 or lost:
        return settle(refined, None)
    size, off = scatter.joint_size, -scatter.joint_values
    off = np.clip(
        off, -RESIDUALS.settling_reach * size, RESIDUALS.settling_reach * size
    )
    rise = at.rise(terms)
    settling = np.log(
        np.maximum(np.exp(off) * (1.0 + rise) - rise, RESIDUALS.least_stiffness_factor)
    )
    expanded = _expanded(refined, settling, base, terms, columns)
    if expanded is None:
        return settle(refined, None)
    left = expanded.residual(base, terms, FULL)
    if left @ left > bench.policy.far_chi2 * bench.blocks.dof:
        return settle(refined, None)
    return expanded


def _scatter(
    bench: LumpedResidual,
    residual: FloatArray,
    ways: FloatArray,
    columns: list[FloatArray],
    terms: Sequence[Term],
    seen: BoolArray,
) -> HitScatter:
    """Estimate the scatter of all hits from the residual of those that are seen."""
    campaign = bench.campaign
    directions = scatter_directions(campaign)
    if campaign.repeatability is not None:
        return no_scatter(directions, len(residual))
    rows = (residual / bench.noise.sigma[:, :, None]).reshape(len(residual), -1)
    records = _compressed(rows, ways, columns)
    records = records.moved(_known_values(bench, terms, directions))
    kept = np.flatnonzero(seen)
    known_hits = HitsSeen(
        _patterns(campaign)[:, kept],
        tuple(
            repeat_groups(
                campaign.hit[kept], campaign.level[kept], campaign.preload[kept]
            )
        ),
    )
    dof = bench.blocks.dof * kept.size // seen.size
    found = estimate_scatter(
        records.some(kept), directions, known_hits, dof, bench.policy
    )
    return found if seen.all() else with_unseen_hits(found, records, kept)


def _known_values(
    bench: LumpedResidual,
    terms: Sequence[Term],
    directions: Sequence[ScatterDirection],
) -> FloatArray:
    """Return the deviations that are in the model, shape (n_records, n_columns)."""
    conditions = bench.excitation.conditions
    columns = sum(len(d.columns) for d in directions)
    values = np.zeros((conditions.preload.size, columns))
    if (known := conditions.settling) is not None:
        rise = bench.rise(terms)
        values[:, 1] = np.log((np.exp(known) + rise) / (1.0 + rise))
    if bench.gains is not None:
        (own,) = (d.columns for d in directions if d.name == CHANNEL_GAIN)
        values[:, list(own)] = bench.gains.factor - 1.0
    return values


def _compressed(
    residual: FloatArray, ways: FloatArray, columns: list[FloatArray]
) -> CompressedRecords:
    """Return records along the ways, after whitening the force noise."""
    rows, seen = [], []
    for r, w, own in zip(residual, ways, columns, strict=True):
        basis, shrink = whitening_basis(own)
        both = np.concatenate([r[None, :], w])
        both = both - ((both @ basis.T) * shrink) @ basis
        rows.append(both[0])
        seen.append(both[1:])
    return compress(np.array(rows), np.array(seen))


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
    bench: SomeBench, model: FloatArray, residual: FloatArray, seen: BoolArray
) -> FloatArray:
    """Return the noise of each record and channel, (n_records, n_channels)."""
    peak = np.abs(model).max(axis=2)
    sigma = channel_sigma(residual[:, :, bench.campaign.lead : -TAIL], peak, seen)
    if bench.campaign.repeatability is not None:
        sigma = np.hypot(sigma, bench.campaign.repeatability * peak)
    return sigma


def _expanded(
    bench: SomeBench,
    settling: FloatArray,
    base: FloatArray,
    terms: Sequence[Term],
    columns: list[FloatArray],
) -> SomeBench | None:
    """Return the bench expanded about a settling, with its scatter whitened there.

    The slope of the expansion is then the same direction that is whitened, so that no
    part of the settling remains. None where a nonlinear joint diverges there.
    """
    there = settle(bench, settling)
    sigma = bench.noise.sigma
    moved = there.response(base, terms)
    ways = scatter_columns(there, base, terms, moved)
    if not np.isfinite(np.vdot(ways, ways)):
        return None
    slope = ways[:, 1].reshape(*sigma.shape, -1) * sigma[:, :, None]
    whitened = _with_noise(there, bench.noise, columns, ways)
    settled = Settled(base.copy(), slope, there.rise(terms))
    return replace(whitened, settled=settled)


def _patterns(campaign: Campaign) -> FloatArray:
    """Return possible trends over the records, shape (n_patterns, n_records).

    A change with time need not be a line: warming up bends it.
    """
    order = campaign.order.astype(float)
    return np.stack(
        [
            np.log(campaign.preload),
            order,
            (order - order.mean()) ** 2,
            np.log(campaign.level),
            campaign.hit.astype(float),
        ]
    )


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


def _with_noise(
    bench: SomeBench, noise: Noise, columns: list[FloatArray], ways: FloatArray
) -> SomeBench:
    """Return the bench with the whitening of `noise`."""
    scatter = noise.scatter
    if scatter.rho > 0.0:
        basis, mixing = whitening_of_all(columns, ways, scatter.sd, scatter.rho)
        shrink = np.zeros((*basis.shape[:2], 1))
        return replace(
            bench, noise=noise, basis=basis, shrink=shrink, mixing=mixing, short={}
        )
    parts = []
    for own, way, sd in zip(columns, ways, scatter.sd, strict=True):
        spread = way[sd > 0.0] * sd[sd > 0.0, None]
        parts.append(whitening_basis(np.concatenate([own, spread])))
    kept = max(b.shape[0] for b, _ in parts)
    basis = np.zeros((len(parts), kept, ways.shape[2]))
    shrink = np.zeros((len(parts), kept, 1))
    for k, (b, s) in enumerate(parts):
        basis[k, : b.shape[0]] = b
        shrink[k, : b.shape[0], 0] = s
    return replace(
        bench, noise=noise, basis=basis, shrink=shrink, mixing=None, short={}
    )
