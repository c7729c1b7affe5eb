# SPDX-License-Identifier: MIT
"""The verdict on an outcome, its reason in one line, and what to do next."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.location import counted_samples
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.scattered_hits import unexplained_hits
from jointbench.analysis.gap.judgement.campaign_limits import flat_tops
from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.judgement.rivals import rival_within
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import labels_of, words_of
from jointbench.analysis.gap.model.scatter_found import HitFound, hit_words
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.search.selection_round import score


@dataclass(frozen=True, slots=True)
class DiagnosisVerdict:
    """The verdict on a search outcome.

    Attributes:
        finding: none, named, ambiguous, mostly or unknown.
        reason: in one line.
        step: what to do next; empty where the residual's signature decides.
        unexplained: whether no effect explains the records, although the campaign is
            sufficient and no record is faulty.
    """

    finding: Finding
    reason: str
    step: str
    unexplained: bool = False


def verdict_on(
    outcome: SearchOutcome, bench: LumpedBench, limits: str
) -> DiagnosisVerdict:
    """Derive the verdict from a search outcome.

    Args:
        outcome: of the search on that bench.
        bench: with its final noise estimate.
        limits: reason why the campaign allows no verdict but `unknown`, or empty.
    """
    if limits:
        return DiagnosisVerdict(Finding.UNKNOWN, limits, _way_out(limits))
    if not outcome.acceptance.passed:
        return _unknown(outcome, bench)
    if not outcome.best.candidates:
        return DiagnosisVerdict(
            Finding.NONE,
            "the base model explains the records within their noise",
            "none required; for a lower detection limit, hit at more levels and "
            "preloads",
        )
    names = " or ".join(words_of(f.candidates) for f in outcome.level)
    if len(outcome.level) == 1:
        reason = f"explains the records to chi2/dof {1 + outcome.acceptance.excess:.3f}"
        return DiagnosisVerdict(Finding.NAMED, reason, no_rival(outcome, bench))
    step = _separates(outcome.level[0], outcome.level[1])
    if len(outcome.level) > bench.policy.most_rivals:
        reason = f"too many explanations fit equally well: {names}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, step)
    reason = f"{names}: the difference of their scores is not significant"
    return DiagnosisVerdict(Finding.AMBIGUOUS, reason, step)


def _unknown(outcome: SearchOutcome, bench: LumpedBench) -> DiagnosisVerdict:
    """Give the reason against the best fit, and whether the search was complete."""
    flat = flat_tops(bench.campaign.response, bench.noise.sigma)
    if flat:
        reason = (
            f"record {flat[0]} has flat tops (and {len(flat) - 1} others): "
            "a channel is overloaded; reduce its gain and repeat the hits"
        )
        return DiagnosisVerdict(Finding.UNKNOWN, reason, _way_out(reason))
    if alone := unexplained_hits(bench, outcome.best):
        reason = _scatters(alone)
        return DiagnosisVerdict(Finding.UNKNOWN, reason, _way_out(reason))
    if odd := _odd_record(outcome, bench):
        return DiagnosisVerdict(Finding.UNKNOWN, odd, _way_out(odd))
    reason = (
        f"no effect of the catalogue explains the records: {outcome.acceptance.reason}"
    )
    if outcome.given_up:
        reason += "; the search for a further effect reached its effort limit"
    return DiagnosisVerdict(Finding.UNKNOWN, reason, "", unexplained=True)


def _scatters(hits: Sequence[HitFound]) -> str:
    """Return the reason where hits scatter beyond what can be modelled."""
    listed = ", ".join(hit_words(hit) for hit in hits)
    return (
        f"hits scatter: {listed} deviate from their repeats by more than gain, delay "
        "and joint stiffness explain: repeat these hits"
    )


def _way_out(reason: str) -> str:
    """Return the last clause of a reason: the way out."""
    return reason.replace(": ", "; ").rpartition("; ")[2]


def _odd_record(outcome: SearchOutcome, bench: LumpedBench) -> str:
    """Return a warning if one record holds nearly all of the residual.

    Its excess must exceed that of noise, since one record always holds most.
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
        "residual: check its labels (preload, level, point) or repeat it"
    )


def no_rival(outcome: SearchOutcome, bench: Bench) -> str:
    """Give the delta score of the nearest rival: no experiment is required."""
    own = labels_of(outcome.best.candidates)
    others = [
        score(bench, f)
        for f in outcome.ranked
        if not (labels_of(f.candidates) <= own or own <= labels_of(f.candidates))
    ]
    if not others:
        return "no further experiment required: no other explanation comes close"
    delta_score = min(others) - score(bench, outcome.best)
    limit = rival_within(outcome.best, bench.policy)
    return (
        f"no further experiment required: the nearest rival has a delta score of "
        f"{delta_score:.0f} (limit {limit:.0f})"
    )


def _separates(first: Fit, second: Fit) -> str:
    """Return the experiment that distinguishes two fits by what only one contains."""
    own = [c for c in first.candidates if c not in second.candidates]
    other = [c for c in second.candidates if c not in first.candidates]
    for a in own:
        for b in other:
            for left, right in ((a, b), (b, a)):
                advice = left.effect.separates.get(right.effect.name)
                if advice:
                    return f"{left.label} or {right.label}: {advice}"
    return "repeat at more levels, points and preloads to distinguish the best two"
