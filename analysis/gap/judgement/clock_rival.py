# SPDX-License-Identifier: MIT
"""A delay or a low pass of all channels against a drift of their clock.

A clock that runs fast against that of the force compresses the responses about the
start of the record. The frequencies of the modes move, which the base follows, and the
hit comes early by the same time in every record, as with a constant delay. The
catalogue has no such effect: a delay is named only if it explains the records better.
"""

from jointbench.analysis.gap.catalogue.catalogue import ALL_CHANNELS
from jointbench.analysis.gap.catalogue.probes import CLOCK_DRIFT, LIKE_A_CLOCK
from jointbench.analysis.gap.model.effect import Candidate, Site
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.candidate_starts import started
from jointbench.analysis.gap.search.screening import screen

_EVERY = Site("channel", ALL_CHANNELS)


def clock_rival(bench: Bench, fit: Fit, base: Fit) -> str:
    """Return why a fault of all channels is not named, or empty.

    Args:
        bench: with the noise estimated at the fit.
        fit: one effect that explains the records.
        base: fit without effects.
    """
    probe = Candidate(CLOCK_DRIFT.effect, _EVERY)
    alone = len(fit.candidates) == 1 and fit.candidates[0].site == _EVERY
    if not alone or fit.candidates[0].effect.name not in LIKE_A_CLOCK:
        return ""
    if probe not in bench.probes:
        return ""
    (direction, *_) = screen(bench, base, [probe]).directions
    drift = started(bench, base, direction)
    if drift.cost - fit.cost > bench.policy.rival_score:
        return ""
    return (
        "a clock of the responses that drifts against that of the force explains the "
        "records as well"
    )
