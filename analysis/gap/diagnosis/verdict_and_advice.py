# SPDX-License-Identifier: MIT
"""The verdict on an outcome, its reason in one line, and what to do next."""

from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.location import counted_samples
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.campaign_limits import flat_tops
from jointbench.analysis.gap.judgement.expected_misfit import noise_sd
from jointbench.analysis.gap.judgement.rivals import rival_within
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import labels_of, words_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.search.selection_round import score


@dataclass(frozen=True, slots=True)
class DiagnosisVerdict:
    """What an outcome comes to.

    Attributes:
        finding: none, named, ambiguous or unknown.
        reason: in one line.
        step: what to do next; empty where the look of the misfit has to tell.
    """

    finding: Finding
    reason: str
    step: str


def verdict_on(
    outcome: SearchOutcome, bench: LumpedBench, limits: str
) -> DiagnosisVerdict:
    """Judge an outcome.

    Args:
        outcome: of the loop on that bench.
        bench: with its noise as estimated at the end.
        limits: why the campaign can show no more than `unknown`; empty where it can.
    """
    if limits:
        return DiagnosisVerdict(Finding.UNKNOWN, limits, _way_out(limits))
    if not outcome.gate.passed:
        return _unknown(outcome, bench)
    if not outcome.best.candidates:
        return DiagnosisVerdict(
            Finding.NONE,
            "the base explains the records to within their noise",
            "none needed; to look deeper, hit at more levels and preloads",
        )
    names = " or ".join(words_of(f.candidates) for f in outcome.level)
    if len(outcome.level) == 1:
        reason = f"explains the records to chi2/dof {1 + outcome.gate.excess:.3f}"
        return DiagnosisVerdict(Finding.NAMED, reason, _no_rival(outcome, bench))
    step = _separates(outcome.level[0], outcome.level[1])
    if len(outcome.level) > bench.policy.most_rivals:
        reason = f"too many explanations fit alike: {names}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, step)
    reason = f"{names}: their scores lie too close together"
    return DiagnosisVerdict(Finding.AMBIGUOUS, reason, step)


def _unknown(outcome: SearchOutcome, bench: LumpedBench) -> DiagnosisVerdict:
    """Say why the best fit is no name, and whether more might have been tried."""
    flat = flat_tops(bench.campaign.response, bench.noise.sigma)
    if flat:
        reason = (
            f"record {flat[0]} has flat tops (and {len(flat) - 1} others): "
            "a channel is overloaded; lower its gain and hit again"
        )
        return DiagnosisVerdict(Finding.UNKNOWN, reason, _way_out(reason))
    if odd := _odd_record(outcome, bench):
        return DiagnosisVerdict(Finding.UNKNOWN, odd, _way_out(odd))
    reason = f"no effect explains it: {outcome.gate.reason}"
    if outcome.given_up:
        reason += "; the search for a further one was ended for its length"
    return DiagnosisVerdict(Finding.UNKNOWN, reason, "")


def _way_out(reason: str) -> str:
    """Return what a reason says last: what to do about it."""
    return reason.replace(": ", "; ").rpartition("; ")[2]


def _odd_record(outcome: SearchOutcome, bench: LumpedBench) -> str:
    """Return a warning where one record holds nearly all of the misfit.

    Its excess must be more than that of noise, or some record always holds most.
    """
    groups = bench.blocks.group
    counted = counted_samples(bench) * bench.blocks.shape[1]
    share = np.bincount(groups, weights=outcome.best.residual**2) - counted
    worst = int(np.argmax(share))
    total = float(np.clip(share, 0, None).sum())
    noise = noise_sd(bench) * np.sqrt(share.size) * np.mean(np.bincount(groups))
    if share[worst] < max(
        DIAGNOSIS.one_record_share * total, bench.policy.chi2_limit * noise
    ):
        return ""
    labels = ", ".join(f"{k} {v}" for k, v in bench.blocks.labels[worst].items())
    return (
        f"record {worst} ({labels}) holds {100 * share[worst] / total:.0f} % of the "
        "misfit: check its labels (preload, level, point) or measure it again"
    )


def _no_rival(outcome: SearchOutcome, bench: LumpedBench) -> str:
    """Say how far the nearest rival of a name is behind: no experiment is needed."""
    own = labels_of(outcome.best.candidates)
    others = [
        score(bench, f)
        for f in outcome.ranked
        if not (labels_of(f.candidates) <= own or own <= labels_of(f.candidates))
    ]
    if not others:
        return "no experiment needed: no other explanation came near"
    behind = min(others) - score(bench, outcome.best)
    return (
        f"no experiment needed: the nearest rival is {behind:.0f} behind, "
        f"{rival_within(outcome.best, bench.policy):.0f} tell it apart"
    )


def _separates(first: Fit, second: Fit) -> str:
    """Return the experiment that tells two fits apart by what one alone holds."""
    own = [c for c in first.candidates if c not in second.candidates]
    other = [c for c in second.candidates if c not in first.candidates]
    for a in own:
        for b in other:
            for left, right in ((a, b), (b, a)):
                advice = left.effect.separates.get(right.effect.name)
                if advice:
                    return f"{left.label} or {right.label}: {advice}"
    return "repeat at more levels, points and preloads to tell the first two apart"
