# SPDX-License-Identifier: MIT
"""Diagnosis of hits on bolted bodies: verdict and evidence."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from jointbench.acquisition.basics.compiled import announced
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.diagnose import closest_of, effects_of
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.judgement.fit_summaries import (
    deviations_from_priors,
    labels_of_fit,
    ranked_fits,
)
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
)
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.structure_catalogue import (
    STRUCTURE_CATALOGUE,
)
from jointbench.analysis.gap.structure_bench.structure_effects import StructureEffect
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitCampaign,
    RejectedHit,
)
from jointbench.analysis.gap.structure_search.fit_summary import fit_summary
from jointbench.analysis.gap.structure_search.slopes_again import with_slopes
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import search_structure

OTHER_POINTS = (
    "hit a further point off the lines of symmetry, in the tangential direction as "
    "well: it separates the bolts"
)
LOOK_CLOSER = "check the views of the gap: they show the point, torque or channel"


@dataclass(frozen=True, slots=True, eq=False)
class StructureDiagnosis:
    """Result on bolted bodies.

    Attributes:
        found: verdict and evidence.
        landing_mm: rms distance of the hits from their points [mm].
        tilt_degrees: rms tilt of the hits [degrees].
        rejected: hits left out.
    """

    found: Diagnosis
    landing_mm: float
    tilt_degrees: float
    rejected: tuple[RejectedHit, ...]


@one_thread()
def diagnose_structure(
    campaign: HitCampaign,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[StructureEffect, ...] = STRUCTURE_CATALOGUE,
    policy: Policy = STANDARD,
    progress: Progress | None = None,
) -> StructureDiagnosis:
    """Find and name the effect that a model of bolted bodies lacks.

    Args:
        campaign: hits with modes of the free bodies and nominal parameters.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        policy: thresholds of the verdict.
        progress: receives one line for each step.

    Raises:
        UsageError: `without` holds a name that no entry has.
    """
    report = progress or _silent
    bench = make_structure_bench(
        campaign, without=without, entries=entries, policy=policy
    )
    with announced(report):
        found = search_structure(bench, report)
    bench, best = found.bench, found.outcome.best
    landing, _ = bench.landed(best.base, best.terms)
    return StructureDiagnosis(
        _conclude(found),
        1e3 * float(np.sqrt(np.mean(np.sum(landing[:, 2:] ** 2, axis=1)))),
        float(np.degrees(np.sqrt(np.mean(np.sum(landing[:, :2] ** 2, axis=1))))),
        campaign.hits.rejected,
    )


def _silent(line: str) -> None:
    """Show no progress."""


def _conclude(found: StructureOutcome) -> Diagnosis:
    """Derive the diagnosis from the outcome of a search."""
    outcome, bench = found.outcome, found.bench
    verdict = _verdict(outcome, bench)
    shown: Sequence[Fit] = ()
    if verdict.finding is Finding.NAMED:
        shown = (outcome.best,)
    elif verdict.finding is Finding.AMBIGUOUS:
        shown = outcome.level
    base, accepted = outcome.base, outcome.acceptance.passed
    best, on = (outcome.best, bench) if accepted else (base, found.base_bench)
    before = found.before
    after = before if best is base else fit_summary(on, best)
    return Diagnosis(
        verdict=verdict.finding,
        effects=effects_of(outcome, bench, shown, partial(with_slopes, bench)),
        candidates=ranked_fits(
            bench,
            [outcome.base, *outcome.ranked],
            lambda f: f.chi2 * bench.coherence / bench.blocks.dof,
        ),
        gap_before=before.gap,
        gap_after=after.gap,
        prior_deviations=deviations_from_priors(bench.base_names, base, best),
        base=after.estimates,
        noise={
            "sigma_min": float(on.sigma.min()),
            "sigma_max": float(on.sigma.max()),
            "force_sigma_N": 0.0,
            "scatter_gain": 0.0,
            "scatter_joint": 0.0,
        },
        null_statistic=(
            outcome.base_screening.largest,
            outcome.base_screening.threshold,
        ),
        experiment=verdict.step,
        reason=verdict.reason,
        explanations=tuple(labels_of_fit(f) for f in outcome.level if accepted),
        policy=bench.policy,
        closest=closest_of(outcome, bench),
        prior_limit=bench.policy.floor_prior_limit,
    )


def _verdict(outcome: SearchOutcome, bench: StructureBench) -> DiagnosisVerdict:
    acceptance = outcome.acceptance
    if not acceptance.passed:
        reason = f"no effect of the catalogue explains the hits: {acceptance.reason}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, LOOK_CLOSER, unexplained=True)
    chi2 = f"chi2/dof is {1 + acceptance.excess:.3f} with a floor of {bench.floor:.2%}"
    if not outcome.best.candidates:
        reason = f"the base model explains the hits: {chi2} of the peak"
        return DiagnosisVerdict(
            Finding.NONE, reason, "none required; harder hits would show more"
        )
    if len(outcome.level) == 1:
        reason = f"explains the hits: {chi2} of the peak"
        return DiagnosisVerdict(Finding.NAMED, reason, "no rival is near")
    names = " or ".join(words_of(f.candidates) for f in outcome.level)
    if len(outcome.level) > bench.policy.most_rivals:
        reason = f"too many explanations fit equally well: {names}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, OTHER_POINTS)
    reason = f"{names}: the difference of their scores is not significant"
    return DiagnosisVerdict(Finding.AMBIGUOUS, reason, OTHER_POINTS)
