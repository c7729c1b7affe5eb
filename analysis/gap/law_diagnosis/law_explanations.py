# SPDX-License-Identifier: MIT
"""Explanations of a search on a law: their probabilities, names and separation."""

from collections.abc import Callable, Sequence

import numpy as np

from jointbench.analysis.gap.diagnosis.diagnose import estimates_of, evidence_of
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.judgement.fit_summaries import labels_of_fit
from jointbench.analysis.gap.model.check_records import Closest
from jointbench.analysis.gap.model.diagnosis_record import Finding, NamedEffect
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.bench_protocol import NoisyBench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import score

Charged = Callable[[Fit], float]
"""Cost of a fit with the charges of its parameters."""


def chances(
    outcome: SearchOutcome, bench: NoisyBench, charged: Charged
) -> dict[str, float]:
    """Return the probability of each explanation among those that were fitted.

    Args:
        outcome: of the search.
        bench: of its fits.
        charged: cost by which the explanations are weighed.

    Source:
        Kass and Raftery 1995, J. Am. Stat. Assoc. 90, 773, with the charges of the
        score in place of the prior volumes.
    """
    near = min((score(bench, f) for f in outcome.ranked), default=0.0)
    near += bench.policy.rival_score
    # A fit near the best that is no explanation was rejected by a test of its own.
    kept = [f for f in outcome.ranked if f in outcome.level or score(bench, f) >= near]
    best = [outcome.best] if outcome.best.candidates else []
    fits = list(dict.fromkeys([outcome.base, *best, *kept]))
    scores = np.array([charged(f) for f in fits])
    weight = np.exp(-0.5 * (scores - scores.min()))
    return {
        words_of(f.candidates): float(w)
        for f, w in zip(fits, weight / weight.sum(), strict=True)
    }


def named_effects(
    outcome: SearchOutcome,
    bench: NoisyBench,
    fits: Sequence[Fit],
    charged: Charged,
) -> tuple[NamedEffect, ...]:
    """Return the effects of explanations with their probability.

    Args:
        outcome: of the search.
        bench: of its fits.
        fits: explanations that are shown.
        charged: cost by which the explanations are weighed.
    """
    chance = chances(outcome, bench, charged) if fits else {}
    return tuple(
        NamedEffect(
            c.effect.name,
            str(c.site),
            estimates_of(bench, f, k),
            chance[words_of(f.candidates)],
            evidence_of(outcome, bench, f),
        )
        for f in fits
        for k, c in enumerate(f.candidates)
    )


def closest_refused(
    outcome: SearchOutcome, bench: NoisyBench, finding: Finding, charged: Charged
) -> Closest | None:
    """Return the best effects of an unknown verdict; None where there are none."""
    best = outcome.best
    if finding is not Finding.UNKNOWN or not best.candidates:
        return None
    chance = chances(outcome, bench, charged)[words_of(best.candidates)]
    return Closest(labels_of_fit(best), chance, evidence_of(outcome, bench, best))


def separating_steps(outcome: SearchOutcome, otherwise: str) -> str:
    """Return the fixed advice on the explanations that fit alike.

    Args:
        outcome: of the search.
        otherwise: where no effect states what separates it from another one.
    """
    steps = []
    effects = [c.effect for f in outcome.level for c in f.candidates]
    for one in effects:
        for other in effects:
            step = one.separates.get(other.name)
            if step is not None and step not in steps:
                steps.append(step)
    return "; or ".join(steps) or otherwise


def verdict_on_level(
    outcome: SearchOutcome, bench: NoisyBench, explains: str, otherwise: str
) -> DiagnosisVerdict:
    """Return the verdict where effects explain the rows to their noise.

    Args:
        outcome: of the search.
        bench: of its fits.
        explains: what the one explanation does, for the reason.
        otherwise: advice where no effect states what separates it.
    """
    if len(outcome.level) == 1:
        return DiagnosisVerdict(Finding.NAMED, explains, "no rival is near")
    names = " or ".join(words_of(f.candidates) for f in outcome.level)
    steps = separating_steps(outcome, otherwise)
    if len(outcome.level) > bench.policy.most_rivals:
        reason = f"too many explanations fit equally well: {names}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, steps)
    reason = f"{names}: the difference of their scores is not significant"
    return DiagnosisVerdict(Finding.AMBIGUOUS, reason, steps)
