# SPDX-License-Identifier: MIT
"""Report the scatter of the hits, and the hits that no scatter of the model explains.

Repeats share every missing effect. A record that leaves a residual which its repeats do
not leave deviates by itself: its hit scattered in a way that no direction describes.
"""

import numpy as np

from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.location import counted_samples
from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.model.scatter_found import (
    DirectionFound,
    HitFound,
    ScatterFound,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.hit_scatter import repeat_groups
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench


def scatter_found(bench: LumpedBench) -> ScatterFound:
    """Return sizes and outstanding hits of the scatter of a bench."""
    scatter, limit = bench.noise.scatter, DIAGNOSIS.outstanding_sd
    directions, hits = [], []
    for direction, size in zip(scatter.directions, scatter.size, strict=True):
        usual = float(size) * direction.scale
        directions.append(DirectionFound(direction.name, usual, direction.unit))
        for column in direction.columns:
            for record, value in enumerate(scatter.values[:, column]):
                far = size > 0.0 and abs(value) > limit * size
                if far or (record, column) in scatter.outstanding:
                    # Of the model minus the measurement; the hit is the reverse.
                    off = -float(value) * direction.scale
                    name, unit = direction.name, direction.unit
                    hits.append(HitFound(record, name, off, usual, unit))
    return ScatterFound(tuple(directions), scatter.rho, tuple(hits))


def unexplained_hits(bench: LumpedBench, fit: Fit) -> tuple[HitFound, ...]:
    """Return the hits whose residual their repeats do not share, if they hold most.

    Args:
        bench: with its final noise estimate.
        fit: the best one.
    """
    campaign, groups = bench.campaign, bench.blocks.group
    counted = counted_samples(bench) * bench.blocks.shape[1]
    excess = np.bincount(groups, weights=fit.residual**2) - counted
    noise = noise_sd(bench) * np.sqrt(excess.size) * counted
    alone = []
    for rows in repeat_groups(campaign.hit, campaign.level, campaign.preload):
        worst = int(rows[np.argmax(excess[rows])])
        rest = float(np.max(excess[rows[rows != worst]]))
        shared = rest > DIAGNOSIS.repeat_share * excess[worst]
        if not shared and excess[worst] > bench.policy.chi2_limit * noise:
            alone.append(worst)
    total = float(np.clip(excess, 0.0, None).sum())
    if not alone or excess[alone].sum() < DIAGNOSIS.one_record_share * total:
        return ()
    return tuple(
        HitFound(i, "", float(1.0 + excess[i] / counted), 0.0) for i in sorted(alone)
    )
