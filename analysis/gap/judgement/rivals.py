# SPDX-License-Identifier: MIT
"""Which fits the best one is not told apart from."""

from collections.abc import Sequence

from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.model.effect import labels_of
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import score

_EVERYWHERE = "all"


def rival_within(best: Fit, policy: Policy) -> float:
    """Return the score behind the best within which a rival is not told apart.

    Two laws at one site together bend as many do, so more is asked of them.
    """
    sites = [c.site for c in best.candidates]
    apart = len(set(sites)) == len(sites)
    return policy.rival_score if apart else policy.rival_score_one_site


def rivals(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that the best one is not told apart from, it included.

    An explanation that holds the best one and more is no rival of it: what it adds
    did not earn its charge.
    """
    if not fits:
        return []
    best, own = score(bench, fits[0]), labels_of(fits[0].candidates)
    near = rival_within(fits[0], bench.policy)
    return [
        f
        for f in fits
        if score(bench, f) < best + near
        and (f is fits[0] or not own < labels_of(f.candidates))
    ]


def without_duplicates(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Drop fits that say the same as a fault of all channels alike.

    A range of the converter that only one channel reaches is the range of all.
    """
    return [
        f
        for f in fits
        if not any(
            _same_fault(f, c)
            and abs(score(bench, f) - score(bench, c)) < JUDGEMENT.same_fault_score
            for c in fits
        )
    ]


def _same_fault(fit: Fit, common: Fit) -> bool:
    """Tell whether a fit is another one with a fault of all at one channel only."""
    own = [c for c in fit.candidates if c not in common.candidates]
    other = [c for c in common.candidates if c not in fit.candidates]
    if len(own) != 1 or len(other) != 1 or other[0].site.name != _EVERYWHERE:
        return False
    return own[0].effect.name == other[0].effect.name
