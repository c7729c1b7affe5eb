# SPDX-License-Identifier: MIT
"""The fit of the base alone, and the noise that goes with it."""

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.judgement.winner_judging import far_off
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import (
    BASE_RESOLUTIONS,
    fit_coarse_to_fine,
    minimise,
)


@one_thread()
def fit_base(bench: Bench) -> tuple[Bench, Fit]:
    """Fit the base coarse to fine, estimate the noise there, and settle.

    The last stage still knows nothing of scatter. In a quiet campaign it may follow
    the hits that settled and end so far off that no noise can be told there; then the
    stage before, whose window forgives, is fitted with each hit as it seems to have
    settled.
    """
    problem = make_problem(bench, ())
    early = fit_coarse_to_fine(problem, np.zeros(problem.n_base), BASE_RESOLUTIONS[:-1])
    late = minimise(problem, early.x)
    found = settled_base(bench, late)
    if not far_off(*found):
        return found
    expanded = bench.refine(early.base, (), diverged=True)
    again = minimise(make_problem(expanded, ()), early.x)
    if again.chi2 > DIAGNOSIS.settled_share * found[1].chi2:
        return found
    settled = settled_base(expanded, again)
    return (expanded, again) if far_off(*settled) else settled


def settled_base(bench: Bench, fit: Fit) -> tuple[Bench, Fit]:
    """Bring a base and the noise estimated at it to agree."""
    for _ in range(DIAGNOSIS.base_rounds):
        before = fit.cost
        bench = bench.refine(fit.base, ())
        fit = minimise(make_problem(bench, ()), fit.x)
        if abs(fit.cost - before) < DIAGNOSIS.base_settled_cost:
            break
    return bench, fit
