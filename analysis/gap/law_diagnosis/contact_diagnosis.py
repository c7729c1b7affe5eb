# SPDX-License-Identifier: MIT
"""Diagnosis of a joint over its preload: verdict and evidence."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.contact_bench.contact_bench import (
    ContactBench,
    make_contact_bench,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.held_out_torques import (
    HeldOutTorques,
    hold_out_torques,
)
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.judgement.fit_summaries import largest_deviation
from jointbench.analysis.gap.law_diagnosis.contact_search import search_contact
from jointbench.analysis.gap.law_diagnosis.law_explanations import verdict_on_level
from jointbench.analysis.gap.law_diagnosis.law_outcome import (
    LawReport,
    fit_shown,
    law_diagnosis,
)
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.next_experiment.contact_forecast import rank_series
from jointbench.analysis.gap.next_experiment.ranked_experiment import (
    RankedExperiment,
    advice,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress

MORE_STATES = (
    "add torques at both ends of the range, rising and falling, with the preload "
    "measured by a washer"
)
UNDETERMINED = "cannot be determined"
"""First words of a reason when the states cannot show any effect."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactDiagnosis:
    """Result on a joint over its preload.

    Attributes:
        found: verdict and evidence.
        before: each torque predicted without it by the base.
        after: the same with the effect; that of the base where none is named.
        bench: of the fits.
        base: fit of the base.
        best: fit that is shown; the base unless an effect is accepted.
        experiments: candidates for the next one, by gain per hour of bench time; empty
            where nothing is left to decide.
    """

    found: Diagnosis
    before: HeldOutTorques
    after: HeldOutTorques
    bench: ContactBench
    base: Fit
    best: Fit
    experiments: tuple[RankedExperiment, ...] = ()


@one_thread()
def diagnose_contact(
    data: JointData,
    law: PreloadLaw,
    *,
    without: frozenset[str] = frozenset(),
    policy: Policy = STANDARD,
    progress: Progress | None = None,
) -> ContactDiagnosis:
    """Find and name the effect that a contact law lacks to explain a joint.

    Args:
        data: measured stiffness and damping over preload, with what is known of the
            joint.
        law: base with the uncertainty of its inputs.
        without: names of effects to leave out of the catalogue.
        policy: thresholds of the verdict.
        progress: receives one line for each step.

    Raises:
        UsageError: `without` holds an unknown name.
        BadData: the law cannot be evaluated at these preloads.
    """
    bench = make_contact_bench(data, law, without=without, policy=policy)
    outcome = search_contact(bench, progress or _silent)
    final = outcome.bench
    if not isinstance(final, ContactBench):
        raise TypeError("the search must return a bench of the type it was given")
    return conclude_contact(outcome, final)


def _silent(line: str) -> None:
    """Show no progress."""


def conclude_contact(outcome: SearchOutcome, bench: ContactBench) -> ContactDiagnosis:
    """Derive the diagnosis from the outcome of a search.

    Args:
        outcome: of the search.
        bench: of its fits.
    """
    verdict = contact_verdict(outcome, bench)
    base, best = outcome.base, fit_shown(outcome, verdict.finding)
    experiments = _next(outcome, bench, verdict)
    before = hold_out_torques(bench, base)
    after = before if best is base else hold_out_torques(bench, best)
    sigma = np.sqrt(np.diag(bench.data.rows.covariance))
    charge = bench.policy.parameter_charge
    report = LawReport(
        (_gap(bench, base, before), _gap(bench, best, after)),
        _base_estimates(bench, best),
        {
            "sigma_min": float(sigma.min()),
            "sigma_max": float(sigma.max()),
            "force_sigma_N": 0.0,
            "scatter_gain": bench.data.facts.torque_scatter,
            "scatter_joint": bench.data.facts.reassembly,
        },
        lambda fit: fit.cost + charge * (fit.x.size - fit.n_base),
    )
    advised = replace(verdict, step=advice(experiments) or verdict.step)
    found = law_diagnosis(outcome, bench, advised, report)
    return ContactDiagnosis(found, before, after, bench, base, best, experiments)


def _next(
    outcome: SearchOutcome, bench: ContactBench, verdict: DiagnosisVerdict
) -> tuple[RankedExperiment, ...]:
    """Return experiments that separate what survives, or the best of what does not."""
    if verdict.finding is Finding.AMBIGUOUS or len(outcome.level) > 1:
        return rank_series(bench, outcome.level, accepted=True)
    if verdict.unexplained:
        return rank_series(bench, outcome.ranked, accepted=False)
    return ()


def contact_verdict(outcome: SearchOutcome, bench: ContactBench) -> DiagnosisVerdict:
    """Return the verdict on a search on a joint over its preload.

    Args:
        outcome: of the search.
        bench: of its fits.
    """
    if short := too_few(bench.data):
        return DiagnosisVerdict(
            Finding.UNKNOWN, f"{UNDETERMINED}: {short}", MORE_STATES
        )
    acceptance, best = outcome.acceptance, outcome.best
    if not acceptance.passed:
        reason = f"no effect of the catalogue explains the joint: {acceptance.reason}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, MORE_STATES, unexplained=True)
    chi2 = f"chi2 {best.cost:.1f} for {bench.blocks.dof} values"
    if not best.candidates:
        reason = f"the law explains the joint within priors and scatter: {chi2}"
        step = "none required; more torques and assemblies would show smaller effects"
        return DiagnosisVerdict(Finding.NONE, reason, step)
    explains = f"explains the joint: {chi2}, {outcome.base.cost:.1f} without it"
    verdict = verdict_on_level(outcome, bench, explains, MORE_STATES)
    if verdict.finding is Finding.UNKNOWN:
        return replace(verdict, reason=f"{UNDETERMINED}: {verdict.reason}")
    return verdict


def too_few(data: JointData) -> str:
    """Return why the states cannot show any effect; empty if they can.

    Args:
        data: of the joint.
    """
    seen = np.unique(data.rows.state[~data.rows.bound])
    levels = np.unique(data.states.level[seen])
    if levels.size < CONTACT.least_levels:
        return (
            f"{levels.size} level(s) of preload have a measured value; a slope and its "
            f"curvature need {CONTACT.least_levels}"
        )
    log_p = data.nominal_log_preload[seen]
    ratio = float(np.exp(np.ptp(log_p)))
    if ratio < CONTACT.least_ratio:
        return (
            f"the highest preload is {ratio:.2g} times the lowest; "
            f"{CONTACT.least_ratio:g} times are needed"
        )
    return ""


def _gap(bench: ContactBench, fit: Fit, held: HeldOutTorques) -> Gap:
    words = (
        f"{len(held.levels)} torques held out, each predicted from the others; "
        f"{100 * held.share_inside:.0f} % of the values are within their 95 % interval"
    )
    deviation = largest_deviation(fit)
    return Gap(held.gap, held.chi2_per_dof, deviation, bench.views(fit), words)


def _base_estimates(bench: ContactBench, fit: Fit) -> tuple[Estimate, ...]:
    """Return the parameters of the law and of the joint, without those of states."""
    layout = bench.layout
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))[: fit.n_base]
    values = layout.nominal * np.exp(fit.base)
    return tuple(
        Estimate(layout.names[k], float(values[k]), float(values[k] * sd[k]), unit)
        for k, unit in enumerate(layout.units[: layout.state])
    )
