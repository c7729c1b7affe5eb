# SPDX-License-Identifier: MIT
"""The verdict where no effect explains the records: does one explain most of them?"""

from dataclasses import replace

from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.partial_records import PartialExplanation
from jointbench.analysis.gap.model_error.explain_mostly import explain_mostly
from jointbench.analysis.gap.residuals.bench_protocol import MeasuredBench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress

MOSTLY_STEP = (
    "use the family and its size, not the parameters as material data; correct the "
    "linear model where its discrepancy is largest, then diagnose again"
)


def under_model_error(
    verdict: DiagnosisVerdict, bench: MeasuredBench, base: Fit, progress: Progress
) -> tuple[DiagnosisVerdict, PartialExplanation | None]:
    """Return the verdict with what the best force law explains.

    Args:
        verdict: of the search.
        bench: with its final noise estimate.
        base: fit of the base alone on that bench.
        progress: receives one line for each step.

    Returns:
        `mostly` if the family of a law is named; the given verdict otherwise, with a
        nonlinear joint in its reason if there is one.
    """
    if not verdict.unexplained:
        return verdict, None
    partial = explain_mostly(bench, base, progress)
    if partial is None or not partial.nonlinear:
        return verdict, partial
    law = f"{partial.effect.replace('_', ' ')} at {partial.site}"
    if not partial.named:
        reason = (
            f"{verdict.reason}; nonlinear at {partial.site}, family open: the best law "
            f"is {law}; {partial.reason}"
        )
        return replace(verdict, reason=reason), partial
    reason = (
        f"{partial.family} at {partial.site} explains most of the gap, but the model "
        f"as a whole is not true to the noise; best law: {law}; {partial.reason}"
    )
    return replace(verdict, finding=Finding.MOSTLY, reason=reason, step=MOSTLY_STEP), (
        partial
    )
