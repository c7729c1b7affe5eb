# SPDX-License-Identifier: MIT
"""Diagnosis of records of a structure at several levels, with a base of modes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.diagnose import effects_of
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.level_verdict import level_verdict
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome, investigate
from jointbench.analysis.gap.diagnosis.partial_verdict import under_model_error
from jointbench.analysis.gap.judgement.fit_summaries import (
    deviations_from_priors,
    labels_of_fit,
    largest_deviation,
    ranked_fits,
)
from jointbench.analysis.gap.judgement.held_out import HeldOut, hold_out
from jointbench.analysis.gap.judgement.stated_covariance import stated_covariance
from jointbench.analysis.gap.modal_bench.base_from_records import (
    BaseRequest,
    base_from_records,
)
from jointbench.analysis.gap.modal_bench.level_records import RecordSet
from jointbench.analysis.gap.modal_bench.modal_base import ModalBase
from jointbench.analysis.gap.modal_bench.modal_bench import ModalBench, make_modal_bench
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.selection_round import Progress


@dataclass(frozen=True, slots=True, eq=False)
class LevelDiagnosis:
    """Result on records at several levels.

    Attributes:
        found: verdict and evidence.
        scores: error on each record that no fit has seen, before and after.
        base: modes of the lowest level, with priors.
        base_chi2: chi2/dof of the base at the lowest level [-].
    """

    found: Diagnosis
    scores: tuple[StretchScore, ...]
    base: ModalBase
    base_chi2: float


@one_thread()
def diagnose_levels(
    given: RecordSet,
    wanted: BaseRequest,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    policy: Policy = STANDARD,
    progress: Progress | None = None,
) -> LevelDiagnosis:
    """Identify a base at the lowest level, and name what the other levels add to it.

    Args:
        given: records with sensors, inputs and suspected ports.
        wanted: band and number of modes of the base.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue; its laws are tried at each port.
        policy: thresholds of the verdict.
        progress: receives one line for each step.

    Raises:
        BadData: the lowest level shows no or too few modes in the band.
        UsageError: `without` holds a name that no entry has.
    """
    say = progress or _silent
    say("modes of the lowest level")
    base, chi2 = base_from_records(given, wanted)
    effort = MODAL.search_effort * policy.most_samples
    bench = make_modal_bench(
        given,
        base,
        without=without,
        entries=entries,
        policy=replace(policy, most_samples=effort),
    )
    outcome = investigate(bench, say)
    final = outcome.bench
    if not isinstance(final, ModalBench):
        raise TypeError("the search must return a bench of the type it was given")
    say("held-out levels")
    found = _conclude(outcome, final, say)
    return LevelDiagnosis(found, _scores(final, outcome, found), base, chi2)


def _silent(line: str) -> None:
    """Show no progress."""


def _conclude(outcome: SearchOutcome, bench: ModalBench, say: Progress) -> Diagnosis:
    """Derive the diagnosis from the outcome of a search."""
    base = minimise(make_problem(bench, ()), outcome.base.x, iterations=6)
    outcome = replace(outcome, base=base)
    verdict, partial = under_model_error(
        level_verdict(outcome, bench), bench, base, say
    )
    finding = verdict.finding
    shown: Sequence[Fit] = ()
    if finding is Finding.NAMED:
        shown = (outcome.best,)
    elif finding is Finding.AMBIGUOUS:
        shown = outcome.level
    best = outcome.best if outcome.acceptance.passed else base
    held = hold_out(base, bench)
    after = held if best is base else hold_out(best, bench, held)
    return Diagnosis(
        verdict=finding,
        effects=effects_of(outcome, bench, shown),
        candidates=ranked_fits(
            bench,
            [outcome.base, *outcome.ranked],
            lambda f: f.chi2 / bench.blocks.dof,
        ),
        gap_before=_gap(bench, base, held),
        gap_after=_gap(bench, best, after),
        prior_deviations=deviations_from_priors(bench.base_names, base, best),
        base=_base_estimates(bench, best),
        noise={
            "sigma_min": float(bench.sigma.min()),
            "sigma_max": float(bench.sigma.max()),
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
        explanations=tuple(
            labels_of_fit(f) for f in outcome.level if outcome.acceptance.passed
        ),
        policy=bench.policy,
        partial=partial,
    )


def _gap(bench: ModalBench, fit: Fit, held: HeldOut) -> Gap:
    deviation = largest_deviation(fit)
    return Gap(held.gap, held.chi2_per_dof, deviation, bench.views(fit))


def _base_estimates(bench: ModalBench, fit: Fit) -> tuple[Estimate, ...]:
    variance = np.diag(stated_covariance(fit, bench.blocks))[: fit.n_base]
    sd = np.sqrt(np.maximum(variance, 0.0))
    values = bench.base.values(fit.base)
    sds = bench.base.value_sd(fit.base, sd)
    return tuple(
        Estimate(name, float(v), float(s), unit)
        for name, v, s, unit in zip(
            bench.base_names, values, sds, bench.base.units, strict=True
        )
    )


def _scores(
    trained: ModalBench, outcome: SearchOutcome, found: Diagnosis
) -> tuple[StretchScore, ...]:
    """Return the error on each held-out record, before and after."""
    given = trained.given
    scores = []
    for record in (r for r in given.records if r.held_out):
        bench = make_modal_bench(
            given, trained.base, records=(record,), entries=trained.entries
        )
        bench = replace(bench, scales=trained.scales)
        scores.append(
            StretchScore(
                f"{record.name} ({record.level})",
                _rms(bench, bench.data.measured),
                _error(bench, outcome.base),
                _error(bench, outcome.best),
            )
        )
    return tuple(scores)


def _error(bench: ModalBench, fit: Fit) -> float:
    return _rms(bench, bench.difference(fit.base, fit.terms, DIAGNOSIS.scored_steps))


def _rms(bench: ModalBench, values: FloatArray) -> float:
    scored = bench.data.scored
    return float(np.sqrt(np.sum((values * scored) ** 2) / scored.sum()))
