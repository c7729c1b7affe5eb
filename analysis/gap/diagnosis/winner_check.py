# SPDX-License-Identifier: MIT
"""Predict the hardest record of the best explanation by the second method."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.location import condition_of
from jointbench.analysis.gap.model.check_records import SecondMethod
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.second_method.verify import verify_response


def check_winner(bench: LumpedBench, fit: Fit) -> SecondMethod:
    """Compare both methods on the record with the largest response over the noise.

    Args:
        bench: measurement and model.
        fit: of the explanation.
    """
    campaign, sigma = bench.campaign, bench.noise.sigma
    peak = np.abs(campaign.response).max(axis=2) / sigma
    record = int(np.argmax(peak.max(axis=1)))
    labels = tuple(c.label for c in fit.candidates) or ("none",)
    found = SecondMethod(labels, record, condition_of(bench, record))
    if campaign.response.shape[2] > DIAGNOSIS.longest_check:
        return replace(found, reason="the records are too long for it")
    try:
        checked = verify_response(
            campaign.model,
            bench.theta(fit.base),
            _one_record(bench.excitation, record),
            bench.actions(fit.terms),
            measured=campaign.response[record : record + 1],
            sigma=sigma[record : record + 1],
            tolerance=DIAGNOSIS.check_tolerance,
        )
    except (UsageError, BadData) as error:
        return replace(found, reason=str(error))
    noise = checked.over_noise
    return replace(
        found,
        over_peak=float(checked.over_peak.max()),
        over_noise=None if noise is None else float(noise.max()),
    )


def _one_record(excitation: Excitation, record: int) -> Excitation:
    """Return the excitation of one record."""
    rows, known = slice(record, record + 1), excitation.conditions
    settling = None if known.settling is None else known.settling[rows]
    conditions = replace(
        known,
        preload=known.preload[rows],
        progress=known.progress[rows],
        settling=settling,
    )
    return replace(
        excitation,
        spectrum=excitation.spectrum[rows],
        hit=excitation.hit[rows],
        conditions=conditions,
    )
