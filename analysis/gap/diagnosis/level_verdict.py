# SPDX-License-Identifier: MIT
"""The verdict on records at several levels, its reason, and what to do next."""

from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import (
    DiagnosisVerdict,
    no_rival,
)
from jointbench.analysis.gap.modal_bench.modal_bench import ModalBench
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import words_of

MORE_LEVELS = (
    "measure another level, or a slow sine sweep through the first mode: it separates "
    "friction (damping) from clearance (stiffness)"
)


def level_verdict(outcome: SearchOutcome, bench: ModalBench) -> DiagnosisVerdict:
    """Return the verdict on a search on records at several levels.

    Args:
        outcome: of the search.
        bench: with its final noise estimate.
    """
    levels = {r.level for r in bench.data.records}
    if len(levels) < 2:
        reason = (
            f"all records of the fits have one level ({levels.pop()}), which the base "
            "itself explains; add a higher level"
        )
        return DiagnosisVerdict(Finding.UNKNOWN, reason, "add a higher level")
    if not outcome.acceptance.passed:
        reason = "no effect of the catalogue explains the records: " + (
            outcome.acceptance.reason
        )
        if outcome.given_up:
            reason += "; the search for a further effect reached its effort limit"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, MORE_LEVELS, unexplained=True)
    if not outcome.best.candidates:
        reason = "the modes of the lowest level explain all levels within their noise"
        return DiagnosisVerdict(
            Finding.NONE, reason, "none required; higher levels would show more"
        )
    if len(outcome.level) == 1:
        reason = f"explains the records to chi2/dof {1 + outcome.acceptance.excess:.3f}"
        return DiagnosisVerdict(Finding.NAMED, reason, no_rival(outcome, bench))
    names = " or ".join(words_of(f.candidates) for f in outcome.level)
    if len(outcome.level) > bench.policy.most_rivals:
        reason = f"too many explanations fit equally well: {names}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, MORE_LEVELS)
    reason = f"{names}: the difference of their scores is not significant"
    return DiagnosisVerdict(Finding.AMBIGUOUS, reason, MORE_LEVELS)
