# SPDX-License-Identifier: MIT
"""What a diagnosis of bolted bodies says about a fit: its gap and its base."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.analysis.gap.judgement.fit_summaries import largest_deviation
from jointbench.analysis.gap.judgement.held_out import hold_out_by_steps
from jointbench.analysis.gap.judgement.stated_covariance import stated_covariance
from jointbench.analysis.gap.model.diagnosis_record import Estimate, Gap
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.joint_state import base_values


@dataclass(frozen=True, slots=True)
class FitSummary:
    """Gap and base of a fit; its slopes, a gigabyte of them, are not needed any more.

    Attributes:
        gap: what it leaves, by condition held out.
        estimates: of the base parameters.
    """

    gap: Gap
    estimates: tuple[Estimate, ...]


def fit_summary(bench: StructureBench, fit: Fit) -> FitSummary:
    """Return gap and base of a fit.

    Args:
        bench: on which it was found.
        fit: with its slopes.
    """
    return FitSummary(_gap(bench, fit), _base_estimates(bench, fit))


def _gap(bench: StructureBench, fit: Fit) -> Gap:
    held = hold_out_by_steps(fit, bench.blocks)
    # As in the verdict, in units of the floor.
    held = replace(held, dof=held.dof / bench.coherence)
    deviation = largest_deviation(fit)
    views = bench.views(fit)
    return Gap(held.gap, held.chi2_per_dof, deviation, views, held.words)


def _base_estimates(bench: StructureBench, fit: Fit) -> tuple[Estimate, ...]:
    variance = np.diag(stated_covariance(fit, bench.blocks))[: fit.n_base]
    sd = np.sqrt(np.maximum(variance, 0.0))
    campaign, layout = bench.campaign, bench.layout
    values, slopes = base_values(campaign.bodies, campaign.nominal, layout, fit.base)
    sd *= slopes
    return tuple(
        Estimate(name, float(v), float(s), unit)
        for name, v, s, unit in zip(layout.names, values, sd, layout.units, strict=True)
    )
