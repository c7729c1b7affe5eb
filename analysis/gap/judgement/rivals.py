# SPDX-License-Identifier: MIT
"""Select the fits that cannot be distinguished from the best one."""

from collections.abc import Sequence

from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.model.effect import labels_of
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import score

_EVERYWHERE = "all"


def rival_within(best: Fit, policy: Policy) -> float:
    """Return the delta score up to which a rival cannot be excluded.

    Two laws at one site together can imitate many others, so their limit is higher.
    """
    sites = [c.site for c in best.candidates]
    apart = len(set(sites)) == len(sites)
    return policy.rival_score if apart else policy.rival_score_one_site


def rivals(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Return the best fit and those that cannot be distinguished from it.

    An explanation that contains the best one is not a rival, nor is one whose law has
    that of the best one as a special case: their gain is smaller than their charge.
    """
    if not fits:
        return []
    best, own = score(bench, fits[0]), labels_of(fits[0].candidates)
    near = rival_within(fits[0], bench.policy)
    return [
        f
        for f in fits
        if score(bench, f) < best + near
        and not own < labels_of(f.candidates)
        and not generalises(f, fits[0])
    ]


def generalises(fit: Fit, other: Fit) -> bool:
    """Return whether a fit differs from another in one law, of which it has a case.

    Args:
        fit: with the more general law.
        other: with its special case.
    """
    more = [c for c in fit.candidates if c not in other.candidates]
    special = [c for c in other.candidates if c not in fit.candidates]
    return (
        len(more) == len(special) == 1
        and more[0].site == special[0].site
        and special[0].effect.name in more[0].effect.generalises
    )


def without_duplicates(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Drop fits of one channel that are equivalent to a fault of all channels.

    A converter range that only one channel reaches is the range of all channels.
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
    """Return whether two fits differ only in a fault at one or at all channels."""
    own = [c for c in fit.candidates if c not in common.candidates]
    other = [c for c in common.candidates if c not in fit.candidates]
    if len(own) != 1 or len(other) != 1 or other[0].site.name != _EVERYWHERE:
        return False
    return own[0].effect.name == other[0].effect.name
