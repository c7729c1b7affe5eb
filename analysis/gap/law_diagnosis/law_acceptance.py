# SPDX-License-Identifier: MIT
"""Whether a fit explains rows whose noise and priors are known: one test for all laws.

Every base parameter has a prior, so that the cost at the minimum is chi2 distributed
with as many degrees of freedom as there are rows.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.judgement.amplitudes import at_the_end
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, Candidate
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.screening import Screening


@dataclass(frozen=True, slots=True)
class LawCriteria:
    """Limits of a bench, and its words.

    Attributes:
        null_chance: chance of the cost of the base below which something is missing.
        fit_chance: the same of a fit with effects.
        null_factor: on the limit of the directed tests.
        prior_limit: of the deviation of a base parameter [sd].
        amplitude_limit: root of the drop of the cost below which nothing is named [sd].
        cost: what the cost is the chi2 of.
        rows: what is counted.
    """

    null_chance: float
    fit_chance: float
    null_factor: float
    prior_limit: float
    amplitude_limit: float
    cost: str
    rows: str


def accept_law(
    bench: Bench,
    fit: Fit,
    base: Fit,
    left: Screening,
    limits: LawCriteria,
    *,
    model: float,
) -> Acceptance:
    """Judge a fit by its cost, its directed tests, its priors and its size.

    Args:
        bench: of the fit.
        fit: with or without effects.
        base: fit without effects.
        left: directed tests of the fit by other effects and by probes.
        limits: of the bench.
        model: cost that the formulas of the effects may leave [-].
    """
    dof = max(bench.blocks.dof, 1)
    chance = limits.fit_chance if fit.candidates else limits.null_chance
    limit = chi2_limit(chance, dof) + model
    allowed = limits.null_factor * left.threshold + model
    worst = left.directions[0] if left.directions else None
    reason = ""
    if fit.cost > limit:
        reason = (
            f"chi2 of {limits.cost} is {fit.cost:.1f} with {dof} {limits.rows}, the "
            f"limit is {limit:.1f}"
        )
    elif worst is not None and worst.drop > allowed:
        reason = _looks_like(worst.candidate, worst.drop)
    elif np.abs(fit.prior_deviations).max() > limits.prior_limit:
        k = int(np.argmax(np.abs(fit.prior_deviations)))
        reason = (
            f"{bench.base_names[k]} is {abs(fit.prior_deviations[k]):.1f} sd from its "
            "nominal value"
        )
    unexplained = bool(reason)
    if fit.candidates and not reason:
        distance = float(np.sqrt(max(base.cost - fit.cost, 0.0)))
        if distance < limits.amplitude_limit:
            reason = f"the effect is only {distance:.1f} sd from zero"
        reason = reason or at_the_end(fit, bench.policy)
    return Acceptance(
        passed=not reason,
        reason=reason,
        excess=fit.cost / dof - 1.0,
        allowed=limit / dof - 1.0,
        remaining=worst.drop if worst else None,
        remaining_allowed=allowed,
        unexplained=unexplained,
        left=left,
    )


def _looks_like(candidate: Candidate, drop: float) -> str:
    if candidate.effect.family != PROBE_FAMILY:
        return f"a further effect would lower chi2 by {drop:.0f}"
    shape = candidate.effect.name.replace("_", " ")
    of = f" of {candidate.site.name}" if candidate.site.kind == "quantity" else ""
    return (
        f"the residual{of} has the shape '{shape}', which would lower chi2 by "
        f"{drop:.0f}"
    )
