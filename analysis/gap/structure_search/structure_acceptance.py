# SPDX-License-Identifier: MIT
"""Whether a fit of hits on bolted bodies to whole records explains them."""

import numpy as np

from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.structure_bench.beyond_table import beyond_table
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.landing import mark_missed
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def accept_structure(
    bench: StructureBench, fit: Fit, base: Fit, *, channels: bool = True
) -> Acceptance:
    """Judge a fit of whole records by its chi2, its base and where hits landed.

    A base can take over a loose bolt at an inconspicuous chi2 if one of its parameters
    deviates by many sd, and the aim of each hit a mark that all of them missed, so chi2
    alone does not decide.

    Args:
        bench: on which the fit was found.
        fit: to be judged.
        base: fit without effects.
        channels: whether a channel that stands out is unexplained where the modal table
            is uncertain.
    """
    dof = bench.blocks.dof / bench.coherence
    chi2 = fit.chi2 / dof
    policy, allowed = bench.policy, bench.policy.floor_chi2
    if fit.candidates:
        allowed = allowed_chi2(bench, base)
    deviations = np.abs(fit.prior_deviations)
    deviation = float(deviations.max())
    reason = ""
    if chi2 > allowed:
        reason = f"chi2/dof is {chi2:.4g}, the limit is {allowed:.4g}"
    elif deviation > policy.floor_prior_limit:
        worst = bench.base_names[int(np.argmax(deviations))]
        reason = f"{worst} is {deviation:.1f} sd from its nominal value"
    else:
        landing, _ = bench.landed(fit.base, fit.terms)
        common, error = STRUCTURE.mark_sd, policy.floor_prior_limit
        reason = mark_missed(bench.campaign, landing, common, error)
        if bench.uncertain and not (reason or fit.candidates):
            reason = _no_linear_structure(bench, fit)
        if bench.uncertain and channels and not reason:
            reason = _channel_that_stands_out(bench, fit)
    return Acceptance(
        passed=not reason,
        reason=reason,
        excess=chi2 - 1.0,
        allowed=allowed - 1.0,
        remaining=None,
        remaining_allowed=0.0,
        unexplained=bool(reason),
        left=None,
    )


def allowed_chi2(bench: StructureBench, base: Fit) -> float:
    """Return the limit of chi2/dof of a fit with effects.

    Args:
        bench: all records.
        base: fit of them without effects.
    """
    policy, dof = bench.policy, bench.blocks.dof / bench.coherence
    excess = max(base.chi2 / dof - 1.0, 0.0)
    return policy.floor_chi2 + policy.floor_chi2_share * excess


def _no_linear_structure(bench: StructureBench, fit: Fit) -> str:
    """Return why no modal table explains what a fit leaves, empty if one may."""
    level, chi2 = beyond_table(bench, fit)
    if chi2 < bench.policy.floor_chi2:
        return ""
    share = MODAL_TABLE.table_floor * np.sqrt(chi2)
    return f"at {level}, {share:.2%} of the peak is due to no error of the modal table"


def _channel_that_stands_out(bench: StructureBench, fit: Fit) -> str:
    """Return which channel is left unexplained beside the others, empty if none is.

    Errors of a table touch all channels. Of a sensor that is not where or as stated,
    only its own channel shows it; one of twelve moves the chi2 of all by little.
    """
    squares = fit.residual.reshape(bench.blocks.shape) ** 2
    chi2 = np.mean(squares, axis=(0, 2)) * bench.coherence
    worst, typical = int(np.argmax(chi2)), float(np.median(chi2))
    limit = max(bench.policy.floor_chi2, STRUCTURE_SEARCH.outstanding_channel * typical)
    if chi2[worst] <= limit:
        return ""
    name = bench.campaign.bodies.channels[worst]
    return f"{name} leaves chi2/dof {chi2[worst]:.2g}, a typical channel {typical:.2g}"
