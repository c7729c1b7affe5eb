# SPDX-License-Identifier: MIT
"""Acceptance criteria of a fit: a smaller gap alone does not meet them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.judgement.amplitudes import at_the_end, weakest
from jointbench.analysis.gap.judgement.clock_rival import clock_rival
from jointbench.analysis.gap.judgement.expected_residual import forgiven, noise_sd
from jointbench.analysis.gap.judgement.own_parameters import most_unlike
from jointbench.analysis.gap.model.effect import PROBE_FAMILY
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.screening import Direction, Screening


@dataclass(frozen=True, slots=True, eq=False)
class Acceptance:
    """Whether a fit is accepted as an explanation of the measurement.

    Attributes:
        passed: all criteria are met.
        reason: the first criterion that is not met, or empty.
        excess: chi2/dof - 1 [-].
        allowed: largest excess that noise and model error allow [-].
        remaining: drop of the directed test closest to its limit, or furthest above
            it; None if there is no test.
        remaining_allowed: limit of that test; 0 if there is no test.
        unexplained: True if the fit does not explain the records or the priors, so
            that a further effect may help.
        left: directed tests of the residual of the fit; None if not computed.
    """

    passed: bool
    reason: str
    excess: float
    allowed: float
    remaining: float | None
    remaining_allowed: float
    unexplained: bool
    left: Screening | None


def accept(
    bench: Bench,
    fit: Fit,
    base: Fit,
    left: Screening | None,
    others: Sequence[Fit] = (),
) -> Acceptance:
    """Judge a fit.

    Args:
        bench: with the noise re-estimated at the fit.
        fit: of that bench.
        base: fit without effects, of the bench as it was.
        left: directed tests of the fit; None to skip them.
        others: other fits, among them those without one of the effects.
    """
    policy, dof = bench.policy, bench.blocks.dof
    excess = fit.chi2 / dof - 1.0
    model = policy.model_error_factor * forgiven(fit, (base, *others), dof)
    allowed = policy.chi2_limit * noise_sd(bench) + model / dof
    worst, beyond = None, -np.inf
    if left is not None and bench.blocks.white:
        bound = policy.model_error_elsewhere * max(base.chi2 - dof, 0.0)
        limit = policy.null_factor * left.threshold
        worst, beyond = _worst(fit, left, limit + model, limit + min(model, bound))
    reason = ""
    if excess > allowed:
        reason = f"chi2/dof is {1 + excess:.4f}, the limit is {1 + allowed:.4f}"
    elif worst and beyond > 0.0:
        reason = _looks_like(worst)
    elif unlike := _unlike(bench, fit, model):
        reason = unlike
    elif np.abs(fit.prior_deviations).max() > policy.prior_limit:
        worst_prior = np.abs(fit.prior_deviations).max()
        reason = f"a base parameter is {worst_prior:.1f} sd from its nominal value"
    unexplained = bool(reason)
    reason = reason or _doubt(fit, (base, *others), policy)
    reason = reason or clock_rival(bench, fit, base)
    return Acceptance(
        passed=not reason,
        reason=reason,
        excess=excess,
        allowed=allowed,
        remaining=worst.drop if worst else None,
        remaining_allowed=worst.drop - beyond if worst else 0.0,
        unexplained=unexplained,
        left=left,
    )


def _doubt(fit: Fit, others: Sequence[Fit], policy: Policy) -> str:
    """Return the reason against naming a fit that explains the records, or empty."""
    distance = weakest(fit, others) if fit.candidates else np.inf
    if distance < policy.amplitude_limit:
        return f"an effect is only {distance:.1f} sd from zero"
    return at_the_end(fit, policy)


def _looks_like(left: Direction) -> str:
    """Describe the residual of a fit by its largest directed test."""
    if left.candidate.effect.family != PROBE_FAMILY:
        return f"a further effect would lower chi2 by {left.drop:.0f}"
    kind = left.candidate.effect.name
    return (
        f"the residual resembles a {kind} at {left.candidate.site}, which would lower "
        f"chi2 by {left.drop:.0f}"
    )


def _worst(
    fit: Fit, left: Screening, here: float, elsewhere: float
) -> tuple[Direction | None, float]:
    """Return the directed test furthest above its limit, and its distance from it.

    The model error of a law resembles other laws of the same site, for example with
    other sliders, so the limit at other sites is lower.
    """
    own = {c.site for c in fit.candidates}
    worst, beyond = None, -np.inf
    for d in left.directions:
        if d.suggested:
            continue
        limit = here if d.candidate.site in own else elsewhere
        if d.drop - limit > beyond:
            worst, beyond = d, d.drop - limit
    return worst, beyond


def _unlike(bench: Bench, fit: Fit, allowed: float) -> str:
    """Name the parts of the records that need separate parameters, if any."""
    if not bench.blocks.white:
        return ""
    policy, worst = bench.policy, most_unlike(bench, fit, allowed)
    limit = policy.parts_chance if fit.candidates else policy.parts_chance_base
    if worst.chance > limit:
        return ""
    return f"separate parameters by {worst.view} would lower chi2 by {worst.excess:.0f}"
