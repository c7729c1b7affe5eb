# SPDX-License-Identifier: MIT
"""Diagnose a campaign: verdict and evidence from the outcome of the search."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import announced
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.amplitude_evidence import (
    MeasuredCurves,
    amplitude_evidence,
)
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.effect_limits import effect_limits
from jointbench.analysis.gap.diagnosis.evidence import make_evidence
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome, investigate
from jointbench.analysis.gap.diagnosis.partial_verdict import under_model_error
from jointbench.analysis.gap.diagnosis.scattered_hits import scatter_found
from jointbench.analysis.gap.diagnosis.verdict_and_advice import verdict_on
from jointbench.analysis.gap.diagnosis.winner_check import check_winner
from jointbench.analysis.gap.judgement.amplitudes import weakest
from jointbench.analysis.gap.judgement.campaign_limits import campaign_limits
from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.judgement.fit_summaries import (
    deviations_from_priors,
    labels_of_fit,
    largest_deviation,
    ranked_fits,
)
from jointbench.analysis.gap.judgement.held_out import HeldOut, hold_out
from jointbench.analysis.gap.judgement.stated_covariance import stated_covariance
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.check_records import Closest, EffectLimit
from jointbench.analysis.gap.model.confidence import Evidence, confidence_of
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
    NamedEffect,
)
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.effect_parameter import Reported
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import (
    Bench,
    NoisyBench,
    values_of,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.residuals.scatter_record import FORCE_GAIN
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.selection_round import Progress, score

UNPREDICTED_WORDS = (
    "; held out, a condition is not predicted by the others: it shows the effect "
    "alone, so add conditions next to it"
)
LOOK_CLOSER = "check the views of the gap; widen levels, points and preloads"


@one_thread()
def diagnose(
    campaign: Campaign,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    policy: Policy = STANDARD,
    curves: MeasuredCurves | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find and name the effects that a model lacks, and add them.

    Args:
        campaign: measurement and model.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        policy: thresholds of the verdict.
        curves: modes over amplitude as measured, to be shown next to the explanations;
            they do not change the verdict.
        progress: receives one line for each step of the search.

    Returns:
        Verdict and evidence; `unknown` with a reason if the campaign is insufficient
        (one level, no repeats, too few records).

    Raises:
        UsageError: `without` holds a name that no entry has.

    Source:
        Kennedy and O'Hagan 2001, J. R. Stat. Soc. B 63, 425, for the question; the
        acceptance criteria are those of `jointbench.analysis.gap.judgement.naming`.
    """
    bench = make_bench(campaign, without=without, entries=entries, policy=policy)
    report = progress or _silent
    with announced(report):
        outcome = investigate(bench, report)
    final = outcome.bench
    if not isinstance(final, LumpedBench):
        raise TypeError("the search must return a bench of the type it was given")
    limits = campaign_limits(campaign, policy)
    return conclude(outcome, final, limits=limits, measured=curves, progress=progress)


def conclude(
    outcome: SearchOutcome,
    bench: LumpedBench,
    *,
    limits: str = "",
    measured: MeasuredCurves | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Derive the diagnosis from the outcome of a search."""
    base = minimise(make_problem(bench, ()), outcome.base.x, FULL, iterations=6)
    outcome = replace(outcome, base=base)
    verdict, partial = under_model_error(
        verdict_on(outcome, bench, limits), bench, base, progress or _silent
    )
    finding = verdict.finding
    shown: Sequence[Fit] = ()
    if finding is Finding.NAMED:
        shown = (outcome.best,)
    elif finding is Finding.AMBIGUOUS:
        shown = outcome.level
    best = outcome.best if outcome.acceptance.passed else base
    held = hold_out(base, bench)
    held_after = held
    if best.candidates:
        rivals = _close_rivals(outcome, bench, best)
        held_after = hold_out(best, bench, held, rivals)
    evidence = make_evidence(bench, base, outcome, finding)
    if verdict.step:
        evidence = replace(evidence, advice="")
    found = Diagnosis(
        verdict=finding,
        effects=effects_of(outcome, bench, shown),
        candidates=ranked_fits(
            bench,
            [outcome.base, *outcome.ranked],
            lambda f: f.chi2 / bench.blocks.dof,
        ),
        gap_before=_gap(bench, base, held),
        gap_after=_gap(bench, best, held_after),
        prior_deviations=deviations_from_priors(bench.base_names, base, best),
        base=_base_estimates(bench, best),
        noise={
            "sigma_min": float(bench.noise.sigma.min()),
            "sigma_max": float(bench.noise.sigma.max()),
            "force_sigma_N": bench.noise.force_sigma,
            "scatter_gain": bench.noise.scatter.size_of(FORCE_GAIN),
            "scatter_joint": bench.noise.scatter.joint_size,
        },
        null_statistic=(
            outcome.base_screening.largest,
            outcome.base_screening.threshold,
        ),
        experiment=verdict.step or evidence.advice or LOOK_CLOSER,
        reason=verdict.reason,
        evidence=evidence,
        explanations=tuple(
            labels_of_fit(f) for f in outcome.level if outcome.acceptance.passed
        ),
        policy=bench.policy,
        scatter=scatter_found(bench),
        partial=partial,
        closest=closest_of(outcome, bench),
        limits=_limits(outcome, bench, finding),
        second_method=check_winner(
            bench, outcome.best if outcome.best.candidates else base
        ),
        curves=None
        if measured is None
        else amplitude_evidence(bench, base, shown, measured),
    )
    if finding is Finding.NAMED and not found.predicted:
        return replace(found, reason=verdict.reason + UNPREDICTED_WORDS)
    return found


def _close_rivals(outcome: SearchOutcome, bench: Bench, best: Fit) -> tuple[Fit, ...]:
    """Return the fits that may be chosen when a condition is held out."""
    near = score(bench, best) + DIAGNOSIS.held_out_score
    close = [f for f in outcome.ranked if f is not best and score(bench, f) < near]
    return tuple(close[: DIAGNOSIS.held_out_rivals])


def _silent(line: str) -> None:
    """Show no progress."""


def _gap(bench: LumpedBench, fit: Fit, held: HeldOut) -> Gap:
    return Gap(
        held.gap,
        held.chi2_per_dof,
        largest_deviation(fit),
        bench.views(fit),
        held.words,
    )


def evidence_of(outcome: SearchOutcome, bench: NoisyBench, fit: Fit) -> Evidence:
    """Return the quantities from which the confidence of a fit is computed."""
    own = {c.label for c in fit.candidates}
    others = [
        score(bench, f)
        for f in outcome.ranked
        if {c.label for c in f.candidates} != own
        and not own < {c.label for c in f.candidates}
    ]
    margin = (min(others) if others else DIAGNOSIS.no_rival_score) - score(bench, fit)
    allowed = max(outcome.acceptance.allowed, 1e-12)
    slack = 1.0 - max(outcome.acceptance.excess, 0.0) / allowed
    acceptance, dof = outcome.acceptance, bench.blocks.dof
    excess = max(acceptance.excess, 0.0)
    base_excess = max(outcome.base.chi2 - dof, 1.0)
    return Evidence(
        margin=margin,
        slack=slack,
        amplitude=weakest(fit, (outcome.base, *outcome.ranked)),
        effects=len(fit.candidates),
        excess=excess / allowed,
        probe=(acceptance.remaining or 0.0) / max(acceptance.remaining_allowed, 1.0),
        left=min(excess * dof / base_excess, 1.0),
        scatter=bench.noise.scatter.largest_share,
        deviation=float(np.abs(fit.prior_deviations).max()) / bench.policy.prior_limit,
    )


def _limits(
    outcome: SearchOutcome, bench: LumpedBench, finding: Finding
) -> tuple[EffectLimit, ...]:
    """Return the largest effects that a verdict of none leaves open."""
    if finding is not Finding.NONE:
        return ()
    return effect_limits(bench, outcome.base_screening)


def closest_of(outcome: SearchOutcome, bench: NoisyBench) -> Closest | None:
    """Return the best explanation before the acceptance criteria, if there is one."""
    fit = outcome.ranked[0] if outcome.ranked else outcome.best
    if not fit.candidates or not np.isfinite(fit.cost):
        return None
    evidence = evidence_of(outcome, bench, fit)
    return Closest(labels_of_fit(fit), confidence_of(evidence), evidence)


def effects_of(
    outcome: SearchOutcome,
    bench: NoisyBench,
    fits: Sequence[Fit],
    sloped: Callable[[Fit], Fit] = lambda fit: fit,
) -> tuple[NamedEffect, ...]:
    """Return the effects of explanations, each as in the first that contains it.

    The confidence of an effect is the sum over the rivals that contain it.

    Args:
        outcome: of the search.
        bench: on which the fits were found.
        fits: explanations.
        sloped: returns a fit with its slopes, for one explanation at a time.
    """
    found: dict[str, NamedEffect] = {}
    for fit in map(sloped, fits):
        evidence = evidence_of(outcome, bench, fit)
        confidence = confidence_of(evidence) / len(fits)
        for k, (label, term) in enumerate(
            zip(labels_of_fit(fit), fit.terms, strict=True)
        ):
            if label in found:
                one = found[label]
                found[label] = replace(one, confidence=one.confidence + confidence)
                continue
            found[label] = NamedEffect(
                term.candidate.effect.name,
                str(term.candidate.site),
                estimates_of(bench, fit, k),
                confidence,
                evidence,
            )
    return tuple(found.values())


def estimates_of(bench: Bench, fit: Fit, index: int) -> tuple[Estimate, ...]:
    """Return the parameters of the effect of that index, with sd by first order."""
    term = fit.terms[index]
    at = fit.n_base + sum(len(t.coordinates) for t in fit.terms[:index])
    size = len(term.coordinates)
    stated = stated_covariance(fit, bench.blocks)
    covariance = stated[at : at + size, at : at + size]
    reported = _report(bench, term.candidate, term.coordinates)
    slopes = np.empty((len(reported), size))
    for i in range(size):
        step = 1e-5 * max(abs(float(term.coordinates[i])), 1e-3)
        moved = np.array(term.coordinates)
        moved[i] += step
        after = _report(bench, term.candidate, moved)
        slopes[:, i] = [
            (b.value - a.value) / step for a, b in zip(reported, after, strict=True)
        ]
    sd = np.sqrt(np.maximum(np.diag(slopes @ covariance @ slopes.T), 0.0))
    return tuple(
        Estimate(r.name, r.value, float(s), r.unit)
        for r, s in zip(reported, sd, strict=True)
    )


def _report(
    bench: Bench, candidate: Candidate, coordinates: FloatArray
) -> tuple[Reported, ...]:
    term = Term(candidate, coordinates)
    return candidate.effect.reported(values_of(bench, term))


def _base_estimates(bench: LumpedBench, fit: Fit) -> tuple[Estimate, ...]:
    sd = np.sqrt(np.diag(stated_covariance(fit, bench.blocks))[: fit.n_base])
    values = bench.theta(fit.base)
    links = len(bench.campaign.model.links)
    units = ["kg"] * len(bench.campaign.model.bodies) + ["N/m"] * links
    units += ["N s/m"] * links
    return tuple(
        Estimate(name, float(v), float(v * s), unit)
        for name, v, s, unit in zip(bench.base_names, values, sd, units, strict=True)
    )


__all__ = [
    "closest_of",
    "conclude",
    "diagnose",
    "effects_of",
    "noise_sd",
]
