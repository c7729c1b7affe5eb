# SPDX-License-Identifier: MIT
"""Outcome of a search on a law, and the diagnosis that follows: one form for all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.judgement.fit_summaries import (
    deviations_from_priors,
    labels_of_fit,
    ranked_fits,
)
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.judgement.rivals import rivals
from jointbench.analysis.gap.law_diagnosis.law_explanations import (
    Charged,
    closest_refused,
    named_effects,
)
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from jointbench.analysis.gap.residuals.bench_protocol import Bench, NoisyBench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.screening import Screening

_ACCEPTED = (Finding.NAMED, Finding.AMBIGUOUS, Finding.MOSTLY)


@dataclass(frozen=True, slots=True, eq=False)
class TestedBase:
    """The base of a law with its tests.

    Attributes:
        fit: of the base.
        screening: directed tests of it.
        acceptance: whether it explains the rows by itself.
    """

    fit: Fit
    screening: Screening
    acceptance: Acceptance

    def complete(self, bench: Bench) -> SearchOutcome:
        """Return the outcome where nothing is missing.

        Args:
            bench: of the fit.
        """
        own, test = self.fit, self.acceptance
        return SearchOutcome(bench, own, test, self.screening, own, test, (), (own,))

    def outcome(
        self,
        bench: Bench,
        judged: Sequence[tuple[Fit, Acceptance]],
        ranked: Sequence[Fit],
    ) -> SearchOutcome:
        """Return the outcome of a search for what is missing.

        Args:
            bench: of the fits.
            judged: fits with their acceptance, accepted ones first.
            ranked: all fits by score.
        """
        best, acceptance = judged[0] if judged else (self.fit, self.acceptance)
        near = [f for f, one in judged if one.passed]
        return SearchOutcome(
            bench=bench,
            base=self.fit,
            base_acceptance=self.acceptance,
            base_screening=self.screening,
            best=best,
            acceptance=acceptance,
            ranked=tuple(ranked),
            level=tuple(rivals(bench, near)),
        )


def fit_shown(outcome: SearchOutcome, finding: Finding) -> Fit:
    """Return the fit that a diagnosis shows: the base unless effects are accepted.

    Args:
        outcome: of the search.
        finding: of its verdict.
    """
    return outcome.best if finding in _ACCEPTED else outcome.base


@dataclass(frozen=True, slots=True, eq=False)
class LawReport:
    """What a bench adds to the diagnosis of its law.

    Attributes:
        gaps: before and after.
        base: parameters of the base in the fit that is shown.
        noise: key to value.
        charged: cost by which explanations are weighed.
    """

    gaps: tuple[Gap, Gap]
    base: tuple[Estimate, ...]
    noise: Mapping[str, float]
    charged: Charged


def law_diagnosis(
    outcome: SearchOutcome,
    bench: NoisyBench,
    verdict: DiagnosisVerdict,
    report: LawReport,
) -> Diagnosis:
    """Return the diagnosis of a search on a law.

    Args:
        outcome: of the search.
        bench: of its fits.
        verdict: on it.
        report: what the bench adds.
    """
    finding, base = verdict.finding, outcome.base
    accepted = finding in _ACCEPTED
    best = fit_shown(outcome, finding)
    shown: Sequence[Fit] = ()
    if accepted:
        shown = outcome.level if finding is Finding.AMBIGUOUS else (best,)
    return Diagnosis(
        verdict=finding,
        effects=named_effects(outcome, bench, shown, report.charged),
        candidates=ranked_fits(
            bench,
            [base, *outcome.ranked],
            lambda f: f.cost / max(bench.blocks.dof, 1),
        ),
        gap_before=report.gaps[0],
        gap_after=report.gaps[1],
        prior_deviations=deviations_from_priors(bench.base_names, base, best),
        base=report.base,
        noise=dict(report.noise),
        null_statistic=(
            outcome.base_screening.largest,
            outcome.base_screening.threshold,
        ),
        experiment=verdict.step,
        reason=verdict.reason,
        explanations=tuple(labels_of_fit(f) for f in outcome.level if accepted),
        policy=bench.policy,
        closest=closest_refused(outcome, bench, finding, report.charged),
    )
